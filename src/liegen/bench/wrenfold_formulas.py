"""The published functions in wrenfold's language: storage vectors in, storage vectors out.

Rotations by ``geometry.Quaternion`` (scalar last in storage), small angles behind its conditionals with
the threshold of its examples. Euclidean arguments are vectors; scalars are vectors of one entry.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

EPSILON = 1e-16
#: Below this angle SE(2)'s logarithm takes two terms of its series [rad].
SMALL = 1e-4
V = Any  # a vector of wrenfold


def _sym() -> Any:
    return importlib.import_module("wrenfold.sym")


def _geometry() -> Any:
    return importlib.import_module("wrenfold.geometry")


def _quaternion(xyzw: V) -> Any:
    return _geometry().Quaternion.from_xyzw(xyzw)


def _turn(w: V) -> Any:
    return _geometry().Quaternion.from_rotation_vector(w, epsilon=EPSILON)


def _angles(q: Any) -> V:
    """Its faster logarithm."""
    return q.to_rotation_vector(epsilon=EPSILON, use_atan2=False)


def _between(x: V, y: V) -> tuple[Any, V]:
    """Rotation and translation of x^-1 y."""
    inverse = _quaternion(x[0:4]).conjugate()
    return inverse * _quaternion(y[0:4]), inverse.to_rotation_matrix() * (y[4:7] - x[4:7])


def _log_se3(z: V, rotation: Any, translation: V) -> V:
    """Log(z^-1 T) of a pose in two parts."""
    inverse = _quaternion(z[0:4]).conjugate()
    w = _angles(inverse * rotation)
    t = inverse.to_rotation_matrix() * (translation - z[4:7])
    return _sym().vstack([w, _geometry().inverse_left_jacobian_of_so3(w, epsilon=EPSILON) * t])


def between_se3(x: V, y: V, z: V) -> V:
    """z^-1 x^-1 y, then its logarithm."""
    return _log_se3(z, *_between(x, y))


def between_se3_whitened(x: V, y: V, z: V, sqrt_info: V) -> V:
    """S r with an upper triangular S."""
    sym = _sym()
    rows = [[sqrt_info[6 * i + j] if j >= i else 0 for j in range(6)] for i in range(6)]
    return sym.matrix(rows) * between_se3(x, y, z)


def prior_se3(x: V, z: V) -> V:
    """Log(z^-1 x)."""
    return _log_se3(z, _quaternion(x[0:4]), x[4:7])


def between_so3(x: V, y: V, z: V) -> V:
    """Log(z^-1 x^-1 y)."""
    return _angles(_quaternion(z).conjugate() * (_quaternion(x).conjugate() * _quaternion(y)))


def between_so3xr3(x: V, y: V, z: V) -> V:
    """Rotation and position apart."""
    rotation, position = _between(x, y)
    return _sym().vstack([_angles(_quaternion(z[0:4]).conjugate() * rotation), position - z[4:7]])


def _unturn(c: Any, s: Any, v: V) -> V:
    return _sym().vector(c * v[0] + s * v[1], c * v[1] - s * v[0])


def between_se2(x: V, y: V, z: V) -> V:
    """Complex numbers, and V^-1 of the half angle."""
    sym = _sym()
    rotation = _unturn(z[0], z[1], _unturn(x[0], x[1], y[0:2]))
    t = _unturn(z[0], z[1], _unturn(x[0], x[1], y[2:4] - x[2:4]) - z[2:4])
    angle = sym.atan2(rotation[1], rotation[0])
    half = angle / 2
    away = half * (1 + rotation[0]) / rotation[1]
    cot = sym.where(sym.abs(angle) > SMALL, away, 1 - angle * angle / 12)
    return sym.vector(cot * t[0] + half * t[1], cot * t[1] - half * t[0], angle)


def reprojection_bal(x: V, K: V, p: V) -> V:
    """Snavely's camera."""
    q = _quaternion(x[0:4]).to_rotation_matrix() * p + x[4:7]
    u, v = -q[0] / q[2], -q[1] / q[2]
    r2 = u * u + v * v
    scale = K[0] * (1 + r2 * (K[1] + K[2] * r2))
    return _sym().vector(scale * u, scale * v)


def bearing_range_se2_r2(x: V, p: V, z: V) -> V:
    """Angle and distance."""
    sym = _sym()
    away = p - x[2:4]
    q = _unturn(x[0], x[1], away)
    return sym.vector(sym.atan2(q[1], q[0]) - z[0], sym.sqrt(away[0] * away[0] + away[1] * away[1]) - z[1])


def quaternion_local(q0: V, q1: V) -> V:
    """Log(q0^-1 q1)."""
    return _angles(_quaternion(q0).conjugate() * _quaternion(q1))


def quaternion_interpolation(q0: V, q1: V, a: V) -> V:
    """q0 Exp(a Log(q0^-1 q1))."""
    return (_quaternion(q0) * _turn(quaternion_local(q0, q1) * a[0])).to_vector_xyzw()


def imu_step(x: V, u: V, b: V, dt: V) -> V:
    """One step of integration."""
    sym = _sym()
    rotation = _quaternion(x[0:4])
    a = rotation.to_rotation_matrix() * (u[3:6] - b[3:6])
    p = x[4:7] + x[7:10] * dt[0] + a * (sym.abs(dt[0]) * dt[0] / 2)
    turned = rotation * _turn((u[0:3] - b[0:3]) * dt[0])
    return sym.vstack([turned.to_vector_xyzw(), p, x[7:10] + a * dt[0]])


def rolling_shutter(R: V, p: V, C: V, c: V, w: V, v: V, P: V, t: V, K: V, D: V) -> V:
    """Pose at the row's time, then the camera of OpenCV with three radial terms."""
    body = _quaternion(R) * _turn(w * t[0])
    position = p + v * t[0] + body.to_rotation_matrix() * c
    q = (body * _quaternion(C)).conjugate().to_rotation_matrix() * (P - position)
    m, n = q[0] / q[2], q[1] / q[2]
    r2 = m * m + n * n
    radial = 1 + r2 * (D[0] + r2 * (D[1] + r2 * D[2]))
    md = radial * m + 2 * D[3] * m * n + D[4] * (r2 + 2 * m * m)
    nd = radial * n + 2 * D[3] * (r2 + 2 * n * n) + D[4] * m * n
    return _sym().vector(K[0] * md + K[2], K[1] * nd + K[3])


FORMULAS: Mapping[str, Callable[..., V]] = {
    f.__name__: f
    for f in (
        between_se3, between_se3_whitened, between_so3, between_se2, between_so3xr3, prior_se3,
        reprojection_bal, bearing_range_se2_r2, quaternion_local, quaternion_interpolation,
        imu_step, rolling_shutter,
    )
}  # fmt: skip
