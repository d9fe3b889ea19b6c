"""Robust factors: J^T r of the weighed outputs is the gradient of the cost 1/2 rho(|S r|^2).

The gradient is that of the cost in the reference, by differences in high precision. A Jacobian of iteratively
reweighted or corrected least squares is no derivative of its residual, so the checks by differences and
remainders do not apply; :mod:`liegen.verify.weighed` has its definition.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.noise import Weighting, cost_graph
from liegen.trace import Graph

from . import reference
from .draws import AnyFunction, Sample, batch
from .expected import BOUND
from .report import Check
from .rounding import rounding

Array = NDArray[np.float64]
UNIT = "relative to max(1, |J|^T |r|)"


def gradient(
    function: AnyFunction,
    weighting: Weighting,
    samples: Sequence[Sample],
    results: Mapping[str, Mapping[str, Array]],
    branches: Sequence[int],
) -> Check:
    """Compare J^T r of every back end that has Jacobians.

    ``branches`` tells which logarithm the code took at a half turn.
    """
    cost = cost_graph(function.plain, weighting)
    allowed = rounding(function.kernel.jacobians, batch(tuple(samples)))
    variables = [p.name for p in function.plain.variables]
    worst, where, kept = 0.0, "", 0
    skipped: list[str] = []
    for k, sample in enumerate(samples):
        exact = exact_gradient(cost, sample, flip=bool(branches[k]))
        if not all(np.isfinite(g).all() for g in exact.values()):
            skipped.append(f"{sample.case}: the gradient of the reference is not finite")
            continue
        kept += 1
        for backend, arrays in results.items():
            for v in (v for v in variables if f"res_D_{v}" in arrays):
                J, r = arrays[f"res_D_{v}"][k], arrays["res"][k]
                size = np.abs(J).sum(axis=0).max() * np.abs(r).max()
                lost = float(allowed[f"res_D_{v}"][k] * np.abs(r).sum() + allowed["res"][k] * np.abs(J).sum())
                bound = BOUND * max(1.0, float(size)) + lost
                error = float(np.abs(J.T @ r - exact[v]).max()) / bound
                if not error <= worst:
                    worst, where = (error if np.isfinite(error) else np.inf), f"{v}, {backend}, {sample.case}"
    note = "" if kept else "no sample could be compared"
    passed = worst <= 1.0 and 2 * kept >= len(samples) > 0
    return Check("gradient", passed, worst * BOUND, BOUND, UNIT, where, kept, tuple(skipped), note)


def exact_gradient(cost: Graph, sample: Sample, *, flip: bool = False) -> dict[str, Array]:
    """By variable, the derivative of the reference's cost."""
    jacobians: Any = reference.jacobians(cost, sample.values, flip=flip)
    return {v: np.array([float(x) for x in rows[0]]) for (_, v), rows in jacobians.items()}


def not_applicable(name: str, mode: str) -> Check:
    """A check that a robust factor does not take."""
    note = f"does not apply: Jacobians of mode {mode} are no derivative of res; see gradient"
    return Check(name, True, 0.0, 0.0, "", "", 0, note=note, checked=False)
