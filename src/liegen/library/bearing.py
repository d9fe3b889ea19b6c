"""Bearing factors: z measures the direction of y's position in the frame of x.

The orientation of x matters, that of y does not. Undefined where both positions coincide.
"""

from __future__ import annotations

from liegen.decorate import factor
from liegen.manifolds import R2, R3, S2, SE2, SE3, SO2

from . import sampling


@factor(sample=sampling.direction(SE2, R2))
def bearing_se2_r2(x: SE2, y: R2, *, z: SO2):
    """Bearing of a point from a pose of the plane against its measurement z [rad]."""
    return z.local(x.bearing(y))


@factor(sample=sampling.direction(SE2, SE2))
def bearing_se2(x: SE2, y: SE2, *, z: SO2):
    """Bearing of a pose from a pose of the plane against its measurement z [rad]."""
    return z.local(x.bearing(y))


@factor(sample=sampling.direction(SE3, R3))
def bearing_se3_r3(x: SE3, y: R3, *, z: S2):
    """Bearing of a point from a pose against its measurement z, in the tangent basis at z [rad]."""
    return z.local(x.bearing(y))


@factor(sample=sampling.direction(SE3, SE3))
def bearing_se3(x: SE3, y: SE3, *, z: S2):
    """Bearing of a pose from a pose against its measurement z, in the tangent basis at z [rad]."""
    return z.local(x.bearing(y))


@factor(sample=sampling.direction(SE3, R3))
def bearing_se3_r3_gtsam(x: SE3, y: R3, *, z: S2):
    """Bearing of a point from a pose as GTSAM evaluates it, in the tangent basis at the prediction [rad]."""
    return -x.bearing(y).local(z)


@factor(sample=sampling.direction(SE3, SE3))
def bearing_se3_gtsam(x: SE3, y: SE3, *, z: S2):
    """Bearing of a pose from a pose as GTSAM evaluates it, in the tangent basis at the prediction [rad]."""
    return -x.bearing(y).local(z)
