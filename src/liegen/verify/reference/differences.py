"""Jacobians by central differences on the manifold, with a step far below what doubles resolve."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from .calls import broadcast, is_elementwise
from .charts import space_in
from .interpreter import DIGITS, Evaluation, Sample, loaded, run
from .logarithms import PRINCIPAL, Branch
from .matrix import Element, Number, Vector, length, mp

if TYPE_CHECKING:
    from liegen.manifolds import Node
    from liegen.trace import Graph, Parameter

#: The step is 1e-25 of the distance to the nearest kink: truncation 1e-50, rounding 1e-80 / 1e-25.
STEP = 25

Jacobians = dict[tuple[str, str], list[list[Number]]]


def jacobians(graph: Graph, sample: Sample, *, flip: bool = False) -> Jacobians:
    """Rows of d output / d variable for every output and variable, in the charts of both.

    Logarithms unwrap, comparisons keep their outcome. At a kink (abs and norm at 0, minimum and maximum at a
    tie) the result is the mean of both sides. ``flip`` as in ``evaluate``: the other branch at pi.
    """
    order = _step_order(graph, sample)
    with mp.workdps(DIGITS + order - STEP):
        given = loaded(graph, sample)
        base = run(graph, graph.nodes(), given, flip=flip)
        step = mp.mpf(10) ** -order
        return {
            (name, p.name): entry
            for p in graph.variables
            for name, entry in _by_variable(base, given, p, step).items()
        }


def _by_variable(
    base: Evaluation, given: Mapping[Node, Element], p: Parameter, step: Number
) -> dict[str, list[list[Number]]]:
    space, x = space_in(p.manifold, p.chart), given[p.node]
    nodes = tuple(base.values)
    columns: dict[str, list[Vector]] = {name: [] for name, _ in base.graph.outputs}
    for k in range(space.dim(x)):
        ends: list[Evaluation] = []
        for h in (step, -step):
            d = tuple(h if i == k else mp.zero for i in range(space.dim(x)))
            moved = space.retract(x, d, Branch())
            ends.append(run(base.graph, nodes, {**given, p.node: moved}, base))
        for name, node in base.graph.outputs:
            rows = space_in(node.manifold, base.graph.chart)
            forth, back = (rows.local(base[node], end[node], PRINCIPAL) for end in ends)
            columns[name].append(tuple((f - b) / (2 * step) for f, b in zip(forth, back, strict=True)))
    return {name: [list(row) for row in zip(*entries, strict=True)] for name, entries in columns.items()}


def _step_order(graph: Graph, sample: Sample) -> int:
    """The step is 10^-n with n this: 25 orders below the nearest kink, 0 (the kink itself) left out.

    A distance that is only rounding of 0 costs time but is harmless: the digits grow with n, so the rounding
    is far below the step then.
    """
    with mp.workdps(DIGITS):
        evaluation = run(graph, graph.nodes(), loaded(graph, sample))
        distances = [abs(d) for d in _distances(evaluation) if d and mp.isfinite(d)]
        return STEP + max(0, -int(mp.floor(mp.log10(min(distances))))) if distances else STEP


def _distances(evaluation: Evaluation) -> Iterator[Number]:
    for node in evaluation.values:
        operation = node.operation
        if operation.name in _KINKS and (operation.name != "log" or is_elementwise(operation)):
            yield from _KINKS[operation.name]([evaluation[n] for n in node.operands])


def _size(operands: Sequence[Vector]) -> Iterable[Number]:
    return (length(operands[0]),)


def _entries(operands: Sequence[Vector]) -> Iterable[Number]:
    return operands[-1]


def _gaps(operands: Sequence[Vector]) -> Iterable[Number]:
    return (a - b for a, b in broadcast(operands))


def _radii(operands: Sequence[Vector]) -> Iterable[Number]:
    return (length(entry) for entry in broadcast(operands))


def _to_one(operands: Sequence[Vector]) -> Iterable[Number]:
    return (1 - abs(x) for x in operands[0])


#: How far the operands of an operation are from a kink or a pole of it.
_KINKS: Mapping[str, Callable[[Sequence[Vector]], Iterable[Number]]] = {
    "norm": _size,
    "direction": _size,
    "abs": _entries,
    "sqrt": _entries,
    "log": _entries,
    "div": _entries,
    "minimum": _gaps,
    "maximum": _gaps,
    "atan2": _radii,
    "asin": _to_one,
    "acos": _to_one,
}
