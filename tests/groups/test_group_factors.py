"""Priors and between factors of the groups, written by a user: derived Jacobians against the reference."""

from typing import Any

import numpy as np
import pytest
from group_tools import BOUND, worst

from liegen import R2, R3, SE23, SO2, SO3, DefinitionError, Gal3, NavState, Sim2, Sim3, factor, stack
from liegen.library.sampling import between, prior
from liegen.verify import verify


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


GROUPS = [SE23, NavState, Gal3, Sim2, Sim3]


@pytest.mark.parametrize("G", GROUPS, ids=lambda G: G.__name__)
@pytest.mark.parametrize("name", ["prior_of", "between_of", "all_operations", "interpolated"])
def test_factors_against_the_reference(G: Any, name: str) -> None:
    errors = worst(factors_of(G)[name])
    assert max(error for error, _ in errors.values()) <= BOUND, errors


@pytest.mark.parametrize("G", GROUPS, ids=lambda G: G.__name__)
def test_every_check_of_verify_passes(G: Any) -> None:
    """C and NumPy against the reference too, differences, remainders, kilometres."""
    report = verify([factors_of(G)["between_of"], PARTS[G]], samples=12, seed=1, workers=1)
    failed = [(f.factor, c.name, c.worst, c.where) for f in report.factors for c in f.checks if not c.passed]
    assert not failed


@factor
def extended_parts(x: SE23, y: SE23, *, lever: R3, z: SO3):
    """Everything that an extended pose offers: parts, constructor, its pose."""
    moved = SE23(x.rotation @ z, x.position + x.rotation @ lever, y.velocity)
    seen = x.pose.transform_to(y.position)
    return stack(moved.local(y), seen, y.velocity - x.velocity, z.local(x.rotation))


@factor
def nav_parts(x: NavState, y: NavState, *, lever: R3, z: SO3):
    """The same with the other chart."""
    moved = NavState(x.rotation @ z, x.position + x.rotation @ lever, y.velocity)
    seen = x.pose.transform_to(y.position)
    return stack(moved.local(y), seen, y.velocity - x.velocity, z.local(x.rotation))


@factor
def galilean_parts(x: Gal3, y: Gal3, lever: R3, *, z: SO3):
    """Parts of an event move with its time."""
    moved = Gal3(x.rotation @ z, x.position + lever, y.velocity, 0.5 * x.time + lever[0])
    seen = x.pose.transform_to(y.position)
    return stack(moved.local(y), seen, y.velocity - x.velocity, z.local(x.rotation), y.time - x.time)


def test_galilean_parts() -> None:
    errors = worst(galilean_parts)
    assert max(error for error, _ in errors.values()) <= BOUND, errors
    x = Gal3(SO3.exp([0.1, 0.2, 0.3]), [1, 2, 3], [4, 5, 6], 7.0)
    assert float(x.time) == 7.0
    np.testing.assert_array_equal(np.asarray(x.velocity), [4, 5, 6])
    np.testing.assert_array_equal(np.asarray(x.pose), np.asarray(x)[:7])


def test_extended_poses_are_the_galilean_ones_without_time() -> None:
    d = np.linspace(-1.3, 0.9, 9)
    x, y = Gal3.exp([*d, 0.0]), SE23.exp(d)
    np.testing.assert_allclose(np.asarray(x)[:10], np.asarray(y), rtol=0, atol=1e-15)
    np.testing.assert_allclose(Gal3.Jr([*d, 0.0])[:9, :9], SE23.Jr(d), rtol=0, atol=1e-15)
    np.testing.assert_allclose(Gal3.Jr_inv([*d, 0.0])[:9, :9], SE23.Jr_inv(d), rtol=0, atol=1e-15)


def test_free_motion_is_a_one_parameter_group() -> None:
    """Without rotation the velocity grows with the time, which gives p = nu iota / 2."""
    x = Gal3.exp([0, 0, 0, 0, 0, 0, 3.0, 0, 0, 2.0])
    np.testing.assert_allclose(np.asarray(x), [0, 0, 0, 1, 3, 0, 0, 3, 0, 0, 2], atol=1e-15)


