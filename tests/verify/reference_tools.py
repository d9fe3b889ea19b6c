"""Shared by the tests of the reference: Lie algebras written out, and factors."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

import liegen.manifolds as lm
from liegen.decorate import factor
from liegen.manifolds import (
    R1,
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SE23,
    SO2,
    SO3,
    Cal3_S2,
    Cal3Bundler,
    Cal3DS2,
    Gal3,
    Sim2,
    Sim3,
    Vector,
)
from liegen.manifolds.vector import stack
from liegen.verify.reference.matrix import skew

mp: Any = mpmath.mp
ORDER = {"SO2": 1, "SO3": 3, "SE2": 3, "SE3": 6, "SE23": 9, "Gal3": 10, "Sim2": 4, "Sim3": 7}
ROTATION = {
    "SO2": slice(0, 1),
    "SO3": slice(0, 3),
    "SE2": slice(2, 3),
    "SE3": slice(0, 3),
    "SE23": slice(0, 3),
    "Gal3": slice(0, 3),
    "Sim2": slice(2, 3),
    "Sim3": slice(0, 3),
}
MANIFOLDS: dict[str, type[lm.Manifold]] = {
    "SO2": SO2,
    "SO3": SO3,
    "SE2": SE2,
    "SE3": SE3,
    "SE23": SE23,
    "Gal3": Gal3,
    "Sim2": Sim2,
    "Sim3": Sim3,
}


def gap(a: Any, b: Any) -> Any:
    """The largest absolute difference of two nests of numbers."""
    if isinstance(a, (tuple, list)):
        assert len(a) == len(b)
        return max(gap(x, y) for x, y in zip(a, b, strict=True))
    return abs(mp.mpf(a) - mp.mpf(b))


def hat(name: str, d: Any) -> Any:
    """The matrix of the Lie algebra, written out for the test."""
    z = mp.zero
    if name == "SO2":
        return ((z, -d[0]), (d[0], z))
    if name == "SO3":
        return skew(d)
    if name == "SE2":
        return ((z, -d[2], d[0]), (d[2], z, d[1]), (z, z, z))
    if name in ("Sim2", "Sim3"):
        lam, rho = d[-1], d[:2] if name == "Sim2" else d[3:6]
        turn = hat("SO2", d[2:3]) if name == "Sim2" else skew(d[:3])
        rows = [[x + lam if i == j else x for j, x in enumerate(row)] for i, row in enumerate(turn)]
        return (*((*row, x) for row, x in zip(rows, rho, strict=True)), (z,) * (len(rho) + 1))
    if name == "Gal3":
        rows = zip(skew(d[:3]), d[6:9], d[3:6], strict=True)
        return (*((*row, v, x) for row, v, x in rows), (z, z, z, z, d[9]), (z,) * 5)
    if name == "SE23":
        rows = zip(skew(d[:3]), d[3:6], d[6:], strict=True)
        return (*((*row, x, v) for row, x, v in rows), (z,) * 5, (z,) * 5)
    return (*((*row, x) for row, x in zip(skew(d[:3]), d[3:], strict=True)), (z,) * 4)


def tangent(name: str, angle: Any, seed: int, length: float = 3.0) -> Any:
    """A tangent vector with the rotation ``angle`` and a translation of the given length."""
    g = np.random.default_rng(seed)
    v = [mp.mpf(float(x)) for x in g.normal(size=ORDER[name])]
    turn = ROTATION[name]
    size = mp.sqrt(sum(x * x for x in v[turn]))
    v[turn] = [x / size * angle for x in v[turn]]
    rest = [k for k in range(len(v)) if k not in range(len(v))[turn]]
    for k in rest[:-1] if name.startswith("Sim") else rest:  # the last is the logarithm of the scale
        v[k] = v[k] * length
    return tuple(v)


@factor
def prior_so3(x: SO3, *, z: SO3) -> Vector:
    return z.local(x)


@factor
def prior_so2(x: SO2, *, z: SO2) -> Vector:
    return z.local(x)


@factor
def prior_se2(x: SE2, *, z: SE2) -> Vector:
    return z.local(x)


@factor
def prior_se3(x: SE3, *, z: SE3) -> Vector:
    return z.local(x)


@factor
def prior_se23(x: SE23, *, z: SE23) -> Vector:
    return z.local(x)


@factor
def prior_gal3(x: Gal3, *, z: Gal3) -> Vector:
    return z.local(x)


@factor
def prior_sim2(x: Sim2, *, z: Sim2) -> Vector:
    return z.local(x)


@factor
def prior_sim3(x: Sim3, *, z: Sim3) -> Vector:
    return z.local(x)


@factor
def prior_s2_gtsam(x: S2, *, z: S2) -> Vector:
    return -x.local(z)


@factor
def bearing_gtsam(x: SE3, y: R3, *, z: S2) -> Vector:
    return -x.bearing(y).local(z)


@factor
def prior_r2(x: R2, *, z: R2) -> Vector:
    return z.local(x)


@factor
def prior_cal3_s2(x: Cal3_S2, *, z: Cal3_S2) -> Vector:
    return z.local(x)


@factor
def between_r3(x: R3, y: R3, *, z: R3) -> Vector:
    return z.local(x.between(y))


@factor
def between_so2(x: SO2, y: SO2, *, z: SO2) -> Vector:
    return z.local(x.between(y))


@factor
def between_so3(x: SO3, y: SO3, *, z: SO3) -> Vector:
    return z.local(x.between(y))


@factor
def between_se2(x: SE2, y: SE2, *, z: SE2) -> Vector:
    return z.local(x.between(y))


@factor
def between_se3(x: SE3, y: SE3, *, z: SE3) -> Vector:
    return z.local(x.between(y))


@factor
def range_r2(x: R2, y: R2, *, z: R1) -> Vector:
    return x.range(y) - z


@factor
def range_se2_r2(x: SE2, y: R2, *, z: R1) -> Vector:
    return x.range(y) - z


@factor
def range_se3(x: SE3, y: SE3, *, z: R1) -> Vector:
    return x.range(y) - z


@factor
def range_from_sensor(x: SE3, y: R3, *, body_T_sensor: SE3, z: R1) -> Vector:
    return (x @ body_T_sensor).range(y) - z


@factor
def bearing_se2_r2(x: SE2, y: R2, *, z: SO2) -> Vector:
    return z.local(x.bearing(y))


@factor
def bearing_se2(x: SE2, y: SE2, *, z: SO2) -> Vector:
    return z.local(x.bearing(y))


@factor
def bearing_range_gtsam(x: SE3, y: R3, *, z: S2, zr: R1) -> Vector:
    return stack(-x.bearing(y).local(z), x.range(y) - zr)


@factor
def projection_cal3_s2(x: SE3, p: R3, *, K: Cal3_S2, z: R2) -> Vector:
    q = x.transform_to(p)
    return K.uncalibrate(q[:2] / q[2]) - z


@factor
def projection_cal3_ds2(x: SE3, p: R3, *, K: Cal3DS2, z: R2) -> Vector:
    q = x.transform_to(p)
    return K.uncalibrate(q[:2] / q[2]) - z


@factor
def sfm_cal3_s2(x: SE3, p: R3, K: Cal3_S2, *, z: R2) -> Vector:
    q = x.transform_to(p)
    return K.uncalibrate(q[:2] / q[2]) - z


@factor
def sfm_cal3_bundler(x: SE3, p: R3, K: Cal3Bundler, *, z: R2) -> Vector:
    q = x.transform_to(p)
    return K.uncalibrate(q[:2] / q[2]) - z


PRIORS: dict[str, Any] = {
    "SO2": prior_so2,
    "SO3": prior_so3,
    "SE2": prior_se2,
    "SE3": prior_se3,
    "SE23": prior_se23,
    "Gal3": prior_gal3,
    "Sim2": prior_sim2,
    "Sim3": prior_sim3,
}
