"""The functions of published benchmarks that the library does not have.

From the wrenfold-benchmarks suite: quaternion local coordinates, interpolation, an IMU integration step and a
rolling-shutter camera. From SymForce's: poses as products (translation perturbed in the world), the
reprojection of "bundle adjustment in the large", bearing with range. Rotations are perturbed on the right.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from liegen.decorate import factor, function
from liegen.manifolds import R1, R2, R3, R4, R5, SE2, SE3, SO2, SO3, Product, Value
from liegen.manifolds.functions import abs as absolute
from liegen.manifolds.functions import dot
from liegen.manifolds.vector import norm, stack
from liegen.samples import Case, Draw

#: Fraction of the way at which the interpolation is timed.
FRACTION = 0.312


class SO3xR3(Product):
    """A rotation and a position, each perturbed on its own: the position in the world."""

    R: SO3
    t: R3


class Motion(Product):
    """Orientation of the body, its position and velocity in the world [m, m/s]."""

    R: SO3
    p: R3
    v: R3


class Inertial(Product):
    """Angular rate [rad/s] and specific force [m/s^2], both in the body; or the biases of these."""

    gyro: R3
    accel: R3


def _poses(draw: Draw, case: Case) -> Mapping[str, Value]:
    """x and y anywhere, z the case's tangent away from what the factor predicts."""
    x, y = (draw.element(SO3xR3, case.spread) for _ in range(2))
    y = x if case.name == "identity" else y
    turned = x.R.between(y.R).retract(-draw.tangent(SO3, case))
    moved = x.R.unrotate(y.t - x.t) - draw.tangent(R3, case)
    return {"x": x, "y": y, "z": SO3xR3(R=turned, t=moved)}


@factor(sample=_poses)
def between_so3xr3(x: SO3xR3, y: SO3xR3, *, z: SO3xR3):
    """z measures y in the frame of x: rotation [rad], then position [m] in the frame of x."""
    return stack(z.R.local(x.R.between(y.R)), x.R.unrotate(y.t - x.t) - z.t)


def _near(draw: Draw, case: Case) -> Mapping[str, Value]:
    z = draw.element(SO3xR3, case.spread)
    return {"x": z.retract(draw.tangent(SO3xR3, case)), "z": z}


@factor(sample=_near)
def prior_so3xr3(x: SO3xR3, *, z: SO3xR3):
    """Pose x against its prior z: rotation [rad], then position [m] in the world."""
    return z.local(x)


def _seen(draw: Draw, case: Case) -> Mapping[str, Value]:
    """A point in front of a camera that looks along -z."""
    x = SE3.identity() if case.name == "identity" else draw.element(SE3, case.spread)
    ray = np.array([draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), -1.0])
    p = x.transform_to(ray * draw.uniform(1.0, 10.0) * case.spread)
    K = [draw.uniform(400.0, 800.0), draw.uniform(-0.2, 0.2), draw.uniform(-0.1, 0.1)]
    return {"x": x, "K": R3.from_storage(K), "p": p}


@function(sample=_seen)
def reprojection_bal(x: SE3, K: R3, p: R3):
    """Pixel of the point p of the world; x is world to camera, K = (f [px], k1, k2); it looks along -z."""
    q = x.transform_from(p)
    m = -q[:2] / q[2]
    r2 = dot(m, m)
    return K[0] * (1 + r2 * (K[1] + K[2] * r2)) * m


def _sighted(draw: Draw, case: Case) -> Mapping[str, Value]:
    x = draw.element(SE2, case.spread)
    direction = draw.uniform(-3.0, 3.0)
    distance = draw.uniform(0.5, 5.0) * case.spread
    ray = distance * np.array([np.cos(direction), np.sin(direction)])
    off = draw.vector(2, spread=0.1)
    return {"x": x, "p": x.transform_from(ray), "z": R2.from_storage(np.array([direction, distance]) + off)}


@factor(sample=_sighted)
def bearing_range_se2_r2(x: SE2, p: R2, *, z: R2):
    """Angle [rad] and distance [m] of the point p seen from the pose x, minus those measured, not wrapped."""
    d = p - x.translation
    return stack(x.rotation.between(SO2.direction(d)).log() - z[0], norm(d) - z[1])


