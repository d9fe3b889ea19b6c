"""What the tests of group modules share: groups as matrices in NumPy, written without liegen's forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

NAMES = ("SO2", "SE2", "SO3", "SE3", "SE23", "Gal3", "Sim2", "Sim3")
GENERATE = f"liegen generate {' '.join(f'--group {name}' for name in NAMES)} -o DIR"


def skew(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def pose(turn, t):
    n = len(t)
    m = np.zeros((n + 1, n + 1))
    m[:n, :n], m[:n, n] = turn, t
    return m


def quaternion_matrix(q):
    """R = I + 2 w [v]x + 2 [v]x^2 (Rodrigues)."""
    v = skew(q[:3])
    return np.eye(3) + 2 * q[3] * v + 2 * v @ v


def plane_matrix(c):
    return np.array([[c[0], -c[1]], [c[1], c[0]]])


def with_one(m):
    m[-1, -1] = 1.0
    return m


@dataclass(frozen=True)
class MatrixGroup:
    """Storage to matrix, tangent to Lie algebra, and back."""

    dim: int
    element: Callable
    hat: Callable
    vee: Callable


def similarity(turn, t, lam):
    """The rotation's part, and lam on its diagonal."""
    return pose(turn + lam * np.eye(len(t)), t)


PLANE = np.array([[0.0, -1.0], [1.0, 0.0]])
MATRIX_GROUPS: Mapping[str, MatrixGroup] = {
    "SO2": MatrixGroup(1, plane_matrix, lambda d: d[0] * PLANE, lambda m: np.array([m[1, 0]])),
    "SO3": MatrixGroup(3, quaternion_matrix, skew, lambda m: np.array([m[2, 1], m[0, 2], m[1, 0]])),
    "SE2": MatrixGroup(
        3,
        lambda c: with_one(pose(plane_matrix(c[:2]), c[2:])),
        lambda d: pose(d[2] * PLANE, d[:2]),
        lambda m: np.array([m[0, 2], m[1, 2], m[1, 0]]),
    ),
    "SE3": MatrixGroup(
        6,
        lambda c: with_one(pose(quaternion_matrix(c[:4]), c[4:])),
        lambda d: pose(skew(d[:3]), d[3:]),
        lambda m: np.array([m[2, 1], m[0, 2], m[1, 0], *m[:3, 3]]),
    ),
    "Sim2": MatrixGroup(
        4,
        lambda c: with_one(pose(c[4] * plane_matrix(c[:2]), c[2:4])),
        lambda d: similarity(d[2] * PLANE, d[:2], d[3]),
        lambda m: np.array([m[0, 2], m[1, 2], m[1, 0], m[0, 0]]),
    ),
    "Sim3": MatrixGroup(
        7,
        lambda c: with_one(pose(c[7] * quaternion_matrix(c[:4]), c[4:7])),
        lambda d: similarity(skew(d[:3]), d[3:6], d[6]),
        lambda m: np.array([m[2, 1], m[0, 2], m[1, 0], *m[:3, 3], m[0, 0]]),
    ),
}


def linear(group: MatrixGroup, map_of_algebra: Callable) -> np.ndarray:
    """The matrix, in tangent coordinates, of a linear map of the Lie algebra."""
    return np.column_stack([group.vee(map_of_algebra(group.hat(e))) for e in np.eye(group.dim)])
