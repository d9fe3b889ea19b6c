"""Camera models: from normalised image coordinates to pixels, as GTSAM defines its calibrations."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .calls import Call, Rule
from .matrix import Vector

Step = Callable[[Vector, Vector], Vector]


def _skewed_pinhole(K: Vector, p: Vector) -> Vector:
    """Pixels u = fx x + s y + u0, v = fy y + v0."""
    fx, fy, s, u0, v0, *_ = K
    return (fx * p[0] + s * p[1] + u0, fy * p[1] + v0)


def _brown(K: Vector, p: Vector) -> Vector:
    """Radial k1, k2 and tangential p1, p2 (Brown 1966; OpenCV's and GTSAM's order of p1, p2)."""
    (k1, k2, p1, p2), (x, y) = K[5:], p
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2 * r2
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def _bundler_radial(K: Vector, p: Vector) -> Vector:
    """Bundler's 1 + k1 r^2 + k2 r^4."""
    _, k1, k2, _, _ = K
    r2 = p[0] * p[0] + p[1] * p[1]
    radial = 1 + k1 * r2 + k2 * r2 * r2
    return (radial * p[0], radial * p[1])


def _bundler_pinhole(K: Vector, p: Vector) -> Vector:
    """Pixels u = f x + u0, v = f y + v0."""
    f, _, _, u0, v0 = K
    return (f * p[0] + u0, f * p[1] + v0)


#: By operation and calibration.
_STEPS: Mapping[tuple[str, str], Step] = {
    ("uncalibrate", "Cal3_S2"): _skewed_pinhole,
    ("distort", "Cal3DS2"): _brown,
    ("uncalibrate", "Cal3DS2"): _skewed_pinhole,
    ("distort", "Cal3Bundler"): _bundler_radial,
    ("uncalibrate", "Cal3Bundler"): _bundler_pinhole,
}


def _step(call: Call) -> Vector:
    K, p = call.values
    return _STEPS[call.operation.name, call.operation.parameters[0]](K, p)


OPERATIONS: Mapping[str, Rule] = {"distort": _step, "uncalibrate": _step}
