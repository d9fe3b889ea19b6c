"""The natural domain of a formula: where its roots, logarithms, asin and acos have real values.

It is taken as stated: samples are drawn inside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from liegen.manifolds import Node
from liegen.trace import Graph

from .reference.calls import is_elementwise
from .reference.interpreter import Evaluation

#: How far outside an argument may be by rounding.
ROUNDING = 1e-12


def _in_unit(x: Any) -> bool:
    return abs(x) <= 1 + ROUNDING


def _not_negative(x: Any) -> bool:
    return x >= -ROUNDING


_NATURAL: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "sqrt": (_not_negative, "{0} >= 0"),
    "log": (_not_negative, "{0} > 0"),
    "acos": (_in_unit, "abs({0}) <= 1"),
    "asin": (_in_unit, "abs({0}) <= 1"),
}


def natural_nodes(graph: Graph) -> Iterator[tuple[Node, Callable[[Any], bool], str]]:
    """The operations that have real values in a part of space only, with their condition and its text."""
    for node in graph.nodes():
        name = node.operation.name
        if name in _NATURAL and is_elementwise(node.operation):
            yield node, *_NATURAL[name]


def is_natural(evaluation: Evaluation) -> bool:
    """Whether all of them have real values; what is not a number itself is not judged."""
    return all(
        holds(x) or x != x
        for node, holds, _ in natural_nodes(evaluation.graph)
        for x in evaluation[node.operands[0]]
    )
