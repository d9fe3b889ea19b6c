"""The natural domain of a formula: where its roots, logarithms, asin and acos have real values.

It is taken as stated: samples are drawn inside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from liegen.manifolds import Node
from liegen.trace import Graph
from liegen.trace.formulas import texts_of

from .reference.calls import is_elementwise
from .reference.interpreter import Evaluation

#: Longer arguments are not printed.
SHORT = 60
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
    return not unnatural(evaluation)


def unnatural(evaluation: Evaluation) -> str:
    """``log at factors.py:7 needs z > 0`` for the first that has none; empty where all have."""
    for node, holds, condition in natural_nodes(evaluation.graph):
        if not all(holds(x) or x != x for x in evaluation[node.operands[0]]):
            text = texts_of(evaluation.graph, {})[id(node.operands[0])].text
            shown = condition.format(text if len(text) <= SHORT else "its argument")
            return f"{node.operation.name} at {node.site} needs {shown}"
    return ""
