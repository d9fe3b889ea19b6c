"""Prior factors: the residual is z.local(x)."""

from __future__ import annotations

from liegen.decorate import factor
from liegen.manifolds import R2, R3, S2, SE2, SE3, SO2, SO3

from . import sampling


@factor(sample=sampling.prior(R2))
def prior_r2(x: R2, *, z: R2):
    """Difference of a point x and its prior z, both in the world [m]."""
    return z.local(x)


@factor(sample=sampling.prior(R3))
def prior_r3(x: R3, *, z: R3):
    """Difference of a point x and its prior z, both in the world [m]."""
    return z.local(x)


@factor(sample=sampling.prior(SO2))
def prior_so2(x: SO2, *, z: SO2):
    """Angle of a rotation x from its prior z [rad]."""
    return z.local(x)


@factor(sample=sampling.prior(SE2))
def prior_se2(x: SE2, *, z: SE2):
    """Pose x against its prior z, in the frame of z [m, m, rad]."""
    return z.local(x)


@factor(sample=sampling.prior(SO3))
def prior_so3(x: SO3, *, z: SO3):
    """Rotation x against its prior z, in the frame of z [rad]."""
    return z.local(x)


@factor(sample=sampling.prior(SE3))
def prior_se3(x: SE3, *, z: SE3):
    """Pose x against its prior z, in the frame of z [rad, m]."""
    return z.local(x)


@factor(sample=sampling.prior(S2))
def prior_s2(x: S2, *, z: S2):
    """Direction x against its prior z, in the tangent basis at z [rad]."""
    return z.local(x)


@factor(sample=sampling.prior(S2))
def prior_s2_gtsam(x: S2, *, z: S2):
    """Direction x against its prior z as GTSAM evaluates it, in the tangent basis at x [rad]."""
    return -x.local(z)
