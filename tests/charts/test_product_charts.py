"""Products in charts: every part is in the preset's chart of its own manifold."""

import numpy as np
import pytest
from scipy.linalg import block_diag

from liegen import R3, S2, SE2, SE3, DefinitionError, NavState, Product, factor, function
from liegen.charts import PRESETS
from liegen.library import prior_s2, prior_se2, prior_se3
from liegen.samples import Draw
from liegen.verify import verify


class Pair(Product):
    pose: SE3
    vel: R3
    flat: SE2


class Seen(Product):
    pose: SE3
    way: S2


@factor
def prior_pair(x: Pair, *, z: Pair):
    return z.local(x)


@factor
def prior_seen(x: Seen, *, z: Seen):
    return z.local(x)


@function
def moved(x: Pair, *, v: R3):
    return Pair(pose=x.pose, vel=x.vel + v, flat=x.flat)


def drawn(manifold, seed):
    return Draw(np.random.default_rng(seed)).element(manifold)


@pytest.mark.parametrize("name", PRESETS)
def test_residual_and_jacobian_are_those_of_the_parts(name):
    x, z = drawn(Pair, 1), drawn(Pair, 2)
    found = prior_pair.in_chart(name).jacobians(x, z=z)
    pose = prior_se3.in_chart(name).jacobians(x.pose, z=z.pose)
    flat = prior_se2.in_chart(name).jacobians(x.flat, z=z.flat)
    res = np.concatenate([pose["res"], np.asarray(x.vel) - np.asarray(z.vel), flat["res"]])
    np.testing.assert_allclose(found["res"], res, rtol=0, atol=1e-14)
    D = block_diag(pose["res_D_x"], np.eye(3), flat["res_D_x"])
    np.testing.assert_allclose(found["res_D_x"], D, rtol=0, atol=1e-13)


def test_a_part_without_charts_stays_as_it_is():
    x, z = drawn(Seen, 1), drawn(Seen, 2)
    found = prior_seen.in_chart("ceres").jacobians(x, z=z)
    pose = prior_se3.in_chart("ceres").jacobians(x.pose, z=z.pose)
    way = prior_s2.jacobians(x.way, z=z.way)
    D = block_diag(pose["res_D_x"], way["res_D_x"])
    np.testing.assert_allclose(found["res_D_x"], D, rtol=0, atol=1e-13)


def test_a_variable_that_is_a_product_has_a_chart_of_its_own():
    x, z = drawn(Pair, 1), drawn(Pair, 2)
    mixed = prior_pair.in_chart({"x": "ceres"}).jacobians(x, z=z)
    pose = prior_se3.in_chart({"x": "ceres"}).jacobians(x.pose, z=z.pose)
    np.testing.assert_allclose(mixed["res"], prior_pair.jacobians(x, z=z)["res"], rtol=0, atol=1e-14)
    np.testing.assert_allclose(mixed["res_D_x"][:6, :6], pose["res_D_x"], rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", ["ceres", "g2o"])
def test_an_output_on_a_product_has_rows_in_the_chart(name):
    """Rows and columns of a part that only passes are in one chart: the identity."""
    x = drawn(Pair, 1)
    D = moved.in_chart(name).jacobians(x, v=R3(1, 2, 3))["out_D_x"]
    np.testing.assert_allclose(D, np.eye(12), rtol=0, atol=1e-14)


def test_the_reference_agrees():
    report = verify([prior_pair.in_chart("sophus"), prior_seen.in_chart("ceres")], samples=10)
    assert report.passed, [c for f in report.factors for c in f.checks if not c.passed]


def test_a_part_that_has_no_such_chart_is_refused():
    class State(Product):
        nav: NavState
        bias: R3

    @factor
    def prior_state(x: State, *, z: State):
        return z.local(x)

    with pytest.raises(DefinitionError, match="NavState has no chart 'sophus'; the one that exists is"):
        _ = prior_state.in_chart("sophus").graph
