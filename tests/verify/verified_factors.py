"""A file as users write it: the factors of the documentation, a function with two outputs, kinks at ties."""

from __future__ import annotations

from liegen import (
    R1,
    R2,
    R3,
    SE3,
    SO3,
    abs,
    factor,
    function,
    maximum,
    minimum,
    norm,
    outputs,
    require,
    stack,
    where,
)  # fmt: skip


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
def step(R: SO3, p: R3, v: R3, *, gyro: R3, dt: R1):
    """One step of an inertial integration: the new orientation and position."""
    return outputs(R_new=R @ SO3.exp(gyro * dt), p_new=p + v * dt)


def _at_ties(draw, case):
    x = R3.from_storage(draw.vector(3))
    tied = case.name in ("identity", "coincident")
    return {
        "x": x,
        "y": x if tied else R3.from_storage(draw.vector(3)),
        "k": R1.from_storage([0.0 if tied else 0.7]),
    }


@factor(sample=_at_ties)
def corners(x: R3, y: R3, k: R1):
    """Kinks, some of the samples exactly at them; a tie of x[0] and y[0] for where is decided by <=."""
    return stack(minimum(x, y), maximum(x, y), abs(k), abs(x - y), where(k > 0.5, x[0] * k, y[0] * x[1]))
