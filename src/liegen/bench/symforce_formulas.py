"""The published functions in SymForce's language, on its own geometry.

An argument comes as an element of SymForce (``Rot3``, ``Pose3_SE3``, ``Pose2_SE2``, a vector), a product as
the list of its parts; results are lists of elements. Its epsilon is set at code generation, as it documents.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

E = Any  # an element of SymForce


def _sf() -> Any:
    return importlib.import_module("symforce.symbolic")


def between_se3(x: E, y: E, z: E) -> Sequence[E]:
    """Its exact SE(3)."""
    return [_sf().V6(z.local_coordinates(x.between(y)))]


def between_so3(x: E, y: E, z: E) -> Sequence[E]:
    """Its rotations."""
    return [_sf().V3(z.local_coordinates(x.between(y)))]


def between_se2(x: E, y: E, z: E) -> Sequence[E]:
    """Its exact SE(2); the angle comes first in its tangent."""
    angle, tx, ty = z.local_coordinates(x.between(y))
    return [_sf().V3(tx, ty, angle)]


def between_so3xr3(x: Sequence[E], y: Sequence[E], z: Sequence[E]) -> Sequence[E]:
    """Rotation and position apart."""
    rotation = z[0].local_coordinates(x[0].between(y[0]))
    return [_sf().V3(rotation), x[0].inverse() * (y[1] - x[1]) - z[1]]


def between_se3_whitened(x: E, y: E, z: E, sqrt_info: E) -> Sequence[E]:
    """S r with an upper triangular S."""
    sf = _sf()
    rows = [[sqrt_info[6 * i + j] if j >= i else 0 for j in range(6)] for i in range(6)]
    return [sf.V6(sf.M66(rows) * between_se3(x, y, z)[0])]


def prior_se3(x: E, z: E) -> Sequence[E]:
    """Log(z^-1 x)."""
    return [_sf().V6(z.local_coordinates(x))]


def reprojection_bal(x: E, K: E, p: E) -> Sequence[E]:
    """Snavely's camera."""
    sf = _sf()
    q = x * p
    m = sf.V2(-q[0] / q[2], -q[1] / q[2])
    r2 = m.squared_norm()
    return [K[0] * (1 + r2 * (K[1] + K[2] * r2)) * m]


def bearing_range_se2_r2(x: E, p: E, z: E) -> Sequence[E]:
    """Angle and distance, with its epsilon."""
    sf = _sf()
    q = x.inverse() * p
    return [sf.V2(sf.atan2(q[1], q[0], epsilon=0) - z[0], (p - x.t).norm(epsilon=sf.epsilon()) - z[1])]


def quaternion_local(q0: E, q1: E) -> Sequence[E]:
    """Log(q0^-1 q1)."""
    return [_sf().V3(q0.local_coordinates(q1))]


def quaternion_interpolation(q0: E, q1: E, a: E) -> Sequence[E]:
    """As its ``interpolate``."""
    return [q0.retract(_sf().V3(q0.local_coordinates(q1)) * a[0])]


def imu_step(x: Sequence[E], u: Sequence[E], b: Sequence[E], dt: E) -> Sequence[E]:
    """One step of integration."""
    sf = _sf()
    rotation, position, velocity = x
    a = rotation * (u[1] - b[1])
    p = position + velocity * dt[0] + a * (sf.Abs(dt[0]) * dt[0] / 2)
    turned = rotation * sf.Rot3.from_tangent((u[0] - b[0]) * dt[0])
    return [turned, p, velocity + a * dt[0]]


def rolling_shutter(R: E, p: E, C: E, c: E, w: E, v: E, P: E, t: E, K: E, D: E) -> Sequence[E]:
    """Pose at the row's time, then the camera of OpenCV with three radial terms."""
    sf = _sf()
    body = R * sf.Rot3.from_tangent(w * t[0])
    q = (body * C).inverse().to_rotation_matrix() * (P - (p + v * t[0] + body.to_rotation_matrix() * c))
    m, n = q[0] / q[2], q[1] / q[2]
    r2 = m * m + n * n
    radial = 1 + r2 * (D[0] + r2 * (D[1] + r2 * D[2]))
    md = radial * m + 2 * D[3] * m * n + D[4] * (r2 + 2 * m * m)
    nd = radial * n + 2 * D[3] * (r2 + 2 * n * n) + D[4] * m * n
    return [sf.V2(K[0] * md + K[2], K[1] * nd + K[3])]


FORMULAS: Mapping[str, Callable[..., Sequence[E]]] = {
    f.__name__: f
    for f in (
        between_se3, between_se3_whitened, between_so3, between_se2, between_so3xr3, prior_se3,
        reprojection_bal, bearing_range_se2_r2, quaternion_local, quaternion_interpolation,
        imu_step, rolling_shutter,
    )
}  # fmt: skip
