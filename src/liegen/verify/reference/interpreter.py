"""Evaluating a graph with at least 45 correct digits, independently of liegen's own forms and derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import cameras, groups, tangent, vectors, weights
from .calls import Call, Rule
from .charts import space_in
from .layouts import load, store
from .logarithms import PRINCIPAL, Branch
from .matrix import Element, Vector, mp

if TYPE_CHECKING:
    from liegen.charts import Preset
    from liegen.layouts import Stored
    from liegen.manifolds import Node, Value
    from liegen.trace import Graph

#: Working precision. Rounding grows to about 1e-70 in a residual; differences lose another 25 digits.
DIGITS = 80

OPERATIONS: Mapping[str, Rule] = {
    **groups.OPERATIONS,
    **tangent.OPERATIONS,
    **vectors.OPERATIONS,
    **cameras.OPERATIONS,
    **weights.OPERATIONS,
}
Sample = Mapping[str, Sequence[float]]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The value of every node of a graph: matrices for groups, tuples for the rest, bools for conditions."""

    graph: Graph
    values: Mapping[Node, Element]

    def __getitem__(self, node: Node) -> Element:
        return self.values[node]

    @property
    def outputs(self) -> dict[str, Element]:
        """The outputs by name."""
        return {name: self.values[node] for name, node in self.graph.outputs}

    @property
    def holds(self) -> tuple[bool, ...]:
        """Whether each condition of the graph's domain holds."""
        return tuple(self.values[d.condition] for d in self.graph.domain)


def evaluate(
    graph: Graph, sample: Sample, near: Evaluation | None = None, *, flip: bool = False
) -> Evaluation:
    """Evaluate every node at a sample: stored floats for each parameter.

    Quaternions, (cos, sin) and unit vectors stand for the exact rotation or direction of their normalised
    form. Where something is undefined the values are NaN. With ``near`` logarithms (``local`` and ``atan2``
    too) take the branch nearest to their value there, comparisons keep their outcome, and tangent bases of S2
    their axis: the smooth continuation from ``near``. ``flip``: logarithms whose angle is within 1e-6 of pi
    take the other branch.
    """
    with mp.workdps(DIGITS):
        return run(graph, graph.nodes(), loaded(graph, sample), near, flip=flip)


def loaded(graph: Graph, sample: Sample) -> dict[Node, Element]:
    """The elements of all parameters at the working precision."""
    return {p.node: load(p.manifold, sample[p.name], p.layout) for p in graph.parameters}


def run(
    graph: Graph,
    nodes: Sequence[Node],
    given: Mapping[Node, Element],
    near: Evaluation | None = None,
    *,
    flip: bool = False,
) -> Evaluation:
    """Evaluate ``nodes``, operands first, at the working precision; keep what is unchanged since ``near``."""
    values: dict[Node, Element] = {}
    for node in nodes:
        if node in given:
            values[node] = given[node]
            continue
        operands = [values[n] for n in node.operands]
        old = near.values if near else None
        if old is not None and all(old[n] is v for n, v in zip(node.operands, operands, strict=True)):
            values[node] = old[node]
        else:
            start = old[node.operands[0]] if old is not None and operands else None
            branch = Branch(old[node] if old is not None else None, start, flip)
            values[node] = _value(node, operands, branch)
    return Evaluation(graph, values)


def _value(node: Node, operands: Sequence[Element], branch: Branch) -> Element:
    operation: Any = node.operation
    if operation.name == "constant":
        return load(operation.result, operation.coords)
    return OPERATIONS[operation.name](Call(operation, node.operands, operands, branch))


def outputs(
    graph: Graph, sample: Sample, near: Evaluation | None = None, *, flip: bool = False
) -> dict[str, Element]:
    """The outputs by name; see ``evaluate``."""
    return evaluate(graph, sample, near, flip=flip).outputs


def holds(graph: Graph, sample: Sample) -> tuple[bool, ...]:
    """Whether the sample meets each condition of the graph's domain."""
    return evaluate(graph, sample).holds


def difference(manifold: type[Value], a: Element, b: Element, chart: Preset | None = None) -> Vector:
    """The tangent vector at ``a`` that leads to ``b``."""
    with mp.workdps(DIGITS):
        return space_in(manifold, chart).local(a, b, PRINCIPAL)


def from_coords(manifold: type[Value], coords: Sequence[float]) -> Element:
    """The element that floats in liegen's own storage stand for."""
    with mp.workdps(DIGITS):
        return load(manifold, coords)


def to_coords(
    manifold: type[Value], element: Element, like: Sequence[float] | None = None, layout: Stored | None = None
) -> tuple[float, ...]:
    """Storage rounded to doubles; of q and -q the one nearer to ``like``, or with w >= 0."""
    with mp.workdps(DIGITS):
        return tuple(float(x) for x in store(manifold, element, layout, like))


def retract(
    manifold: type[Value],
    coords: Sequence[float],
    d: Sequence[float],
    chart: Preset | None = None,
    layout: Stored | None = None,
) -> tuple[float, ...]:
    """``coords`` moved by the tangent vector ``d``, rounded to doubles; a quaternion keeps its side."""
    with mp.workdps(DIGITS):
        step = tuple(mp.mpf(float(x)) for x in d)
        moved = space_in(manifold, chart).retract(load(manifold, coords, layout), step, Branch())
        return to_coords(manifold, moved, coords, layout)


def local(
    manifold: type[Value],
    a: Sequence[float],
    b: Sequence[float],
    chart: Preset | None = None,
    layout: Stored | None = None,
) -> tuple[float, ...]:
    """The tangent vector at ``a`` that leads to ``b``, rounded to doubles."""
    with mp.workdps(DIGITS):
        ends = load(manifold, a, layout), load(manifold, b, layout)
        return tuple(float(x) for x in space_in(manifold, chart).local(*ends, PRINCIPAL))
