"""Central differences on the manifold in double precision, with a sweep of the step.

Which step is best is decided by the differences alone: by how much the next smaller step changes them, plus
rounding. The Jacobian must then be within twice that estimate, and within 1e-7 of its scale.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import Vector
from liegen.trace import Graph, Parameter

from . import reference
from .backends import Evaluate
from .branches import EPS
from .draws import Sample, Values
from .report import Check

Array = NDArray[np.float64]

#: Steps in the tangent space [its unit], powers of two.
STEPS = tuple(2.0**-k for k in (5, 8, 11, 14, 17, 20))
BOUND = 1e-7
#: Estimates above this (relative to the scale) resolve nothing: a kink or a pole is nearer than the steps.
RESOLVED = 1e-4
#: One-sided slopes that are further apart (relative to the scale) show a kink.
KINK = 1e-3
#: Changes above this may be a turn of a logarithm [rad]; the largest step moves a rotation by 0.03.
JUMP = 1.0
#: Samples to look at.
SAMPLES = 5


@dataclass(frozen=True)
class Difference:
    """Error of a Jacobian over what is allowed, at one sample; None where the differences resolve nothing."""

    block: str
    ratio: float
    error: float


def differences(
    graph: Graph, samples: Sequence[Sample], evaluate: Evaluate, jacobians: Mapping[str, Array]
) -> Check:
    """Compare Jacobians with differences of ``evaluate`` at the first ``SAMPLES`` samples that resolve."""
    resolved: list[tuple[Sample, Difference]] = []
    skipped: list[str] = []
    kept = 0
    for k, sample in enumerate(samples):
        if kept >= SAMPLES:
            break
        found = [
            _compared(graph, sample, p, evaluate, {name: array[k] for name, array in jacobians.items()})
            for p in graph.variables
        ]
        if any(entry is None for entry in found):
            skipped.append(f"{sample.case}: a kink or pole within the steps")
            continue
        kept += 1
        resolved += [(sample, d) for entry in found if entry for d in entry]
    sample, worst = max(resolved, key=lambda pair: pair[1].ratio, default=(None, Difference("", 0.0, 0.0)))
    where = f"{worst.block}, {sample.case}" if sample and worst.ratio else ""
    passed = worst.ratio <= 1.0 and 2 * kept >= min(SAMPLES, len(samples)) > 0
    note = "" if kept else "no sample could be differenced"
    unit = "relative to max(1, s)"
    return Check("differences", passed, worst.error, BOUND, unit, where, kept, tuple(skipped), note)


def _compared(
    graph: Graph, sample: Sample, p: Parameter, evaluate: Evaluate, jacobians: Mapping[str, Array]
) -> list[Difference] | None:
    """All blocks by one variable; None where an output is not resolved."""
    found: list[Difference] = []
    moved = [*_moved(sample.values, p), dict(sample.values)]
    results = evaluate({name: np.array([m[name] for m in moved]) for name in sample.values})
    for name, node in graph.outputs:
        ends = results[name]
        if not np.isfinite(ends).all():
            return None
        smooth = _unwrapped(graph, name, sample.values, moved, ends).reshape(len(ends), -1)
        changes = _changes(node.manifold, graph, smooth)
        changes = changes.reshape(len(STEPS), p.manifold.form.dim, 2, -1)
        size = max(1.0, float(np.abs(ends).max()), *(abs(x) for v in sample.values.values() for x in v))
        estimate, slope = _best(changes, size)
        scale = max(1.0, float(np.abs(slope).max()))
        if estimate.max() > RESOLVED * scale or _kinked(changes, size, scale):
            return None
        error = np.abs(slope - jacobians[f"{name}_D_{p.name}"].T).max(axis=1)
        ratio = np.where(np.isfinite(error), error / (BOUND * scale + 2 * estimate), np.inf)
        found.append(Difference(f"{name}_D_{p.name}", float(ratio.max()), float(error.max()) / scale))
    return found


def _best(changes: Array, size: float) -> tuple[Array, Array]:
    """By column: the smallest estimate of the error over the steps, and the slope at that step."""
    steps = np.array(STEPS)[:, None, None]
    slopes = (changes[:, :, 0] - changes[:, :, 1]) / (2 * steps)
    estimate = np.abs(slopes[:-1] - slopes[1:]).max(axis=2) + 8 * EPS * size / steps[1:, :, 0]
    best = np.argmin(estimate, axis=0)
    rows = best[:, None]
    chosen = np.take_along_axis(slopes, rows[None] + 1, axis=0)[0]
    return estimate.min(axis=0), chosen


def _kinked(changes: Array, size: float, scale: float) -> bool:
    """Whether both one-sided slopes still differ at the smallest step: central differences show no kink."""
    gap = np.abs(changes[-1, :, 0] + changes[-1, :, 1]).max() / STEPS[-1]
    return bool(gap > KINK * scale + 32 * EPS * size / STEPS[-1])


def _moved(values: Values, p: Parameter) -> list[dict[str, tuple[float, ...]]]:
    """Stored values for every step, tangent direction and sign, in this order."""
    moved: list[dict[str, tuple[float, ...]]] = []
    for step in STEPS:
        for column in range(p.manifold.form.dim):
            for sign in (1.0, -1.0):
                d = [sign * step if i == column else 0.0 for i in range(p.manifold.form.dim)]
                end = reference.retract(p.manifold, values[p.name], d, p.chart, p.layout)
                moved.append({**values, p.name: end})
    return moved


def _changes(manifold: Any, graph: Graph, ends: Array) -> Array:
    """The tangent vectors from the last result to the others."""
    if _is_vector(manifold):
        return ends[:-1] - ends[-1]
    start = tuple(ends[-1].tolist())
    others = [tuple(end.tolist()) for end in ends[:-1]]
    return np.array([reference.local(manifold, start, end, graph.chart, graph.layout) for end in others])


def _is_vector(manifold: Any) -> bool:
    return issubclass(manifold, Vector)


def _unwrapped(graph: Graph, name: str, values: Values, moved: Sequence[Values], ends: Array) -> Array:
    """Vectors that jump by turns of a logarithm's cut, put together by the jumps of the reference."""
    node = dict(graph.outputs)[name]
    jump = np.abs(ends - ends[-1]).max() > JUMP
    if not _is_vector(node.manifold) or not jump:
        return ends
    base = reference.evaluate(graph, values)
    smooth_ends = ends.copy()
    for k, values_k in enumerate(moved):
        smooth = _floats(reference.outputs(graph, values_k, base)[name])
        seen = [_floats(reference.outputs(graph, values_k, flip=flip)[name]) for flip in (False, True)]
        smooth_ends[k] += smooth - min(seen, key=lambda s: float(np.abs(s - ends[k]).max()))
    return smooth_ends


def _floats(element: Any) -> Array:
    return np.array([float(x) for x in element])
