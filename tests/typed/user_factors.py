"""Factors as a user writes them; passes the strict type check as it stands."""

import numpy as np

from liegen import (
    R1,
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Cal3_S2,
    Cal3Bundler,
    R,
    Vector,
    abs,
    acos,
    asin,
    atan2,
    cos,
    cross,
    dot,
    exp,
    factor,
    function,
    log,
    maximum,
    minimum,
    norm,
    outputs,
    require,
    sin,
    sqrt,
    stack,
    tan,
    where,
)

MIXING = np.array([[1.0, 0.0, 2.0], [0.5, -1.0, 0.0]])
GRAVITY = R3(0, 0, -9.81)
LEVER = SE3(SO3.exp([0.0, 0.0, 0.1]), [1.0, 0.0, -0.5])
WEIGHTS = [1.0, 2.0, 3.0]


class R12(R, dim=12):
    """Larger vectors have a class of their own."""


@factor
def lever_arm_range(T_WB: SE3, lever: R3, *, anchor: R3, z: R1):
    """Distance from an anchor to an antenna that sits at `lever` in the body frame, metres."""
    return norm(T_WB.transform_from(lever) - anchor) - z


@factor
def inverse_depth(T_WA: SE3, T_WB: SE3, rho: R1, *, ray: R2, z: R2):
    p = T_WB.transform_to(T_WA.transform_from(stack(ray, 1) / rho))
    require(p[2] > 0, "point behind the camera")
    return p[:2] / p[2] - z


@factor
def interpolated(x: SE3, y: SE3, *, a: R1, z: SE3):
    return z.local(x.retract(a * x.local(y)))


@function
def imu_step(R_WB: SO3, v: R3, p: R3, gyro: R3, accel: R3, *, dt: R1):
    """One step of dead reckoning, with outputs on two manifolds."""
    a = R_WB @ accel + GRAVITY
    turned = R_WB @ SO3.exp(gyro * dt)
    position = p + v * dt + 0.5 * a * dt * abs(dt)
    return outputs(R_next=turned, v_next=v + a * dt, p_next=position)


@function
def midpoint(x: SE3, y: SE3) -> SE3:
    """A function with one output on a group."""
    return x.retract(0.5 * x.local(y))


@factor
def through_midpoint(x: SE3, y: SE3, *, z: SE3):
    return z.local(midpoint(x, y))


@factor
def mounted(T_WB: SE3, p: R3, *, z: R3):
    sensor = T_WB @ LEVER
    q = sensor @ p
    return sensor.inverse().transform_from(q) + sensor.rotation @ p - sensor.translation - z


@factor
def mixed(v: R3, w: R3, *, z: R2):
    u: Vector = MIXING @ (v - w)
    return u / (1 + dot(v, w) ** 2) + MIXING @ cross(v, w) - z


@factor
def scalars(x: R1, y: R1, *, z: R1):
    r = sqrt(1 + x * x) + exp(-y) * sin(x) - cos(y) / (2 + tan(x) * tan(x))
    s = atan2(y, x) + asin(x / 10) + acos(y / 10) + log(1 + x * x)
    t = minimum(maximum(r, s), 3.0) + maximum(0.0, x)
    return where((x > y) & ~(y >= 2.0), t, r - s) - z


@factor
def unrolled(c: R12, *, z: R3):
    total = stack(0, 0, 0)
    for k, weight in enumerate(WEIGHTS):
        total = total + weight * c[3 * k : 3 * k + 3]
    return np.array([1.0, 2.0, 3.0]) + total - np.array([0.5, 0.5, 0.5]) - c[-3:] - z


@factor
def plane_bearing(x: SE2, y: R2, *, z: SO2):
    return stack(z.local(x.bearing(y)), x.range(y))


@factor
def space_bearing(x: SE3, y: R3, n: S2, *, z: S2):
    return stack(z.local(x.bearing(y)), z.local(n), n.vector - S2.direction(y).vector)


@factor
def pose_of_parts(R_WB: SO3, t: R3, *, z: SE3):
    return z.local(SE3(R_WB, t).compose(SE3.identity())) + SE3.exp(stack(t, t)).log()


@factor
def camera(x: SE3, p: R3, *, K: Cal3_S2, z: R2):
    q = x.transform_to(p)
    require(q[2] > 0.1, "point too near")
    return K.uncalibrate(q[:2] / q[2]) - z


@factor
def bundle(x: SE3, p: R3, K: Cal3Bundler, *, z: R2):
    q = x.transform_to(p)
    require(q[2] > 0, "point behind the camera")
    return K.uncalibrate(q[:2] / q[2]) - z


free_camera = camera.vary("K", name="free_camera")
known_point = camera.fix("p", name="known_point", doc="The point is given.")
this_camera = camera.bind(K=Cal3_S2.from_storage([500.0, 500, 0, 320, 240]), name="this_camera")
