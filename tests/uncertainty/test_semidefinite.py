"""What is known exactly: covariances with directions of variance 0 are moved and sampled, not inverted."""

import numpy as np
import pytest
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from liegen import R3, SE2, SE3, SO3, Sim2, Sim3, uncertainty
from liegen.errors import UncertaintyError

rng = np.random.default_rng
#: x, y and yaw of a robot in the plane, as ROS orders them: z, roll and pitch are exactly 0.
PLANAR = np.zeros((6, 6))
PLANAR[np.ix_([0, 1, 5], [0, 1, 5])] = [[0.04, 0.01, 0.002], [0.01, 0.09, -0.001], [0.002, -0.001, 0.01]]
T = SE3.exp([0.6, -0.9, 1.1, 4.0, -3.0, 2.0])


def _ad(pose):
    """Ad of a matrix of SE3, rotation first, from its definition."""
    R, t = pose[:3, :3], pose[:3, 3]
    K = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    return np.block([[R, np.zeros((3, 3))], [K @ R, R]])


def test_a_planar_robots_message():
    R = T.matrix()[:3, :3]
    M = np.block([[np.zeros((3, 3)), R.T], [R.T, np.zeros((3, 3))]])
    S = uncertainty.from_ros(T, PLANAR)
    np.testing.assert_allclose(S, M @ PLANAR @ M.T, atol=1e-16)
    np.testing.assert_allclose(uncertainty.to_ros(T, S), PLANAR, atol=1e-16)  # whose zeros are now rounding
    flat = SE3.exp([0, 0, 1.1, 4.0, -3.0, 0])
    assert np.linalg.matrix_rank(uncertainty.from_ros(flat, PLANAR)) == 3


def test_own_result_is_moved():
    twists = np.tile([0, 0, 0.1, 1.0, 0, 0], (3, 1))
    track = uncertainty.dead_reckoning(SE3.identity(), twists, 0.1, noise=np.eye(6) * 1e-4)
    Ad = np.array([_ad(pose) for pose in track.poses.matrix()])
    right = Ad @ track.covariances @ np.swapaxes(Ad, -1, -2)
    np.testing.assert_allclose(uncertainty.of_inverse(track.poses, track.covariances), right, atol=1e-16)
    assert not right[0].any()


def test_again_and_again():
    """Ten moves there and back, far away: the zeros become rounding, which is still a covariance."""
    far = SE3.exp([0.3, 0.5, -2.0, 900.0, -20.0, 3.0])
    S = uncertainty.from_ros(far, PLANAR)
    for _ in range(10):
        S = uncertainty.of_inverse(far.inverse(), uncertainty.of_inverse(far, S))
    both = uncertainty.of_compose(far, S, np.zeros((6, 6)))
    Ad = _ad(np.linalg.inv(far.matrix()))
    np.testing.assert_allclose(both, Ad @ S @ Ad.T, atol=1e-9 * np.abs(both).max())


@pytest.mark.parametrize("seed", range(5))
def test_any_rank_in_any_units(seed):
    """B B^T with fewer columns than rows, its rows in units from 1e-9 to 1e6: moved by each function."""
    r = rng(seed)
    units = 10.0 ** r.uniform(-9, 6, (6, 1))
    for rank in range(6):
        B = units * r.normal(size=(6, rank))
        S = B @ B.T
        np.testing.assert_allclose(uncertainty.propagate(np.eye(6), S), S)
        uncertainty.of_inverse(T, uncertainty.from_order(SE3, S, "translation-first"))
        uncertainty.to_chart(T, S, "symforce")
        twice = np.vstack([B, B])
        uncertainty.of_between(T, twice @ twice.T)
        with pytest.raises(UncertaintyError, match="not positive definite"):
            uncertainty.sqrt_info(S)


@pytest.mark.parametrize(
    ("S", "message"),
    [
        (np.diag([1.0, -1e-3]), "variance 1 .* is -0.001; what is known exactly"),
        (np.diag([1e6, 1e-12, -1e-6]), "variance 2"),
        ([[0.0, 1e-3], [1e-3, 1.0]], "variance 0 .* is 0; what is known exactly has 0 in its whole row"),
        ([[1e-20, 2e-10], [2e-10, 1.0]], "eigenvalue 0 of 2"),  # a correlation of 2, in units that differ
        ([[1e6, 0, 0], [0, 1e-12, 5e-12], [0, 5e-12, 1e-12]], "eigenvalue 0 of 3"),
        ([[1.0, 1.001], [1.001, 1.0]], "eigenvalue 0 of 2"),
        ([[0.0, 0.0], [1e-3, 1.0]], "variance 0|not symmetric"),
        (1e-30 * np.array([[1.0, 2], [2, 1]]), "eigenvalue 0 of 2"),
        ([[1e-12, 3e-13], [-3e-13, 1e-12]], "not symmetric"),
    ],
)
def test_what_is_no_covariance_is_refused_in_any_units(S, message):
    with pytest.raises(UncertaintyError, match=message):
        uncertainty.propagate(np.eye(len(S)), S)


