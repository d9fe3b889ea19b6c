"""The search for the smallest explanation that fits all samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..points import every
from .columns import of_columns
from .constants import of_constants
from .difference import Array, Difference, Subject, applied
from .elsewhere import Elsewhere, of_elsewhere
from .factors import of_factors
from .nodes import held_constant
from .rows import of_rows

#: The order in which differences apply, and in which they are told.
KINDS = ("base", "jr", "factor", "columns", "block", "scale", "rows", "sign")
#: Kinds that combine with each other in any number, and with two of them to each other kind.
_CORE = ("jr", "columns", "rows", "sign")
#: Points at which an explanation is tried before it is tried at all.
_FIRST = 2
#: Differences that are no more than that from nothing, or from another one, are left out.
_SAME = 1e-9
#: An explanation must say something at that part of the general samples.
_KNOWN = 0.25


@dataclass(frozen=True)
class Explanation:
    """Differences that fit the general samples, and the samples that they do not fit.

    ``tried`` is the number of explanations that were tried.
    """

    differences: tuple[Difference, ...]
    misses: NDArray[np.bool_]  # of each sample
    tried: int
    same: tuple[Difference, ...] = ()  # others, each of which explains as much

    @property
    def phrases(self) -> tuple[str, ...]:
        """The differences in words."""
        return tuple(p for d in self.differences for p in d.phrases)


def misfits(subject: Subject, array: Array, tolerance: float) -> NDArray[np.bool_]:
    """The samples at which the foreign output is not the array (P, m, n); where that is NaN all fits."""
    return ~every(agreeing(subject, array, tolerance))


def agreeing(subject: Subject, array: Array, tolerance: float) -> NDArray[np.bool_]:
    """For each sample the entries that are those of the array, at the better one of its points."""
    sampled = subject.sampled
    found = subject.found[sampled.owners]
    with np.errstate(all="ignore"):
        scale = np.maximum(1.0, np.abs(array).max(axis=(1, 2), initial=0.0))
        relative = np.abs(found - array) / scale[:, None, None]
    allowed = np.full(sampled.points, tolerance)
    beside = np.setdiff1d(np.arange(sampled.points), sampled.firsts)
    allowed[beside] = max(tolerance, 1e-6)
    unknown = ~every(np.isfinite(array))
    good: Any = np.logical_or(relative <= allowed[:, None, None], unknown[:, None, None])
    result: NDArray[np.bool_] = np.array(good[sampled.firsts], dtype=bool)
    for k in beside:
        owner = sampled.owners[k]
        if np.count_nonzero(good[k]) > np.count_nonzero(result[owner]):
            result[owner] = good[k]
    return result


def known_differences(subject: Subject, places: tuple[Elsewhere, ...]) -> tuple[Difference, ...]:
    """Every known difference, once, without those that change nothing."""
    first = subject.sampled.first_points(_FIRST + 1)
    general = np.flatnonzero(subject.sampled.general[subject.sampled.owners])
    kept: list[Difference] = []
    seen: list[tuple[Array, Difference]] = []
    everything = (
        *of_rows(subject), *of_columns(subject), *of_constants(subject),
        *of_elsewhere(subject, places), *of_factors(subject),
    )  # fmt: skip
    expected = subject.expected[first]
    for d in sorted(everything, key=lambda d: d.size):
        effect = applied([d.at(first)], expected)
        if _near(effect, expected) or not enough(applied([d.at(general)], subject.expected[general])):
            continue
        alike = (k for k, (e, other) in enumerate(seen) if other.kind == d.kind and _near(e, effect))
        twin = next(alike, None)
        if twin is None:
            seen.append((effect, d))
            kept.append(d)
        else:
            kept[twin] = _merged(kept[twin], d)
    return tuple(kept)


def _merged(a: Difference, d: Difference) -> Difference:
    known = (a.text, *a.same)
    same = a.same if d.text in known or d.charts else (*a.same, d.text)
    return replace(a, charts=(*a.charts, *d.charts), same=same)


def _near(a: Array, b: Array) -> bool:
    if a.shape != b.shape or not np.isfinite(a).any():
        return False
    with np.errstate(all="ignore"):
        same = np.abs(a - b) <= _SAME * np.maximum(1.0, np.abs(b))
    return bool((same | (np.isnan(a) & np.isnan(b))).all())


def enough(array: Array) -> bool:
    """Whether an output is known at a good part of the points."""
    return bool(np.mean(every(np.isfinite(array))) >= _KNOWN)


def explained(
    subject: Subject, places: tuple[Elsewhere, ...], tolerance: float, *, last: bool = True
) -> Explanation:
    """The smallest explanation that fits all samples; else the first that fits all general ones.

    Without any, the differences are empty and the samples that miss are those at which the output differs
    from the formula's. ``last``: also the ones that take longest are tried.
    """
    plain = misfits(subject, subject.expected, tolerance)
    general = subject.sampled.general
    if not plain.any():
        return Explanation((), plain, 0)
    if not (plain & general).any():
        return Explanation((), plain, 0)
    partial: Explanation | None = None
    tried = 0
    for stage in _stages(subject, places, last=last):
        fits = _Fits(subject, tolerance)
        for combined in stage:
            tried += 1
            if not fits.first(combined):
                continue
            misses = misfits(subject, applied(combined, subject.expected), tolerance)
            if not misses.any():
                same = _others(subject, stage, combined, fits, tolerance) if len(combined) == 1 else ()
                return Explanation(tuple(combined), misses, tried, same)
            if partial is None and not (misses & general).any():
                partial = Explanation(tuple(combined), misses, tried)
        if partial is not None:
            return partial
    return Explanation((), plain, tried)


def _others(
    subject: Subject,
    stage: Sequence[tuple[Difference, ...]],
    found: tuple[Difference, ...],
    fits: _Fits,
    tolerance: float,
) -> tuple[Difference, ...]:
    """Other single differences that fit all samples too."""
    return tuple(
        d
        for (d,) in stage
        if d is not found[0]
        and fits.first((d,))
        and not misfits(subject, applied((d,), subject.expected), tolerance).any()
    )


class _Fits:
    """Whether differences fit at the first points, which is quick."""

    def __init__(self, subject: Subject, tolerance: float) -> None:
        sampled = subject.sampled
        self.points = sampled.first_points(_FIRST)
        self.expected = subject.expected[self.points]
        self.found = subject.found[sampled.owners[self.points]]
        self.tolerance = tolerance
        self.cut: dict[int, Difference] = {}

    def first(self, differences: Sequence[Difference]) -> bool:
        """Whether they fit there."""
        few = [self._at(d) for d in differences]
        array = applied(few, self.expected)
        if array.shape != self.found.shape:
            return False
        largest = np.fmax(1.0, np.abs(array).max(initial=0.0))
        with np.errstate(all="ignore"):
            near = np.abs(array - self.found) <= self.tolerance * largest
        return bool((near | np.isnan(array)).all())

    def _at(self, d: Difference) -> Difference:
        if id(d) not in self.cut:
            self.cut[id(d)] = d.at(self.points)
        return self.cut[id(d)]


def _stages(
    subject: Subject, places: tuple[Elsewhere, ...], *, last: bool
) -> Iterator[list[tuple[Difference, ...]]]:
    """Explanations in groups: within a group those of smaller size first."""
    known = known_differences(subject, places)
    ordered = sorted(known, key=lambda d: KINDS.index(d.kind))
    yield _by_size([(d,) for d in ordered])
    yield _by_size([(a, b) for a, b in combinations(ordered, 2) if a.kind != b.kind])
    if not last:
        return
    core = [[None, *(d for d in ordered if d.kind == kind)] for kind in _CORE]
    others = [None, *(d for d in ordered if d.kind not in _CORE)]
    yield _by_size([c for pick in product(*core) if len(c := tuple(d for d in pick if d is not None)) > 2])
    kinds = ("columns", "rows", "sign")
    pairs = [[None, *(d for d in ordered if d.kind == k and d.size <= 1.0)] for k in kinds]
    yield _by_size(
        [
            tuple(sorted((o, *(d for d in pick if d is not None)), key=lambda d: KINDS.index(d.kind)))
            for o in others
            if o is not None
            for pick in product(*pairs)
            if sum(d is not None for d in pick) > 1
        ]
    )
    held = [*held_constant(subject)]
    yield _by_size([(d,) for d in held])
    signs = [d for d in ordered if d.kind in ("sign", "columns") and d.size <= 1.0]
    yield _by_size([(h, d) for h in held for d in signs])


def _by_size(explanations: list[tuple[Difference, ...]]) -> list[tuple[Difference, ...]]:
    return sorted(explanations, key=lambda e: sum(d.size for d in e))
