"""Intermediate values of a formula, and the formula with one of them held constant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from liegen.derive import derive
from liegen.manifolds import Leaf, Manifold, Node, Value
from liegen.manifolds.node import parameter
from liegen.trace import Graph, Parameter
from liegen.trace.formulas import texts_of
from liegen.trace.frame_repair import replaced
from liegen.trace.graph import topological

from ..points import Values, columns_of, size_of
from .difference import Difference, Subject

#: A name that no argument has: names of Python have no spaces.
_HELD = "held value"
#: So many intermediate values are tried, the last ones of the formula first.
MOST = 24


def value_of(graph: Graph, node: Node, values: Values) -> Any:
    """The value of a node at the points, by its operations on arrays, without what is required."""
    named = {id(p.node): values[p.name].coords for p in graph.parameters}
    coords: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for n in topological([node]):
            operation = n.operation
            if id(n) in named:
                coords[id(n)] = named[id(n)]
            elif isinstance(operation, Leaf):
                coords[id(n)] = operation.coords
            else:
                coords[id(n)] = operation.value(*(coords[id(o)] for o in n.operands))
    manifold: Any = node.manifold
    points = size_of(values)
    return manifold.holding([*columns_of(coords[id(node)], points).T])


def held_constant(subject: Subject) -> Iterator[Difference]:
    """The derivative of one intermediate value is left out: for a sum, that of one of its terms."""
    if subject.variable is None:
        return
    graph = subject.function.graph
    texts = texts_of(graph, {})
    for node in _intermediate(graph, subject.variable):
        value = value_of(graph, node, subject.sampled.values)
        base = _jacobian_with(graph, node, value, subject)
        phrase = f"the derivative of {texts[id(node)].text} is left out"
        yield Difference("base", (phrase,), 1.3, base=base)


def _intermediate(graph: Graph, variable: Parameter) -> list[Node]:
    """The nodes that depend on the variable, without the output and the variable: the last ones first."""
    depending = {id(variable.node)}
    found: list[Node] = []
    outputs = {id(node) for _, node in graph.outputs}
    for node in graph.nodes():
        if any(id(n) in depending for n in node.operands):
            depending.add(id(node))
            if id(node) not in outputs and issubclass(node.manifold, Manifold):
                found.append(node)
    return found[::-1][:MOST]


def _jacobian_with(graph: Graph, node: Node, value: Value, subject: Subject) -> np.ndarray[Any, Any]:
    variable: Any = subject.variable
    manifold: Any = node.manifold
    held = parameter(manifold, _HELD, node.site)
    others = tuple(replace(p, variable=p.name == variable.name, default=None) for p in graph.parameters)
    changed = replace(
        replaced(graph, node, held), parameters=(*others, Parameter(_HELD, manifold, False, held)), domain=()
    )
    values = {**subject.sampled.values, _HELD: value}
    program, points = derive(changed).jacobians, subject.sampled.points
    with np.errstate(all="ignore"):
        results: Any = program.evaluate(
            {p.name: p.storage.write(values[p.name].coords) for p in changed.parameters}
        )
    port = program.outputs[1]
    return columns_of(results[port.name], points).reshape(points, *port.shape)