def test_one_of_a_batch():
    S = np.stack([np.eye(3), np.zeros((3, 3)), np.diag([1.0, -1, 1])])
    with pytest.raises(UncertaintyError, match=r"S\[2\] is not positive semidefinite"):
        uncertainty.body_to_world(SO3.identity(), S)
    assert np.array_equal(uncertainty.body_to_world(SO3.identity(), S[:2]), S[:2])


@pytest.mark.parametrize("call", [uncertainty.sqrt_info, lambda S: uncertainty.whiten(np.ones(3), S)])
def test_an_inverse_is_asked_for(call):
    with pytest.raises(UncertaintyError, match=r"not positive definite: variance 0 .* small variance"):
        call(np.diag([0.0, 1, 1]))


def test_sampled_where_it_is_free():
    B = np.array([[1e-3, 2e-3], [5.0, 1.0], [0.0, 0.0]])
    drawn = np.asarray(uncertainty.sample(R3([1.0, 2, 3]), B @ B.T, rng(1), 20_000)) - [1.0, 2, 3]
    np.testing.assert_allclose(np.cov(drawn.T)[:2, :2] / (B @ B.T)[:2, :2], 1.0, atol=0.05)
    assert not drawn[:, 2].any()
    rank = B[:2] @ B[:2].T - np.outer(B[:2, 0], B[:2, 0])  # of one direction
    drawn = np.asarray(uncertainty.sample(R3([1.0, 2, 3]), np.pad(rank, (0, 1)), rng(1), 50)) - [1.0, 2, 3]
    np.testing.assert_allclose(drawn[:, 1] / drawn[:, 0], 500.0, rtol=1e-6)


def test_spread_of_each_step():
    """Noise of each step: S after k steps of the plane's x axis is the sum of the variances so far."""
    noise = np.array([np.diag([v, 0, 0]) for v in (1.0, 4.0, 9.0)])
    track = uncertainty.dead_reckoning(SE2.identity(), np.tile([1.0, 0, 0], (3, 1)), [1, 2, 1], noise=noise)
    np.testing.assert_allclose(track.covariances[:, 0, 0], [0, 1, 17, 26])


SIM = {
    Sim3: ([3, 4, 5, 0, 1, 2, 6], [0, 1, 2, 3, 4, 5, 6]),
    Sim2: ([0, 1, 2, 3], [2, 0, 1, 3]),
}


@pytest.mark.parametrize("G", SIM)
def test_orders_of_similarities(G):
    """Translation, rotation, logarithm of the scale, as Sophus has them; and rotation first."""
    n, z = G.form.dim, G.identity()
    S = np.diag(np.arange(1.0, n + 1)) + 0.01 * (np.ones((n, n)) - np.eye(n))
    S[0, 1] = S[1, 0] = 0.3
    for order, p in zip(("translation-first", "rotation-first"), SIM[G], strict=True):
        np.testing.assert_array_equal(uncertainty.to_order(G, S, order), S[np.ix_(p, p)])
        np.testing.assert_array_equal(uncertainty.from_order(G, uncertainty.to_order(G, S, order), order), S)
    p = SIM[G][0]
    np.testing.assert_array_equal(uncertainty.to_chart(z, S, "sophus"), S[np.ix_(p, p)])
    np.testing.assert_array_equal(uncertainty.from_chart(z, S[np.ix_(p, p)], "sophus"), S)


def test_sophus_of_a_similarity_by_its_matrices():
    """d of x Exp(d) with SciPy's exponential of hat((translation, rotation, log of the scale))."""
    d = 1e-3 * np.array([1.0, -2, 3, 2, 1, -1, 2])
    hat = np.zeros((4, 4))
    hat[:3, :3] = logm(Rotation.from_rotvec(d[3:6]).as_matrix()) + d[6] * np.eye(3)
    hat[:3, 3] = d[:3]
    x = Sim3.exp([0.1, 0.2, -0.3, 1, 2, 3, 0.5])
    moved = expm(hat)
    scale = np.cbrt(np.linalg.det(moved[:3, :3]))
    stored = [*Rotation.from_matrix(moved[:3, :3] / scale).as_quat(), *moved[:3, 3], scale]
    n = np.asarray(x.local(x @ Sim3.from_storage(stored)))
    S = np.outer(d, d)
    np.testing.assert_allclose(uncertainty.from_chart(x, S, "sophus"), np.outer(n, n), atol=1e-12)
    np.testing.assert_allclose(uncertainty.to_chart(x, np.outer(n, n), "sophus"), S, atol=1e-12)
