"""Samples at the singular points of a formula."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from liegen.samples import CASES

from ..draws import AnyFunction, Sample, Values, generator_for
from .points import Point, points_of
from .solve import Arguments, Gap, arguments, plain, rounded, solved

Array = NDArray[np.float64]

#: Samples from which is solved; hits of a point from each of them that are enough; pairs of points.
STARTS, ENOUGH, PAIRS = 2, 3, 12
#: How far from a point the formula is looked at too, by a random step of all arguments.
AWAY = (1e-8, 1e-12)


@dataclass(frozen=True, eq=False)
class Hit:
    """Arguments at one singular point, or at two at once (``away``: that far from it)."""

    points: tuple[Point, ...]
    values: Values
    row: Array
    away: float = 0.0

    def sample(self, case: str) -> Sample:
        """As a sample, ill-conditioned by its nature."""
        return Sample(case, self.values, conditioned=True)


def solve(function: AnyFunction, samples: Sequence[Sample]) -> tuple[tuple[Hit, ...], Arguments]:
    """Hits of every singular point that arguments can reach, inside the domain or not."""
    space = arguments(function.plain)
    points = points_of(function.plain)
    gaps = [space.gap(_vanishing(space, point)) for point in points]
    starts = _starts(function, space, samples) if points else []
    hits: list[Hit] = []
    reached: list[tuple[Point, Gap]] = []
    for point, gap in zip(points, gaps, strict=True):
        mine = [hit for values, row in starts for hit in _hits(space, (point,), gap, values, row)]
        hits += mine
        if mine:
            reached.append((point, gap))
    for (a, _), (b, _) in list(combinations(reached, 2))[:PAIRS]:
        both = space.gap([*_vanishing(space, a), *_vanishing(space, b)])
        for values, row in starts[:2]:
            hits += _hits(space, (a, b), both, values, row, alone=False)
    return (*hits, *_around(function, space, hits)), space


def _vanishing(space: Arguments, point: Point) -> list[object]:
    node = point.node
    return list(point.place.gap(space.scalars[id(node)], [space.scalars[id(n)] for n in node.operands]))


def _starts(function: AnyFunction, space: Arguments, samples: Sequence[Sample]) -> list[tuple[Values, Array]]:
    """Rows of few digits first: they hit zeros exactly."""
    anywhere = [s for s in samples if s.case == CASES[0].name][:STARTS] or list(samples[:STARTS])
    rows = [(s.values, space.row(s.values)) for s in anywhere]
    return [entry for v, row in rows for entry in ((v, plain(function.plain, row)), (v, row))]


def _hits(
    space: Arguments, points: tuple[Point, ...], gap: Gap, values: Values, row: Array, *, alone: bool = True
) -> Iterator[Hit]:
    """From one row: by each argument alone, then by all."""
    found: set[bytes] = set()
    count = 0
    for moved in (*(space.tangents.values() if alone else ()), None):
        end = solved(space, gap, row, moved)
        if end is None:
            continue
        for x in (end, rounded(end)):
            if x.tobytes() not in found and np.abs(gap.evaluate(x)[0]).max() <= 1e-9:
                found.add(x.tobytes())
                yield Hit(points, {**values, **space.values(x)}, x)
        count += 1
        if count == ENOUGH:
            return


def _around(function: AnyFunction, space: Arguments, hits: Sequence[Hit]) -> Iterator[Hit]:
    """Arguments near to the first hit of each point."""
    generator = generator_for(function.name, "around")
    seen: set[int] = set()
    size = sum(p.manifold.form.dim for p in function.plain.parameters)
    for hit in hits:
        if len(hit.points) == 1 and id(hit.points[0]) not in seen:
            seen.add(id(hit.points[0]))
            step = generator.normal(size=size)
            for away in AWAY:
                row = space.retract(hit.row, away * step / np.linalg.norm(step))
                yield Hit(hit.points, {**hit.values, **space.values(row)}, row, away)
