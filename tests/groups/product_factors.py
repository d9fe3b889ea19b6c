"""Products as a user writes them; passes the strict type check as it stands, every factor is verified."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liegen import (
    R1,
    R2,
    R3,
    R6,
    S2,
    SE3,
    SO2,
    SO3,
    Cal3_S2,
    Product,
    factor,
    function,
    outputs,
    require,
    stack,
)
from liegen.samples import Case, Draw


class State(Product):
    """Pose of the body, its velocity in the world, biases of accelerometer and gyroscope."""

    pose: SE3
    vel: R3
    bias: R6


class Camera(Product):
    """A camera that looks along +z."""

    pose: SE3
    K: Cal3_S2


class Sighting(Product):
    """Products nest; S2 has no rule for its retract."""

    direction: S2
    heading: SO2
    state: State


class Gains(Product):
    """A parameter struct."""

    scale: R1
    offset: R2


@factor
def prior_state(x: State, *, z: State):
    """State against its prior."""
    return z.local(x)


@factor
def between_states(x: State, y: State, *, z: State):
    """Relative state by the group's operations."""
    return z.local(x.between(y))


@factor
def all_operations(x: State, y: State, *, d: R3):
    """Compose, inverse, exp, log, retract, parts."""
    moved = x.retract(stack(d, 0.1 * y.vel, x.vel, y.bias))
    return (moved @ State.exp(x.log()).inverse() @ y).log()


@factor
def motion(x: State, y: State, *, gyro: R3, dt: R1):
    """Parts by name, and a state made of parts."""
    turned = SE3(x.pose.rotation @ SO3.exp((gyro - x.bias[3:]) * dt), x.pose.translation + x.vel * dt)
    predicted = State(pose=turned, vel=x.vel, bias=x.bias)
    return predicted.local(y)


@factor
def projection(camera: Camera, p: R3, *, z: R2):
    """A camera is a pose and a calibration."""
    q = camera.pose.transform_to(p)
    require(q[2] > 0, "point behind the camera")
    return camera.K.uncalibrate(q[:2] / q[2]) - z


@factor
def camera_prior(x: Camera, *, z: Camera):
    """No group: retract and local only."""
    return z.local(x)


def _short_of_the_antipode(draw: Draw, case: Case) -> dict[str, Sighting]:
    """S2 loses digits near the antipode, and has no Jacobian at it."""
    angle = None if case.angle is None else min(case.angle, 2.0)
    z = draw.element(Sighting, case.spread)
    return {"x": z.retract(draw.tangent(Sighting, replace(case, angle=angle))), "z": z}


@factor(sample=_short_of_the_antipode)
def sighting(x: Sighting, *, z: Sighting):
    """Nested parts."""
    moved = x.retract(0.1 * stack(x.state.bias, x.state.bias, x.state.bias))
    return stack(z.local(moved), z.direction.local(x.direction), x.state.pose.transform_to(z.state.vel))


@factor
def calibrated(g: Gains, *, u: R2, z: R2):
    """A struct of parameters."""
    return g.scale * u + g.offset - z


@function
def step(x: State, *, acc: R3, gyro: R3, dt: R1):
    """An output on a product has Jacobians in its own chart."""
    rotation = x.pose.rotation
    vel = x.vel + (rotation @ (acc - x.bias[:3])) * dt
    pose = SE3(rotation @ SO3.exp((gyro - x.bias[3:]) * dt), x.pose.translation + x.vel * dt)
    return outputs(y=State(pose=pose, vel=vel, bias=x.bias))


HOME = State(pose=SE3.identity(), vel=R3(1.0, 0.0, 0.0), bias=R6.from_storage(np.zeros(6)))


@factor
def from_home(x: State):
    """A product of the module is a constant."""
    return HOME.local(x)
