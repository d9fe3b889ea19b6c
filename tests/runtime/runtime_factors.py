"""Factors of all kinds, and arrays of arguments for them."""

from __future__ import annotations

import numpy as np

from liegen import (
    R1,
    R2,
    R3,
    SE3,
    SO3,
    Product,
    factor,
    function,
    library,
    outputs,
    require,
    stack,
)  # fmt: skip
from liegen.manifolds import Manifold
from liegen.modules import group_functions


class Body(Product):
    """Pose and velocity."""

    pose: SE3
    vel: R3


@function
def step(R: SO3, p: R3, *, gyro: R3, vel: R3, dt: R1):
    """One step of an inertial integration."""
    return outputs(R_new=R @ SO3.exp(gyro * dt), p_new=p + vel * dt)


@function
def rotated(R: SO3, p: R3):
    return R @ p


@factor
def drift(a: Body, *, b: Body):
    return stack(b.pose.local(a.pose), a.vel - b.vel)


@factor
def pixel(x: SE3, p: R3, *, z: R2):
    """A camera that refuses points behind it and points that are far away."""
    q = x.transform_to(p)
    require(q[2] > 0, "point behind the camera")
    require(q[2] < 50, "point too far away")
    return q[:2] / q[2] - z


@factor
def quotient(a: R2, *, b: R2):
    return stack(a[0] / b[0], a[1] / b[1])


@factor(noise="full", loss="cauchy")
def robust(x: SE3, y: SE3, *, z: SE3):
    return z.local(x.between(y))


@factor(chart="symforce")
def world(x: SE3, y: SE3, *, z: SE3):
    return z.local(x.between(y))


@factor
def scrambled(a: R1, b: R2, *, c: R3):
    return stack(a * b, c[0] * b)


between = library.between_se3
swapped = scrambled.vary("c").fix("a", name="swapped")  # calls in another order than it declares
matrix = next(f for f in group_functions(SO3) if f.name == "so3_Jr")  # a matrix, and no variables
FACTORS = (matrix, between, library.prior_s2, pixel, step, rotated, drift, robust, world, swapped)


def element(manifold: type[Manifold], shape: tuple[int, ...], rng) -> np.ndarray:
    """Stored numbers (*shape, n): quaternions and directions are unit vectors, all else is normal."""
    form = manifold.form
    array = rng.normal(size=(*shape, form.size))
    units = [slice(k, k + 4) for k, name in enumerate(form.storage) if name.endswith("qx")]
    for unit in [slice(0, 3)] if form.name == "S2" else units:
        array[..., unit] /= np.linalg.norm(array[..., unit], axis=-1, keepdims=True)
    return array


def arguments(function, shape: tuple[int, ...] = (), seed: int = 0) -> tuple[list, dict]:
    """Positional and named arrays for a call."""
    rng = np.random.default_rng(seed)
    given = {a.name: rng.normal(size=(*shape, *a.shape)) for a in function.kernel.arguments}
    for signature in function.declared:
        if signature.name in given and signature.bound is None:
            given[signature.name] = element(signature.manifold, shape, rng)
    kernel = function.kernel
    for a in kernel.keywords:
        if a.name not in {s.name for s in function.declared}:
            given[a.name] = np.abs(given[a.name]) + 0.5  # sizes of noise and loss
    return [given[a.name] for a in kernel.positional], {a.name: given[a.name] for a in kernel.keywords}
