"""Repairs of frame errors: a text is proposed only where the factor, so written, has frames that fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from liegen.errors import DefinitionError
from liegen.manifolds import Node, Value
from liegen.manifolds.node import node_of

from .graph import Call, Graph, topological


@dataclass(frozen=True)
class Trial:
    """The node of a graph that does not fit, and a check that raises DefinitionError for a graph."""

    graph: Graph
    node: Node
    check: Callable[[Graph], object]

    def whole(self, text: str) -> bool:
        """Whether the graph fits where ``text``, on operands ``{0}``, ``{1}``, stands for the node."""
        return self._fits(self.node, self._made(text, self.node))

    def operand(self, k: int, text: str) -> bool:
        """Whether the graph fits where ``text`` stands for operand k of the node."""
        operands = list(self.node.operands)
        made = self._made(text, operands[k])
        if made is None:
            return False
        operands[k] = made
        return self._fits(self.node, replace(self.node, operands=tuple(operands)))

    def _made(self, text: str, like: Node) -> Node | None:
        """What a text says, if that is a value as the node ``like`` is one."""
        operands = [_value(n) for n in self.node.operands]
        known: dict[str, Any] = {f"_{k}": value for k, value in enumerate(operands)}
        known |= {like.manifold.__name__: like.manifold}
        known |= {p.name: _value(p.node) for p in self.graph.parameters}
        formula = text.format(*(f"_{k}" for k in range(len(operands))))
        try:
            value = eval(formula, {"__builtins__": {}}, known)  # a text of ours
        except (DefinitionError, AttributeError, TypeError):
            return None
        node = node_of(value)
        return node if node.manifold.form == like.manifold.form else None

    def _fits(self, old: Node, new: Node | None) -> bool:
        if new is None or not any(n is old for n in self.graph.nodes()):
            return False
        try:
            self.check(replaced(self.graph, old, new))
        except DefinitionError:
            return False
        return True


def _value(node: Node) -> Value:
    return node.manifold.holding(node=node)


def replaced(graph: Graph, old: Node, new: Node) -> Graph:
    """The graph with ``new``, made of what ``old`` was made of, in its place."""
    roots = [*(node for _, node in graph.outputs), *(d.condition for d in graph.domain)]
    roots += [n for call in graph.calls for n in (*call.results, *(a.node for a in call.arguments))]
    place: dict[int, Node] = {}
    for node in topological(roots):
        operands = tuple(place[id(n)] for n in node.operands)
        place[id(node)] = new if node is old else node.on(operands)

    def call(c: Call) -> Call:
        arguments = tuple(replace(a, node=place[id(a.node)]) for a in c.arguments)
        return replace(c, arguments=arguments, results=_placed(c.results, place))

    return replace(
        graph,
        outputs=tuple((name, place[id(node)]) for name, node in graph.outputs),
        domain=tuple(replace(d, condition=place[id(d.condition)]) for d in graph.domain),
        calls=tuple(map(call, graph.calls)),
    )


def _placed(nodes: Sequence[Node], place: dict[int, Node]) -> tuple[Node, ...]:
    return tuple(place[id(n)] for n in nodes)
