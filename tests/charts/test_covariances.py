"""``from_chart`` and ``to_chart`` against differences of the presets' definitions on matrices."""

import numpy as np
import preset_definitions as definitions
import pytest

from liegen import R3, S2, SE2, SE3, SO2, SO3, Chart, uncertainty
from liegen.charts import PRESETS
from liegen.errors import DefinitionError, UncertaintyError

XI = {"SE3": [0.4, -0.7, 0.5, 1.5, -2.0, 0.7], "SO3": [0.4, -0.7, 0.5], "SE2": [1.5, -2.0, 0.8]}
GROUPS = {"SE3": SE3, "SO3": SO3, "SE2": SE2}
STEP = 1e-5


def covariance(n):
    L = np.random.default_rng(8).normal(size=(n, n))
    return L @ L.T + 0.1 * np.eye(n)


def coordinates(name, delta):
    """Log of a matrix near the identity, in liegen's order: sinh(log), the same up to the third order."""
    L = (delta - np.linalg.inv(delta)) / 2
    if name == "SE2":
        return np.array([L[0, 2], L[1, 2], L[1, 0]])
    turn = [L[2, 1], L[0, 2], L[1, 0]]
    return np.array([*turn, *L[:3, 3]]) if name == "SE3" else np.array(turn)


def column_map(name, preset):
    """d Log(x^-1 x.retract(d))/dd by central differences of the definition."""
    x = GROUPS[name].exp(XI[name])
    M, define = x.matrix(), getattr(definitions, name)[preset]
    n = 2 if name == "SE2" else 3
    at = (M,) if name == "SO3" else (M[:n, :n], M[:n, n])
    columns = []
    for e in np.eye(len(XI[name])) * STEP:
        # beside zero: a definition may divide by the length of the rotation
        ends = [coordinates(name, np.linalg.inv(M) @ define(*at, s * e + 1e-13)) for s in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2 * STEP))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("name", GROUPS)
def test_from_chart_is_the_map_of_the_definition(name, preset):
    x, S = GROUPS[name].exp(XI[name]), covariance(len(XI[name]))
    M = column_map(name, preset)
    expected = M @ S @ M.T
    bound = 1e-9 * np.abs(expected).max()  # of differences: STEP^2, and rounding over STEP
    np.testing.assert_allclose(uncertainty.from_chart(x, S, preset), expected, rtol=0, atol=bound)
    there = uncertainty.to_chart(x, S, preset)
    np.testing.assert_allclose(uncertainty.from_chart(x, there, preset), S, rtol=0, atol=1e-13)


def test_what_other_functions_say():
    x, S = SE3.exp(XI["SE3"]), covariance(6)
    close = {"rtol": 0, "atol": 1e-13}
    np.testing.assert_allclose(uncertainty.from_chart(x, S, "ros"), uncertainty.from_ros(x, S), **close)
    np.testing.assert_allclose(
        uncertainty.to_chart(x, S, "manif"), uncertainty.to_order(SE3, S, "translation-first"), **close
    )
    left = Chart(side="left")
    np.testing.assert_allclose(uncertainty.to_chart(x, S, left), uncertainty.body_to_world(x, S), **close)
    np.testing.assert_allclose(uncertainty.from_chart(x, S, "gtsam"), S, **close)


def test_batches_and_other_manifolds():
    xs = SE3.exp(np.random.default_rng(1).normal(size=(6,)))
    many = SE3.from_storage(np.stack([np.asarray(xs), np.asarray(SE3.identity())]))
    S = covariance(6)
    both = uncertainty.from_chart(many, S, "symforce")
    assert both.shape == (2, 6, 6)
    np.testing.assert_allclose(both[0], uncertainty.from_chart(xs, S, "symforce"), rtol=0, atol=1e-14)
    np.testing.assert_allclose(both[1], S, rtol=0, atol=1e-14)
    for one in (R3(1.0, 2.0, 3.0), S2.direction([1.0, 2.0, 3.0])):
        T = covariance(one.form.dim)
        np.testing.assert_array_equal(uncertainty.from_chart(one, T, "ros"), (T + T.T) / 2)
    np.testing.assert_allclose(uncertainty.to_chart(SO2.exp(0.3), [[4.0]], "ceres"), [[4.0]])


def test_mistakes():
    x, S = SE3.exp(XI["SE3"]), covariance(6)
    with pytest.raises(
        DefinitionError, match=r"test_covariances.py:\d+: unknown chart 'sofus'; one of gtsam"
    ):
        uncertainty.from_chart(x, S, "sofus")
    with pytest.raises(UncertaintyError, match=r"S must have the shape \(..., 6, 6\)"):
        uncertainty.to_chart(x, covariance(3), "ros")
    with pytest.raises(UncertaintyError, match="T must be an element of a manifold"):
        uncertainty.to_chart(np.eye(4), S, "ros")
