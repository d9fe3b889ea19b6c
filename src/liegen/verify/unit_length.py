"""How wrong results become where a quaternion, a (cos, sin) or a direction is off unit length.

The rotation that such numbers stand for is that of their normalised form, so the right results are those of
the unit numbers. Rotation matrices are scaled alike; the nearest rotation stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from liegen.kernel import Kernel
from liegen.samples import CASES, Draw

from .backends import program_evaluator
from .draws import TRIES, AnyFunction, Sample, batch, draw_one, generator_for, program_domain
from .report import OffUnit

Array = NDArray[np.float64]
Evaluate = Callable[[Mapping[str, Array]], Mapping[str, Array]]

#: By how much lengths are off.
OFF = (1e-8, 1e-3)
SAMPLES = 8


def off_unit(function: AnyFunction, seed: int) -> tuple[OffUnit, ...]:
    """The largest errors over a few random samples, as the code is and with ``normalise``.

    Relative to max(1, s), with s the largest absolute entry of the inputs or of the right result. Empty where
    nothing is stored with unit length, or no sample is inside the domain with finite results.
    """
    places = {p.name: p.storage.lengths for p in function.graph.parameters}
    if not any(places.values()):
        return ()
    inside = program_domain(function)
    draw = Draw(generator_for("off unit length", seed, function.name))
    drawn = (draw_one(function, draw, CASES[0]) for _ in range(SAMPLES + TRIES))
    kernels = function.kernel, function.in_layout(None, normalise=True).kernel
    evaluated = program_evaluator(kernels[0].jacobians)
    kept = _finite(evaluated, tuple(s for s in drawn if inside(function.graph, s.values)))[:SAMPLES]
    if not kept:
        return ()
    given = batch(kept)
    right = evaluated(given)
    return tuple(
        OffUnit(off, *(_error(kernel, _stretched(given, places, off), right) for kernel in kernels))
        for off in OFF
    )


def _finite(evaluated: Evaluate, samples: tuple[Sample, ...]) -> tuple[Sample, ...]:
    """The samples at which every result is finite: log(z) has none for half of all numbers."""
    if not samples:
        return samples
    results = evaluated(batch(samples)).values()
    finite = np.all([np.isfinite(a.reshape(len(a), -1)).all(axis=1) for a in results], axis=0)
    return tuple(s for s, good in zip(samples, finite, strict=True) if good)


def _stretched(
    given: Mapping[str, Array], places: Mapping[str, tuple[tuple[int, ...], ...]], off: float
) -> dict[str, Array]:
    """The arguments with every length off by the same."""
    stretched = {name: array.copy() for name, array in given.items()}
    for name, lengths in places.items():
        for length in lengths:
            stretched[name][:, list(length)] *= 1 + off
    return stretched


def _error(kernel: Kernel, arguments: Mapping[str, Array], right: Mapping[str, Array]) -> float:
    found = program_evaluator(kernel.jacobians)(arguments)
    inputs = np.max([np.abs(np.nan_to_num(a)).max(axis=1) for a in arguments.values()], axis=0)
    worst = 0.0
    for name, array in right.items():
        flat, exact = (a.reshape(len(inputs), -1) for a in (found[name], array))
        scale = np.maximum(np.maximum(1.0, inputs), np.abs(exact).max(axis=1))
        ratio = np.abs(flat - exact).max(axis=1) / scale
        worst = max(worst, float(ratio.max()) if np.isfinite(ratio).all() else np.inf)
    return worst
