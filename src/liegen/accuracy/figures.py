"""The figures of one function: its worst errors by angle, of each output and Jacobian, of C and of NumPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liegen.verify.backends import Backend, Workspace, backends
from liegen.verify.branches import Entries, both_branches
from liegen.verify.draws import AnyFunction, Sample, batch
from liegen.verify.expected import Block, Comparison, Expected, compare

from .conditioning import amplification
from .points import COLUMNS, SMALL, Point, draw_points

Array = NDArray[np.float64]
#: What an error may be, relative to max(1, s).
BOUND = 1e-14
#: Targets by the beginning of the names of their back ends.
TARGETS = ("C", "NumPy")


@dataclass(frozen=True)
class Figure:
    """Worst errors of a block in one target, relative to max(1, s), by column; None: nothing is compared.

    s is the largest absolute entry of the reference's block (in the column ``small`` of the inputs); errors
    are divided by :func:`liegen.accuracy.conditioning.amplification`. ``where`` is the kind of the worst
    sample. Infinite: not a number.
    """

    block: str
    is_value: bool
    target: str
    worst: tuple[float | None, ...]
    where: tuple[str, ...]

    @property
    def largest(self) -> float:
        """The worst of all columns."""
        return max((x for x in self.worst if x is not None), default=0.0)


@dataclass(frozen=True)
class Left:
    """A column where samples had nothing to compare with, or two logarithms."""

    column: str
    blocks: tuple[str, ...]
    samples: int
    why: str  # "undefined", "no digits left", "two logarithms" or "outside" of the domain


@dataclass(frozen=True)
class Measured:
    """A function in a chart: its figures and what was left out."""

    figures: tuple[Figure, ...]
    left: tuple[Left, ...]
    samples: int


def measure_function(function: AnyFunction, place: Workspace, count: int, seed: int) -> Measured:
    """Draw ``count`` samples for each angle and compare C and NumPy with the reference."""
    points, refused = draw_points(function, count, seed)
    expected, left = reference_blocks(function, points)
    outside = tuple(Left(title, (), count, "outside") for title in refused)
    figures = target_figures(function, place, expected, points)
    return Measured(tuple(figures), (*left, *outside), len(points))


def target_figures(
    function: AnyFunction, place: Workspace, expected: Expected, points: Sequence[Point]
) -> list[Figure]:
    """The figures of C and of NumPy."""
    results: dict[str, list[Mapping[str, Array]]] = {}
    for backend in backends(function.kernel, place) if points else ():
        target = next((t for t in TARGETS if backend.name.partition(",")[0] == t), None)
        if target:
            results.setdefault(target, []).extend(_evaluated(backend, target, points))
    return [
        figure
        for target, computed in sorted(results.items())
        for figure in figures_of(expected, points, target, computed)
    ]


def _evaluated(backend: Backend, target: str, points: Sequence[Point]) -> list[dict[str, Array]]:
    """All points as a batch; NumPy also one at a time, which is other code."""
    arguments = batch(tuple(p.sample for p in points))
    found = [backend.evaluate(arguments)]
    if target == "NumPy":
        rows = [backend.evaluate({name: a[k] for name, a in arguments.items()}) for k in range(len(points))]
        found.append({name: np.stack([row[name] for row in rows]) for name in rows[0]})
    return found


def reference_blocks(function: AnyFunction, points: Sequence[Point]) -> tuple[Expected, tuple[Left, ...]]:
    """The reference at all points, with max(1, s) over the sine as bounds, and what it does not define."""
    graph = function.graph
    samples = tuple(p.sample for p in points)
    branches = [both_branches(graph, s) for s in samples]
    outputs = dict(graph.outputs)
    names = branches[0][0] if branches else ()
    slack = {name: np.array([amplification(graph, s.values, name) for s in samples]) for name in names}
    floor = np.array([_floor(p) for p in points])
    blocks: list[Block] = []
    for name in names:
        stacked = np.array([[pair[b][name] for pair in branches] for b in range(2)], dtype=np.float64)
        bound = np.maximum(floor if name in outputs else 1.0, np.abs(stacked).max(axis=2)) * slack[name]
        kept = np.isfinite(stacked).all(axis=(0, 2)) & np.isfinite(slack[name])
        quaternions = outputs[name].manifold.form.quaternions if name in outputs else ()
        blocks.append(Block(name, name in outputs, stacked, bound, np.zeros(len(samples)), kept, quaternions))
    finite = np.all([np.isfinite(x) for x in slack.values()], axis=0)
    return (
        Expected(samples, tuple(blocks), np.ones(len(samples)), ()),
        tuple(_left(points, branches, finite, blocks)),
    )


def _floor(point: Point) -> float:
    """Least s: 1, and for small differences of pixels the largest number that goes in."""
    return (
        max(1.0, *(abs(c) for v in point.sample.values.values() for c in v)) if point.column == SMALL else 1.0
    )


def _left(
    points: Sequence[Point],
    branches: Sequence[tuple[Entries, Entries]],
    finite: NDArray[np.bool_],
    blocks: Sequence[Block],
) -> list[Left]:
    found: list[Left] = []
    for column, title in enumerate(COLUMNS):
        mine = [k for k, p in enumerate(points) if p.column == column]
        reasons = (
            ("no digits left", [k for k in mine if not finite[k]], blocks),
            ("two logarithms", [k for k in mine if branches[k][0] is not branches[k][1]], ()),
            (
                "undefined",
                [k for k in mine if finite[k] and not all(b.kept[k] for b in blocks)],
                [b for b in blocks if any(finite[k] and not b.kept[k] for k in mine)],
            ),
        )
        found += [Left(title, tuple(b.name for b in of), len(ks), why) for why, ks, of in reasons if ks]
    return found


def figures_of(
    expected: Expected, points: Sequence[Point], target: str, results: Sequence[Mapping[str, Array]]
) -> list[Figure]:
    """The worst of several results of one target, block by block."""
    compared: dict[str, list[Comparison]] = {}
    for arrays in results:
        for comparison in compare(expected, arrays):
            compared.setdefault(comparison.block.name, []).append(comparison)
    columns = np.array([p.column for p in points])
    return [
        _figure(found[0].block, target, columns, np.max([c.ratio for c in found], axis=0), expected.samples)
        for found in compared.values()
    ]


def _figure(
    block: Block, target: str, columns: NDArray[np.int_], errors: Array, samples: Sequence[Sample]
) -> Figure:
    worst: list[float | None] = []
    where: list[str] = []
    for column in range(len(COLUMNS)):
        mine = np.flatnonzero((columns == column) & block.kept)
        at = int(mine[np.argmax(errors[mine])]) if len(mine) else None
        worst.append(None if at is None else float(errors[at]))
        where.append("" if at is None else samples[at].case)
    return Figure(block.name, block.is_value, target, tuple(worst), tuple(where))
