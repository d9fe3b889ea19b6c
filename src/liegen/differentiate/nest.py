"""A product that acts on a vector: its factors act one after the other."""

from __future__ import annotations

from typing import Any

from liegen.manifolds import Node
from liegen.manifolds.node import node_of
from liegen.trace import Graph
from liegen.trace.graph import rebuilt

#: The action of a group element on a vector and that of the inverse element.
ACTIONS = {"transform_from": "transform_to", "rotate": "unrotate"}
INVERSE = {**ACTIONS, **{to: of for of, to in ACTIONS.items()}}
#: What is a product: for each of its factors, from the left, whether its inverse is meant.
PRODUCTS = {"compose": (False, False), "between": (True, False), "inverse": (True,)}


def nested(graph: Graph) -> Graph:
    """The graph with each (a b) p as a (b p), and each (a b)^-1 p as b^-1 (a^-1 p).

    Products are those of ``compose``, ``between`` and ``inverse``, and products of these. The same graph if
    none acts on a vector. Nodes that are gone are not shown any more.
    """
    return rebuilt(graph, _nested)


def _nested(node: Node, operands: tuple[Node, ...]) -> Node | None:
    acts = node.operation.name in INVERSE and _is_product(operands[0])
    return _one_after_the_other(node.on(operands)) if acts else None


def _is_product(node: Node) -> bool:
    return node.operation.name in PRODUCTS and not node.operation.parameters


def _one_after_the_other(action: Node) -> Node:
    """The factors of the first operand act on the second one, the rightmost first."""
    element, moved = action.operands
    forward = action.operation.name if action.operation.name in ACTIONS else INVERSE[action.operation.name]
    for factor, inverse in reversed(_factors(element, inverse=action.operation.name not in ACTIONS)):
        name = INVERSE[forward] if inverse else forward
        element_value: Any = factor.manifold.holding(node=factor)
        found = node_of(getattr(element_value, name)(moved.manifold.holding(node=moved)))
        moved = Node(found.operation, found.operands, action.site)
    return moved


def _factors(element: Node, *, inverse: bool) -> list[tuple[Node, bool]]:
    """The factors of an element or its inverse, from the left, each with whether its inverse is meant."""
    if not _is_product(element):
        return [(element, inverse)]
    pairs = list(zip(element.operands, PRODUCTS[element.operation.name], strict=True))
    ordered = reversed(pairs) if inverse else pairs
    return [found for n, inverted in ordered for found in _factors(n, inverse=inverted != inverse)]
