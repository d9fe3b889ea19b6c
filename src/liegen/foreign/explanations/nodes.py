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
from liegen.trace.graph import topological

from ..points import Values, size_of
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
    return manifold.holding([np.broadcast_to(np.asarray(c, float), points) for c in coords[id(node)]])


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
    ((name, output),) = graph.outputs
    others = tuple(replace(p, variable=p.name == variable.name, default=None) for p in graph.parameters)
    changed = replace(
        graph,
        parameters=(*others, Parameter(_HELD, manifold, False, held)),
        outputs=((name, _with(output, node, held)),),
        domain=(),
        calls=(),
    )
    values = {**subject.sampled.values, _HELD: value}
    program, points = derive(changed).jacobians, subject.sampled.points
    with np.errstate(all="ignore"):
        results: Any = program.evaluate(
            {p.name: p.storage.write(values[p.name].coords) for p in changed.parameters}
        )
    port = program.outputs[1]
    entries = [np.broadcast_to(np.asarray(e, dtype=float), points) for e in results[port.name]]
    return np.stack(entries, axis=-1).reshape(points, *port.shape)


def _with(output: Node, old: Node, new: Node) -> Node:
    """The output with ``new`` in place of ``old``."""
    done: dict[int, Node] = {id(old): new}
    for node in topological([output]):
        if id(node) not in done:
            operands = tuple(done[id(n)] for n in node.operands)
            same = all(a is b for a, b in zip(operands, node.operands, strict=True))
            done[id(node)] = node if same else Node(node.operation, operands, node.site)
    return done[id(output)]
