"""S2.local at the antipode: (pi, 0) and no Jacobian, whatever rounding leaves of x + y (conventions.md)."""

import numpy as np
import pytest

import liegen
from compiler_tools import needs_compiler
from liegen import S2, factor
from liegen.emit.precision import SINGLE
from liegen.verify.backends import backends, compiled_backends, workspace


@factor
def apart(x: S2, y: S2):
    return x.local(y)


def directions(count: int = 60) -> np.ndarray:
    """Random unit vectors, and those of the axes and diagonals, where doubles are exact."""
    rng = np.random.default_rng(11)
    drawn = rng.normal(size=(count, 3))
    v = np.vstack([drawn, np.eye(3), [[0.6, 0.8, 0.0], [0.48, 0.6, 0.64]], np.ones((1, 3))])
    return v / np.linalg.norm(v, axis=1)[:, None]


def opposite(x: np.ndarray, how: str) -> np.ndarray:
    """-x, with other last digits, or normalised once more."""
    y = -x
    if how == "other digits":
        y = y * (1 + np.random.default_rng(2).integers(-1, 2, size=y.shape) * 2.0**-53)
    if how == "normalised":
        y = y * 1.7
        y /= np.sqrt((y * y).sum(axis=1))[:, None]
    return y


def holds(results: dict[str, np.ndarray], eps: float) -> bool:
    right = np.allclose(results["res"], [np.pi, 0.0], atol=40 * eps)
    slopes = [a for name, a in results.items() if "_D_" in name]
    return right and not any(np.isfinite(a).all(axis=(1, 2)).any() for a in slopes)


@pytest.mark.parametrize("how", ["exact", "other digits", "normalised"])
def test_local_at_the_antipode_has_a_value_and_no_jacobian(how):
    x = directions()
    assert holds(apart.jacobians(x, opposite(x, how)), 2.0**-52)
    assert np.allclose(apart(x, opposite(x, how)), [np.pi, 0], atol=1e-14)


@needs_compiler
def test_all_generated_code_says_the_same():
    x = directions()
    with workspace([apart.kernel]) as place:
        for backend in backends(apart.kernel, place):
            for how in ("exact", "other digits"):
                assert holds(backend.evaluate({"x": x, "y": opposite(x, how)}), 2.0**-52), backend.name
        x = x.astype(np.float32).astype(float)
        for backend in compiled_backends(apart.kernel, place, SINGLE):
            assert holds(backend.evaluate({"x": x, "y": -x}), 2.0**-23), backend.name


@needs_compiler
def test_contraction_to_fma_says_the_same():
    x = directions()
    found = liegen.compile(apart).jacobians(x, -x)
    assert np.allclose(found.res, [np.pi, 0], atol=1e-14)
    assert not np.isfinite(found.res_D_x).all(axis=(1, 2)).any()
    assert not np.isfinite(found.res_D_y).all(axis=(1, 2)).any()


@pytest.mark.parametrize("away", [1e-13, 1e-9, 1e-6])
def test_beside_the_antipode_the_direction_is_that_of_the_numbers(away):
    """What a direction that is ``away`` from it, seen along b1 or b2, says: the angle and the direction."""
    x = S2.from_storage([0.0, 0.0, 1.0])
    for d in ([1.0, 0.0], [0.0, -1.0], [0.6, 0.8]):
        y = x.retract(np.array(d) * (np.pi - away))
        assert np.allclose(np.asarray(x.local(y)), np.array(d) * (np.pi - away), atol=1e-15 / away)


def test_equal_directions_are_no_antipode():
    x = directions()
    found = apart.jacobians(x, x)
    assert np.abs(found["res"]).max() < 1e-15
    assert np.allclose(found["res_D_y"], np.eye(2), atol=1e-14)
