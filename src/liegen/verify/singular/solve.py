"""Arguments at which something of a formula vanishes, by Gauss-Newton steps on their manifolds.

Values and slopes come from the formula itself, by CasADi in double precision: they only say where to look.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.algebra.casadi_backend import ca
from liegen.differentiate.local import symbols
from liegen.manifolds import Leaf, ManifoldForm
from liegen.trace import Graph, topological

from ..draws import Values

Array = NDArray[np.float64]

STEPS = 50
#: What counts as solved; and how near a number must be to one with few digits to be rounded to it.
SOLVED, NEAR = 1e-9, 1e-8
#: Numbers with few digits are multiples of this.
DIGIT = 2.0**-10
#: A step that leaves more than this of the gap ends the search.
PROGRESS = 0.99


@dataclass(frozen=True, eq=False)
class Arguments:
    """The arguments of a graph as one row of numbers in the manifolds' own storage."""

    graph: Graph
    scalars: Mapping[int, Any]  # of every node, by identity
    stored: Any  # the row as symbols
    slope: Any  # the row by the tangents of all arguments
    retract: Callable[[Array, Array], Array]

    @property
    def tangents(self) -> dict[str, slice]:
        """The columns of each argument's tangent."""
        return _slices(self.graph, lambda form: form.dim)

    @property
    def places(self) -> dict[str, slice]:
        """The numbers of each argument in the row."""
        return _slices(self.graph, lambda form: form.size)

    def row(self, values: Values) -> Array:
        """The row of arguments that are stored in their layouts."""
        own = [p.storage.taken(values[p.name], normalise=self.graph.normalise) for p in self.graph.parameters]
        return np.array([float(x) for coords in own for x in coords])

    def values(self, row: Array) -> dict[str, tuple[float, ...]]:
        """The other way round."""
        places = self.places
        return {
            p.name: tuple(float(x) for x in p.storage.write(row[places[p.name]].tolist()))
            for p in self.graph.parameters
        }

    def gap(self, parts: Sequence[Any]) -> Gap:
        """What shall vanish, and its slope, as a function of the row."""
        value = ca.vertcat(*parts)
        slope = ca.mtimes(ca.jacobian(value, self.stored), self.slope)
        function = ca.Function("gap", [self.stored], [ca.densify(value), ca.densify(slope)])
        moving = np.array(ca.sum1(ca.DM(slope.sparsity(), 1.0))).ravel() > 0
        size = int(value.numel())

        def evaluate(row: Array) -> tuple[Array, Array]:
            found, slopes = function(row)
            return np.array(found).reshape(size), np.array(slopes).reshape(size, -1)

        return Gap(evaluate, moving)


@dataclass(frozen=True, eq=False)
class Gap:
    """``evaluate`` gives value and slope; ``moving``: the tangents that it depends on."""

    evaluate: Callable[[Array], tuple[Array, Array]]
    moving: NDArray[np.bool_]


def _slices(graph: Graph, size: Callable[[ManifoldForm], int]) -> dict[str, slice]:
    ends = np.cumsum([size(p.manifold.form) for p in graph.parameters]).tolist()
    return {
        p.name: slice(end - size(p.manifold.form), end) for p, end in zip(graph.parameters, ends, strict=True)
    }


def arguments(graph: Graph) -> Arguments:
    """The graph on symbols, with what ``singular`` names."""
    scalars: dict[int, Any] = {}
    rows: list[Any] = []
    moved: list[Any] = []
    tangents: list[Any] = []
    for p in graph.parameters:
        form = p.manifold.form
        x, d = symbols(f"{p.name}_", form.size), symbols(f"{p.name}_d", form.dim)
        scalars[id(p.node)] = x
        rows += x
        tangents += d
        moved += form.retract(x, d)
    for node in topological([*graph.nodes(), *(n for s in graph.singular for n in s.zeros)]):
        if id(node) not in scalars:
            scalars[id(node)] = (
                node.operation.coords
                if isinstance(node.operation, Leaf)
                else node.operation.value(*(scalars[id(n)] for n in node.operands))
            )
    row, end, d = ca.vertcat(*rows), ca.vertcat(*moved), ca.vertcat(*tangents)
    slope = ca.substitute(ca.jacobian(end, d), d, ca.DM.zeros(d.numel()))
    step = ca.Function("retract", [row, d], [end])
    return Arguments(graph, scalars, row, slope, lambda x, v: np.array(step(x, v)).ravel())


def solved(space: Arguments, gap: Gap, start: Array, moved: slice | None) -> Array | None:
    """The row moved to where ``gap`` vanishes, by one argument alone or by all; None where it does not.

    Where the gap is a square, which a plain step only halves, the step is doubled.
    """
    columns = gap.moving.copy()
    if moved is not None:
        columns[:] = False
        columns[moved] = gap.moving[moved]
    if not columns.any():
        return None
    row, (value, slope) = start, gap.evaluate(start)
    for _ in range(STEPS):
        size = _size(value)
        if size == 0 or not np.isfinite(slope[:, columns]).all():
            break
        d = np.zeros(slope.shape[1])
        d[columns] = np.linalg.lstsq(slope[:, columns], -value, rcond=1e-10)[0]
        ends = [space.retract(row, k * d) for k in (1.0, 2.0, 0.5)]
        reached = [(end, gap.evaluate(end)) for end in ends]
        best = min(reached, key=lambda entry: _size(entry[1][0]))
        if not _size(best[1][0]) <= PROGRESS * size:
            break
        row, (value, slope) = best
    return row if _size(value) <= SOLVED else None


def _size(value: Array) -> float:
    size = float(np.abs(value).max(initial=0.0))
    return size if np.isfinite(size) else np.inf


def rounded(row: Array) -> Array:
    """The row with numbers that have few digits where they are very near to such ones."""
    few = np.round(row / DIGIT) * DIGIT
    return np.where(np.abs(row - few) <= NEAR, few, row)


def plain(graph: Graph, row: Array) -> Array:
    """A similar row of numbers with few digits and rotations by nothing: from there zeros are hit exactly."""
    simple = [x for p, part in _parts(graph, row) for x in _plain(p, part)]
    return np.array(simple)


def _parts(graph: Graph, row: Array) -> Iterator[tuple[ManifoldForm, list[float]]]:
    for p, place in zip(graph.parameters, _slices(graph, lambda form: form.size).values(), strict=True):
        yield p.manifold.form, row[place].tolist()


def _plain(form: ManifoldForm, x: list[float]) -> list[float]:
    if form.parts:
        ends = np.cumsum([part.size for part in form.parts]).tolist()
        return [y for f, end in zip(form.parts, ends, strict=True) for y in _plain(f, x[end - f.size : end])]
    few = [round(8 * y) / 8 or 0.125 for y in x]
    if form.name == "S2":
        largest = int(np.argmax(np.abs(x)))
        return [float(np.sign(y)) if k == largest else 0.0 for k, y in enumerate(x)]
    for start in form.quaternions:
        few[start : start + 4] = [0.0, 0.0, 0.0, 1.0]
    if form.storage[:2] == ("c", "s"):
        few[:2] = [1.0, 0.0]
    return few
