"""`check-jacobian` in another chart than the default: Ceres', on matrices."""

import numpy as np
from scipy.spatial.transform import Rotation
from test_check_jacobian import SIGN, differences, matrix, right

from liegen import library
from liegen.foreign import compare
from liegen.foreign.calls import of_callable


def ceres_step(T, d):
    """Ceres' chart: q' = q(d) q with q(d) of half the rotation vector, t' = t + v."""
    moved = np.eye(4)
    moved[:3, :3], moved[:3, 3] = Rotation.from_rotvec(2 * d[:3]).as_matrix() @ T[:3, :3], T[:3, 3] + d[3:]
    return moved


def ceres_residual(X, Y, Z):
    C = np.linalg.inv(X) @ Y
    turn = Rotation.from_matrix(C[:3, :3] @ Z[:3, :3].T).as_rotvec() / 2
    return np.array([*turn, *(C[:3, 3] - Z[:3, 3])])


def in_ceres_chart(x, y, z):
    X, Y, Z = matrix(x), matrix(y), matrix(z)
    return (
        ceres_residual(X, Y, Z),
        differences(lambda d: ceres_residual(ceres_step(X, d), Y, Z)),
        differences(lambda d: ceres_residual(X, ceres_step(Y, d), Z)),
    )


def with_another_sign_by_y(x, y, z):
    res, by_x, by_y = in_ceres_chart(x, y, z)
    return res, by_x, -by_y


def test_a_factor_in_another_chart():
    charted = library.between_se3.in_chart("ceres")
    same = compare(charted, of_callable(in_ceres_chart, charted.kernel, "here"), samples=6)
    assert same.passed
    found = compare(charted, of_callable(with_another_sign_by_y, charted.kernel, "here"), samples=6)
    assert [f.differences for f in found.findings] == [(), (), (SIGN,)]
    assert not compare(charted, of_callable(right, charted.kernel, "here"), samples=6).passed
