"""Covariances of ROS messages against the definition that `from_ros` states."""

import itertools

import mpmath
import numpy as np
import uncertainty_reference as ref
from scipy.spatial.transform import Rotation
from uncertainty_reference import bound, close, draw, misfit, spd

from liegen import uncertainty
from liegen.manifolds import SE3, SO3

N = 20_000


def test_ros_covariance_against_its_definition():
    """p + dp, turns about the fixed axes X, Y, Z: samples against from_ros; the body's axes miss by far."""
    T = SE3.exp([0.6, -0.9, 1.1, 4.0, -3.0, 2.0])
    M, S = T.matrix(), spd(6, np.random.default_rng(ref.SEED), [0.3, 0.1, 0.2, 0.01, 0.02, 0.03])
    e = draw(S, np.random.default_rng(ref.SEED), N)
    true = np.tile(np.eye(4), (N, 1, 1))
    true[:, :3, 3] = M[:3, 3] + e[:, :3]
    true[:, :3, :3] = Rotation.from_euler("xyz", e[:, 3:]).as_matrix() @ M[:3, :3]  # lower case: fixed axes
    body = ref.log(SE3, np.linalg.inv(M) @ true)
    assert misfit(body, uncertainty.from_ros(T, S)) < bound(N)
    assert misfit(body, uncertainty.from_order(SE3, S, "translation-first")) > 20 * bound(N)
    assert misfit(body, uncertainty.world_to_body(T, uncertainty.from_order(SE3, S, "translation-first"))) > (
        20 * bound(N)
    )
    close(uncertainty.to_ros(T, uncertainty.from_ros(T, S)), S, 1e-15)


def test_ros_map_against_differences():
    """d n/d(dp, dtheta) of Log(T^-1 (Exp(dtheta) R, p + dp)) in forty digits."""
    xi = [0.6, -0.9, 1.1, 4.0, -3.0, 2.0]
    T = SE3.exp(xi)
    with mpmath.workdps(40):
        M = ref.mp_exp(SE3, xi)

        def body(d):
            turned = ref.mp_exp(SO3, d[3:]) * M[:3, :3]
            true = mpmath.eye(4)
            true[:3, :3] = turned
            for k in range(3):
                true[k, 3] = M[k, 3] + d[k]
            return ref.mp_log(SE3, mpmath.inverse(M) * true)

        J = ref.slopes(body, 6)
    for k, j in itertools.combinations(range(6), 2):
        v = np.eye(6) + 0.5 * (np.outer(np.eye(6)[k], np.eye(6)[j]) + np.outer(np.eye(6)[j], np.eye(6)[k]))
        close(uncertainty.from_ros(T, v), J @ v @ J.T, 1e-14)
