"""Range factors: the distance of two positions against its measurement z [m].

Where both positions coincide the distance is 0 and its gradient 0.
"""

from __future__ import annotations

from liegen.decorate import factor
from liegen.manifolds import R1, R2, R3, SE2, SE3

from . import sampling


@factor(sample=sampling.distance(R2, R2))
def range_r2(x: R2, y: R2, *, z: R1):
    """Distance of two points of the plane minus its measurement z [m]."""
    return x.range(y) - z


@factor(sample=sampling.distance(R3, R3))
def range_r3(x: R3, y: R3, *, z: R1):
    """Distance of two points of space minus its measurement z [m]."""
    return x.range(y) - z


@factor(sample=sampling.distance(SE2, R2))
def range_se2_r2(x: SE2, y: R2, *, z: R1):
    """Distance of a pose and a point of the plane minus its measurement z [m]."""
    return x.range(y) - z


@factor(sample=sampling.distance(SE3, R3))
def range_se3_r3(x: SE3, y: R3, *, z: R1):
    """Distance of a pose and a point of space minus its measurement z [m]."""
    return x.range(y) - z


@factor(sample=sampling.distance(SE2, SE2))
def range_se2(x: SE2, y: SE2, *, z: R1):
    """Distance of two poses of the plane minus its measurement z [m]."""
    return x.range(y) - z


@factor(sample=sampling.distance(SE3, SE3))
def range_se3(x: SE3, y: SE3, *, z: R1):
    """Distance of two poses of space minus its measurement z [m]."""
    return x.range(y) - z
