"""Shared by the tests of the groups: factors held against the mpmath reference, kernel, NumPy and C alike."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from liegen.samples import CASES, Case, Draw, default_sampler, negated
from liegen.verify import reference

#: Relative to max(1, s), s the largest absolute entry of the reference block.
BOUND = 2e-14
NEAR = [case for case in CASES if case.spread <= 1.0]


def samples(function: Any, cases: list[Case] = NEAR, seed: int = 0) -> Iterator[tuple[Case, dict[str, Any]]]:
    """Stored numbers of every argument, one sample for each case."""
    manifolds = {p.name: p.manifold for p in function.graph.parameters}
    sampler = function.sampler or default_sampler(manifolds)
    for k, case in enumerate(cases):
        draw = Draw(np.random.default_rng([seed, k]))
        values = negated(sampler(draw, case), draw, always=case.negate)
        yield case, {name: np.asarray(v) for name, v in values.items()}


def expected(function: Any, sample: dict[str, Any], *, flip: bool = False) -> dict[str, Any]:
    """Residual and Jacobians of the reference, as floats."""
    results = reference.outputs(function.graph, sample, flip=flip)
    arrays: dict[str, Any] = {
        name: np.array(reference.to_coords(node.manifold, results[name]), float)
        for name, node in function.graph.outputs
    }
    for (output, variable), rows in reference.jacobians(function.graph, sample, flip=flip).items():
        arrays[f"{output}_D_{variable}"] = np.array([[float(x) for x in row] for row in rows])
    return arrays


def worst(function: Any, cases: list[Case] = NEAR, seed: int = 0) -> dict[str, tuple[float, str]]:
    """By output: the largest error over the cases relative to max(1, s), and the case it is at.

    At half a turn the nearer of both logarithms counts.
    """
    found: dict[str, tuple[float, str]] = {}
    for case, sample in samples(function, cases, seed):
        ours = function.jacobians(**sample)
        errors = _errors(ours, expected(function, sample))
        if errors["res"] > BOUND:  # the other logarithm, which exists within 1e-6 of half a turn only
            errors = _errors(ours, expected(function, sample, flip=True))
        for name, error in errors.items():
            found[name] = max(found.get(name, (0.0, "")), (error, case.name))
    return found


def _errors(ours: dict[str, Any], exact: dict[str, Any]) -> dict[str, float]:
    assert ours.keys() == exact.keys()
    return {
        name: float(np.max(np.abs(ours[name] - x)) / max(1.0, np.max(np.abs(x)))) for name, x in exact.items()
    }
