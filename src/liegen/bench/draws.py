"""Inputs of a measurement: random ones, and those of a solver near its solution."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from liegen.samples import Case, Draw
from liegen.verify.draws import Sample, draw_one

from .variant import AnyFunction

#: Residuals of a pose graph near its solution: rotations [rad] and offsets [m] of this size.
SMALL_ANGLE, SMALL_OFFSET = 0.02, 0.05
RANDOM, SMALL = "random", "small"
SETS = (RANDOM, SMALL)


def samples(function: AnyFunction, kind: str, count: int, seed: int) -> tuple[Sample, ...]:
    """``count`` distinct samples of a kind, one of ``SETS``."""
    draw = Draw(np.random.default_rng([seed, SETS.index(kind)]))
    return tuple(draw_one(function, draw, _case(draw, kind)) for _ in range(count))


def _case(draw: Draw, kind: str) -> Case:
    if kind == RANDOM:
        return Case(RANDOM)
    angle, offset = (abs(draw.generator.normal()) * size for size in (SMALL_ANGLE, SMALL_OFFSET))
    return Case(SMALL, angle=float(angle), offset=float(offset))


def rows(drawn: tuple[Sample, ...]) -> NDArray[np.float64]:
    """The samples as rows of stored numbers, argument after argument."""
    return np.array([[x for v in sample.values.values() for x in v] for sample in drawn])
