"""The presets as their libraries write them, on matrices, with SciPy's rotations: no code of liegen."""

import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation


def turn(v):
    return Rotation.from_rotvec(v).as_matrix()


def plane(a):
    return np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])


def skew(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def pose(R, t):
    n = len(t)
    T = np.eye(n + 1)
    T[:n, :n], T[:n, n] = R, t
    return T


def twist(W, v):
    n = len(v)
    A = np.zeros((n + 1, n + 1))
    A[:n, :n], A[:n, n] = W, v
    return expm(A)


def quarter(a):
    return np.array([[0, -a], [a, 0]])


def _ceres_turn(d):
    """QuaternionManifold::Plus: q_delta = (cos|d|, sin|d| d/|d|), w first; q' = q_delta q."""
    n = np.linalg.norm(d)
    return Rotation.from_quat([*(np.sin(n) * np.asarray(d) / n), np.cos(n)]).as_matrix()


def _mqt(d):
    """g2o's fromVectorMQT: w = sqrt(1 - |q|^2)."""
    return Rotation.from_quat([*d, np.sqrt(1 - np.dot(d, d))]).as_matrix()


#: (R, t, d) -> (R', t') as a matrix, d in the library's order.
SE3 = {
    "gtsam": lambda R, t, d: pose(R, t) @ twist(skew(d[:3]), d[3:]),
    "gtsam-4.2": lambda R, t, d: pose(R, t) @ twist(skew(d[:3]), d[3:]),
    "symforce": lambda R, t, d: pose(R @ turn(d[:3]), t + d[3:]),
    "sophus": lambda R, t, d: pose(R, t) @ twist(skew(d[3:]), d[:3]),
    "manif": lambda R, t, d: pose(R, t) @ twist(skew(d[3:]), d[:3]),
    "ceres": lambda R, t, d: pose(_ceres_turn(d[:3]) @ R, t + d[3:]),
    "g2o": lambda R, t, d: pose(R, t) @ pose(_mqt(d[3:]), d[:3]),
    "ros": lambda R, t, d: pose(turn(d[3:]) @ R, t + d[:3]),
}
SO3 = {
    **dict.fromkeys(("gtsam", "gtsam-4.2", "symforce", "sophus", "manif"), lambda R, d: R @ turn(d)),
    "ceres": lambda R, d: _ceres_turn(d) @ R,
    "g2o": lambda R, d: R @ _mqt(d),
    "ros": lambda R, d: turn(d) @ R,
}
SE2 = {
    **dict.fromkeys(("gtsam", "sophus", "manif"), lambda R, t, d: pose(R, t) @ twist(quarter(d[2]), d[:2])),
    "gtsam-4.2": lambda R, t, d: pose(R, t) @ pose(plane(d[2]), d[:2]),
    "symforce": lambda R, t, d: pose(R @ plane(d[0]), t + d[1:]),
    **dict.fromkeys(("ceres", "g2o", "ros"), lambda R, t, d: pose(R @ plane(d[2]), t + d[:2])),
}
