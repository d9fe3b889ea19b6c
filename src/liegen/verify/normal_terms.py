"""Gauss-Newton terms: g against J^T r and H against J^T J.

J and r are the reference's. An entry may be off by what the bounds of J and r make of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.kernel import Kernel
from liegen.names import block_name, gradient_name
from liegen.noise import Weighting, cost_graph

from . import reference
from .accuracy import Results
from .backends import Workspace, backends
from .draws import AnyFunction, Samples, batch
from .expected import BOUND, Expected
from .report import Check
from .rounding import rounding

Array = NDArray[np.float64]
NAME = "Gauss-Newton"
UNIT = "relative to |J|^T |J|"


@dataclass(frozen=True, eq=False)
class Factor:
    """Arrays (samples, rows, columns) of residual and Jacobians, and bounds on their errors."""

    value: Mapping[str, Array]
    bound: Mapping[str, Array]  # (samples,)
    cost: Array
    allowed: Array  # of the cost


def normal_terms(function: AnyFunction, place: Workspace, drawn: Samples, expected: Expected) -> Check:
    """Compare every back end of the terms with each branch of the logarithms, and take the nearer one."""
    kernel = function.gauss_newton_kernel
    arguments = batch(drawn.inside)
    sides = _sides(function, drawn, expected)
    wanted = sides[0].value
    compared = np.all([b.kept for b in expected.blocks if b.name in wanted], axis=0)
    worst, where = 0.0, ""
    for backend in backends(kernel, place):
        found = backend.evaluate(arguments)
        ratio = np.min([_ratio(function.kernel, side, found) for side in sides], axis=0)
        ratio = np.where(compared, np.where(np.isfinite(ratio), ratio, np.inf), 0.0)
        if ratio.max(initial=0.0) > worst:
            worst, where = float(ratio.max()), f"{backend.name}, {drawn.inside[int(ratio.argmax())].case}"
    kept = int(compared.sum())
    return Check(NAME, worst <= 1.0 and 2 * kept >= len(compared), worst * BOUND, BOUND, UNIT, where, kept)


def _sides(function: AnyFunction, drawn: Samples, expected: Expected) -> list[Factor]:
    """The reference, once for each branch at a half turn; the cost is half of the squared norm or of rho."""
    residual, variables = _names(function.kernel)
    wanted = {residual, *(f"{residual}_D_{v}" for v in variables)}
    blocks = {b.name: b for b in expected.blocks if b.name in wanted}
    count, m = blocks[residual].expected.shape[1:]
    robust = function.weighting if function.weighting and function.weighting.loss else None
    costs = _robust_costs(function, robust, drawn) if robust else None
    found: list[Factor] = []
    for side in range(2):
        value = {name: b.expected[side].reshape(count, m, -1) for name, b in blocks.items()}
        bound = {name: b.bound[side] for name, b in blocks.items()}
        r = value[residual][..., 0]
        allowed = BOUND * (r * r).sum(axis=1) + bound[residual] * (
            np.abs(r).sum(axis=1) + m * bound[residual]
        )
        cost = 0.5 * (r * r).sum(axis=1)
        if costs:
            cost, allowed = costs[side]
        found.append(Factor(value, bound, cost, allowed))
    return found


def _robust_costs(
    function: AnyFunction, weighting: Weighting, drawn: Samples
) -> tuple[tuple[Array, Array], ...]:
    """The reference's cost on each branch, and how far off it may be."""
    graph = cost_graph(function.plain, weighting)
    moved = rounding(function.gauss_newton_kernel.value, batch(drawn.inside))["cost"]
    found: list[tuple[Array, Array]] = []
    for flip in (False, True):
        costs: list[Any] = [reference.outputs(graph, s.values, flip=flip)["cost"] for s in drawn.inside]
        cost = np.array([float(c[0]) for c in costs])
        found.append((cost, BOUND * np.maximum(1.0, np.abs(cost)) + moved))
    return tuple(found)


def _names(kernel: Kernel) -> tuple[str, list[str]]:
    (residual,) = kernel.outputs
    return residual.name, [v.name for v in kernel.variables]


def _ratio(kernel: Kernel, factor: Factor, found: Results) -> Array:
    """(samples,): the largest error of a term over what is allowed; NaN where a result is none."""
    residual, variables = _names(kernel)
    pairs = [(gradient_name(x), f"{residual}_D_{x}", residual) for x in variables]
    pairs += [
        (block_name(x, y), f"{residual}_D_{x}", f"{residual}_D_{y}")
        for x, y in combinations_with_replacement(variables, 2)
    ]
    cost = np.abs(found["cost"][:, 0] - factor.cost)
    ratios = [_over(cost, factor.allowed), *(_term(found[name], factor, a, b) for name, a, b in pairs)]
    return np.max(ratios, axis=0)


def _term(found: Array, factor: Factor, a: str, b: str) -> Array:
    """A^T B: as far off as the errors of A and B make it, and rounding of the sums."""
    A, B = factor.value[a], factor.value[b]
    with np.errstate(all="ignore"):
        exact = np.einsum("nij,nik->njk", A, B)
        size = np.einsum("nij,nik->njk", np.abs(A), np.abs(B)).max(axis=(1, 2))
        allowed = BOUND * size + factor.bound[a] * np.abs(B).sum(axis=1).max(axis=1)
        allowed += factor.bound[b] * np.abs(A).sum(axis=1).max(axis=1)
        return _over(np.abs(found.reshape(exact.shape) - exact).max(axis=(1, 2)), allowed)


def _over(error: Array, allowed: Array) -> Array:
    with np.errstate(all="ignore"):
        return np.where(error == 0, 0.0, error / allowed)