def _two(draw: Draw, case: Case) -> Mapping[str, Value]:
    q0 = draw.element(SO3)
    return {"q0": q0, "q1": q0.retract(draw.tangent(SO3, case))}


@function(sample=_two)
def quaternion_local(q0: SO3, q1: SO3):
    """Rotation vector from q0 to q1 [rad], the short way round."""
    return q0.local(q1)


def _between(draw: Draw, case: Case) -> Mapping[str, Value]:
    return {**_two(draw, case), "a": R1.from_storage([FRACTION])}


@function(sample=_between)
def quaternion_interpolation(q0: SO3, q1: SO3, *, a: R1):
    """The rotation the fraction a of the way from q0 to q1, the short way round."""
    return q0 @ SO3.exp(a * q0.local(q1))


def _step(draw: Draw, case: Case) -> Mapping[str, Value]:
    """A body in motion; its rate turns it by the case's angle, where there is one."""

    def within(size: float) -> R3:
        return R3.from_storage([draw.uniform(-size, size) for _ in range(3)])

    dt = 0.01 + draw.uniform(0.0, 0.1)
    bias = Inertial(gyro=within(0.02), accel=within(0.2))
    rate = within(1.0) if case.angle is None else bias.gyro + draw.vector(3, case.angle / dt)
    return {
        "x": Motion(R=draw.element(SO3), p=within(5.0 * case.spread), v=within(5.0)),
        "u": Inertial(gyro=rate, accel=within(10.0)),
        "b": bias,
        "dt": R1.from_storage([dt]),
    }


@function(sample=_step)
def imu_step(x: Motion, u: Inertial, b: Inertial, *, dt: R1):
    """The motion x after dt [s], for the measured rate and specific force u with biases b; no gravity."""
    a = x.R @ (u.accel - b.accel)
    p = x.p + x.v * dt + a * (absolute(dt) * dt * 0.5)
    return Motion(R=x.R @ SO3.exp((u.gyro - b.gyro) * dt), p=p, v=x.v + a * dt)


def _rolling(draw: Draw, case: Case) -> Mapping[str, Value]:
    """A point in the camera's view at the time t; the case's angle is what the body has turned since 0."""
    t = draw.uniform(0.005, 0.02)
    w = R3.from_storage(draw.vector(3, None if case.angle is None else case.angle / t))
    R, C = draw.element(SO3), draw.element(SO3)
    v, p, c = (R3.from_storage(draw.vector(3, spread=case.spread)) for _ in range(3))
    ray = np.array([draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), 1.0])
    body = R @ SO3.exp(w * t)
    K = [*(draw.uniform(400.0, 800.0) for _ in range(2)), *(draw.uniform(300.0, 400.0) for _ in range(2))]
    return {
        "R": R, "p": p, "C": C, "c": c, "w": w, "v": v,
        "P": body @ (C @ (ray * draw.uniform(1.0, 10.0) * case.spread)) + body @ c + p + v * t,
        "t": R1.from_storage([t]),
        "K": R4.from_storage(K),
        "D": R5.from_storage(draw.vector(5, spread=0.02)),
    }  # fmt: skip


@function(sample=_rolling)
def rolling_shutter(R: SO3, p: R3, C: SO3, c: R3, w: R3, v: R3, P: R3, *, t: R1, K: R4, D: R5):
    """Pixel of the point P of the world in a row that is read out the time t after the body's pose (R, p).

    (C, c) is the camera in the body, which moves with w [rad/s] in its own frame and v [m/s] in the world;
    K = (fx, fy, cx, cy) [px], D = (k1, k2, k3, p1, p2).
    """
    body = R @ SO3.exp(w * t)
    q = C.unrotate(body.unrotate(P - (p + v * t)) - c)
    m = q[:2] / q[2]
    x, y = m[0], m[1]
    r2 = x * x + y * y
    radial = 1 + r2 * (D[0] + r2 * (D[1] + r2 * D[2]))
    xd = radial * x + 2 * D[3] * x * y + D[4] * (r2 + 2 * x * x)
    yd = radial * y + 2 * D[3] * (r2 + 2 * y * y) + D[4] * x * y
    return stack(K[0] * xd + K[2], K[1] * yd + K[3])
