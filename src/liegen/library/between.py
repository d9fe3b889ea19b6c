"""Between factors: z measures y in the frame of x, the residual is z.local(x.between(y))."""

from __future__ import annotations

from liegen.decorate import factor
from liegen.manifolds import R2, R3, SE2, SE3, SO2, SO3

from . import sampling


@factor(sample=sampling.between(R2))
def between_r2(x: R2, y: R2, *, z: R2):
    """z measures the vector from x to y [m]."""
    return z.local(x.between(y))


@factor(sample=sampling.between(R3))
def between_r3(x: R3, y: R3, *, z: R3):
    """z measures the vector from x to y [m]."""
    return z.local(x.between(y))


@factor(sample=sampling.between(SO2))
def between_so2(x: SO2, y: SO2, *, z: SO2):
    """z measures the rotation from x to y; residual [rad]."""
    return z.local(x.between(y))


@factor(sample=sampling.between(SE2))
def between_se2(x: SE2, y: SE2, *, z: SE2):
    """z measures the pose of y in the frame of x; residual [m, m, rad] in the frame of y as measured."""
    return z.local(x.between(y))


@factor(sample=sampling.between(SO3))
def between_so3(x: SO3, y: SO3, *, z: SO3):
    """z measures the rotation of y in the frame of x; residual [rad] in the frame of y as measured."""
    return z.local(x.between(y))


@factor(sample=sampling.between(SE3))
def between_se3(x: SE3, y: SE3, *, z: SE3):
    """z measures the pose of y in the frame of x; residual [rad, m] in the frame of y as measured."""
    return z.local(x.between(y))
