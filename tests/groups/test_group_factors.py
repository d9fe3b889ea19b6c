"""Priors and between factors of the groups, written by a user: derived Jacobians against the reference."""

from typing import Any

import numpy as np
import pytest
from group_tools import BOUND, worst

from liegen import R3, SE23, SO3, factor, stack
from liegen.library.sampling import between, prior


def factors_of(G: Any) -> dict[str, Any]:
    @factor(sample=prior(G))
    def prior_of(x: G, *, z: G):
        return z.local(x)

    @factor(sample=between(G))
    def between_of(x: G, y: G, *, z: G):
        return z.local(x.between(y))

    @factor(sample=between(G))
    def all_operations(x: G, y: G, *, z: G):
        """The same value by inverse, compose, exp and log, with other rules."""
        return (z.inverse() @ G.exp((x.inverse() @ y).log())).log()

    @factor(sample=between(G))
    def interpolated(x: G, y: G, *, z: G):
        return z.local(x.retract(0.3 * x.local(y)))

    return {f.name: f for f in (prior_of, between_of, all_operations, interpolated)}


GROUPS = [SE23]


@pytest.mark.parametrize("G", GROUPS, ids=lambda G: G.__name__)
@pytest.mark.parametrize("name", ["prior_of", "between_of", "all_operations", "interpolated"])
def test_factors_against_the_reference(G: Any, name: str) -> None:
    errors = worst(factors_of(G)[name])
    assert max(error for error, _ in errors.values()) <= BOUND, errors


@factor
def extended_parts(x: SE23, y: SE23, *, lever: R3, z: SO3):
    """Everything that an extended pose offers: parts, constructor, its pose."""
    moved = SE23(x.rotation @ z, x.position + x.rotation @ lever, y.velocity)
    return stack(
        moved.local(y), x.pose.transform_to(y.position), y.velocity - x.velocity, z.local(x.rotation)
    )


def test_parts_and_constructor() -> None:
    errors = worst(extended_parts)
    assert max(error for error, _ in errors.values()) <= BOUND, errors
    x = SE23(SO3.exp([0.1, 0.2, 0.3]), [1, 2, 3], [4, 5, 6])
    np.testing.assert_array_equal(np.asarray(x.position), [1, 2, 3])
    np.testing.assert_array_equal(np.asarray(x.velocity), [4, 5, 6])
    np.testing.assert_array_equal(np.asarray(x.pose), np.asarray(x)[:7])
