"""The order of the Taylor remainder: f(x + h d) - f(x) - h J d must shrink as h^2.

Computed with the residual of the reference in high precision, so nothing drowns in rounding. A Jacobian with
an error of one per cent leaves a term of first order, whatever the size of the second derivative.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import Node
from liegen.trace import Graph, Parameter

from . import reference
from .draws import Sample, generator_for
from .reference.charts import space_in
from .reference.interpreter import loaded, run
from .reference.logarithms import PRINCIPAL
from .reference.matrix import mp
from .report import Check

Array = NDArray[np.float64]

#: Powers of ten; the last two give the slope, small enough to see an error of 1e-5 in an entry.
STEPS = (-1, -3, -5, -7)
SLOPE = 1.9
#: Directions in turn: few, because the reference keeps the exponentials of steps that it has seen.
DIRECTIONS = 4
#: The error of a Jacobian where none is given.
ROUNDING = 1e-13


def taylor(
    graph: Graph,
    samples: Sequence[Sample],
    jacobians: Mapping[str, Array],
    branches: Sequence[int],
    allowed: Mapping[str, Array],
) -> Check:
    """Slopes at all samples, by a random direction of each variable.

    Samples where even the reference's own Jacobian shows no slope of 2 (a kink, or a scale below the steps)
    are skipped. ``branches`` tells which logarithm the code took at a half turn, ``allowed`` the error that
    each Jacobian may have at each sample: what it leaves of the first order counts as rounding.
    """
    least, where, kept = np.inf, "", 0
    skipped: list[str] = []
    for k, sample in enumerate(samples):
        mine = {name: array[k] for name, array in jacobians.items()}
        flip, turn = bool(branches[k]), k % DIRECTIONS
        floors = {name: float(bound[k]) for name, bound in allowed.items()}
        slopes = remainder_slopes(graph, sample, mine, floors, flip=flip, turn=turn)
        name, slope = min(slopes.items(), key=lambda item: item[1])
        if not slope >= SLOPE and not _smooth(graph, sample, name, flip=flip, turn=turn):
            skipped.append(f"{sample.case}: no second order at steps of 1e-1 to 1e-7")
            continue
        kept += 1
        if not slope >= least:
            least, where = slope, f"{name}, {sample.case}"
    note = "" if kept else "no sample is smooth at these steps"
    passed = bool(least >= SLOPE) and 2 * kept >= len(samples) > 0
    return Check("Taylor", passed, least, SLOPE, "slope, at least", where, kept, tuple(skipped), note)


def _smooth(graph: Graph, sample: Sample, name: str, *, flip: bool, turn: int) -> bool:
    exact: Any = reference.jacobians(graph, sample.values, flip=flip)
    rows = {f"{out}_D_{p}": np.array([[float(x) for x in row] for row in J]) for (out, p), J in exact.items()}
    return remainder_slopes(graph, sample, rows, {}, flip=flip, turn=turn)[name] >= SLOPE


def remainder_slopes(
    graph: Graph,
    sample: Sample,
    jacobians: Mapping[str, Array],
    allowed: Mapping[str, float],
    *,
    flip: bool = False,
    turn: int = 0,
) -> dict[str, float]:
    """By Jacobian, the slope of log10 |remainder| over the last steps.

    Infinite where the remainder is only the rounding of J, minus infinity where something is not finite.
    """
    slopes: dict[str, float] = {}
    with mp.workdps(reference.DIGITS):
        given = loaded(graph, sample.values)
        base = run(graph, graph.nodes(), given, flip=flip)
        for p in graph.variables:
            d = _direction(graph, p, turn)
            rows = [_remainders(base, given, p, d, jacobians, power) for power in STEPS]
            for name, _ in graph.outputs:
                block = f"{name}_D_{p.name}"
                # |J d| <= sqrt(columns) max|J| for a unit d
                floor = allowed.get(block, ROUNDING) * len(d) ** 0.5 * 10.0 ** STEPS[-1]
                slopes[block] = _slope([row[name] for row in rows], floor)
    return slopes


def _slope(sizes: Sequence[float], floor: float) -> float:
    if not np.isfinite(sizes).all():
        return -np.inf
    if sizes[-1] <= floor:
        return np.inf
    return float(np.log10(sizes[-2] / sizes[-1])) / (STEPS[-2] - STEPS[-1]) if sizes[-2] else -np.inf


def _direction(graph: Graph, p: Parameter, turn: int) -> Array:
    """A random unit vector, in doubles that the reference takes as exact."""
    v = generator_for(graph.name, "direction", p.name, turn).normal(size=p.manifold.form.dim)
    return v / np.linalg.norm(v)


def _remainders(
    base: reference.Evaluation,
    given: Mapping[Node, Any],
    p: Parameter,
    direction: Array,
    jacobians: Mapping[str, Array],
    power: int,
) -> dict[str, float]:
    """|f(x + h d) - f(x) - h J d| for every output, h = 10^power; d moves the variable p."""
    step = tuple(mp.mpf(10) ** power * mp.mpf(float(x)) for x in direction)
    moved = space_in(p.manifold, p.chart).retract(given[p.node], step, PRINCIPAL)
    end = run(base.graph, tuple(base.values), {**given, p.node: moved}, base)
    sizes: dict[str, float] = {}
    for name, node in base.graph.outputs:
        change = reference.difference(node.manifold, base[node], end[node], base.graph.chart)
        rows: list[list[float]] = jacobians[f"{name}_D_{p.name}"].tolist()
        linear = [mp.fdot([mp.mpf(x) for x in row], step) for row in rows]
        gaps = [abs(c - e) for c, e in zip(change, linear, strict=True)]
        sizes[name] = float(max(gaps)) if all(map(mp.isfinite, gaps)) else np.nan
    return sizes