@pytest.mark.parametrize("function", [extended_parts, nav_parts], ids=lambda f: f.name)
def test_parts_and_constructor(function: Any) -> None:
    errors = worst(function)
    assert max(error for error, _ in errors.values()) <= BOUND, errors


@pytest.mark.parametrize("G", [SE23, NavState], ids=lambda G: G.__name__)
def test_parts_are_slices_of_the_storage(G: Any) -> None:
    x = G(SO3.exp([0.1, 0.2, 0.3]), [1, 2, 3], [4, 5, 6])
    np.testing.assert_array_equal(np.asarray(x.position), [1, 2, 3])
    np.testing.assert_array_equal(np.asarray(x.velocity), [4, 5, 6])
    np.testing.assert_array_equal(np.asarray(x.pose), np.asarray(x)[:7])
    np.testing.assert_array_equal(np.asarray(x.rotation), np.asarray(x)[:4])
    with pytest.raises(DefinitionError, match="needs an SO3, got SE3"):
        G(x.pose, [1, 2, 3], [4, 5, 6])


def test_the_charts_differ_beyond_first_order() -> None:
    """A mistaken chart would not pass as the other one."""
    d = np.linspace(0.1, 0.9, 9)
    x = SE23.identity().retract(d)
    y = NavState.identity().retract(d)
    np.testing.assert_array_equal(np.asarray(y)[4:], d[3:])
    assert np.max(np.abs(np.asarray(x) - np.asarray(y))) > 0.05
    np.testing.assert_array_equal(np.asarray(SE23.exp(d)), np.asarray(NavState.exp(d)))


@factor
def similar_in_space(x: Sim3, y: Sim3, p: R3, *, z: SO3):
    """Everything that the class offers: parts, constructor, actions."""
    moved = Sim3(z @ x.rotation, y.translation + x @ p, x.scale * y.scale)
    return stack(moved.local(y), y.transform_to(p), x.scale, z.local(x.rotation))


@factor
def similar_in_the_plane(x: Sim2, y: Sim2, p: R2, *, z: SO2):
    moved = Sim2(z @ x.rotation, y.translation + x @ p, x.scale * y.scale)
    return stack(moved.local(y), y.transform_to(p), x.scale, z.local(x.rotation))


@pytest.mark.parametrize("function", [similar_in_space, similar_in_the_plane], ids=lambda f: f.name)
def test_parts_and_constructor_of_similarities(function: Any) -> None:
    errors = worst(function)
    assert max(error for error, _ in errors.values()) <= BOUND, errors


@pytest.mark.parametrize(("G", "Q"), [(Sim2, SO2), (Sim3, SO3)])
def test_similarities_scale_then_move(G: Any, Q: Any) -> None:
    n = G.form.space
    x = G(Q.identity(), np.arange(n) + 1.0, 2.0)
    np.testing.assert_array_equal(np.asarray(x @ np.ones(n)), np.arange(n) + 3.0)
    np.testing.assert_array_equal(np.asarray(x.translation), np.arange(n) + 1.0)
    assert float(x.scale) == 2.0
    assert float(G(Q.identity(), np.zeros(n)).scale) == 1.0
    np.testing.assert_allclose(np.asarray(x.inverse() @ (x @ np.ones(n))), np.ones(n), rtol=1e-15)
    with pytest.raises(DefinitionError, match=f"needs an? {Q.__name__}, got {G.__name__}"):
        G(x, np.zeros(n), 1.0)


@pytest.mark.parametrize("G", [Sim2, Sim3], ids=lambda G: G.__name__)
def test_a_scale_that_is_not_positive_has_no_logarithm(G: Any) -> None:
    coords = np.asarray(G.identity()).copy()
    coords[-1] = -1.0
    with np.errstate(invalid="ignore"):
        assert np.isnan(np.asarray(G.from_storage(coords).log())[-1])


#: A factor with everything that the class offers.
PARTS = {
    SE23: extended_parts,
    NavState: nav_parts,
    Gal3: galilean_parts,
    Sim2: similar_in_the_plane,
    Sim3: similar_in_space,
}
