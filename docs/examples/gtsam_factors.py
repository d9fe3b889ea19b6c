"""GTSAM's factors as functions that `liegen check-jacobian` can hold against formulas (pip install gtsam)."""

from typing import Any

import gtsam
import numpy as np


def between(x, y, z):
    """BetweenFactorPose3; compare with between_se3."""
    noise = gtsam.noiseModel.Unit.Create(6)
    return evaluated(gtsam.BetweenFactorPose3(0, 1, pose(z), noise), pose(x), pose(y))


def bearing(x, y, z):
    """BearingFactor3D; compare with bearing_se3_r3_gtsam."""
    noise = gtsam.noiseModel.Unit.Create(2)
    return evaluated(gtsam.BearingFactor3D(0, 1, gtsam.Unit3(z), noise), pose(x), y)


def pose(x):
    """A Pose3 from the stored quaternion (x, y, z, w) and translation."""
    return gtsam.Pose3(gtsam.Rot3.Quaternion(x[3], x[0], x[1], x[2]), x[4:])


def evaluated(factor: Any, *variables: Any):
    """The residual and the Jacobians, of a factor with unit noise on the keys 0, 1, ..."""
    values = gtsam.Values()
    for key, value in enumerate(variables):
        values.insert(key, value)
    A, b = factor.linearize(values).jacobian()
    dims = [6 if isinstance(v, gtsam.Pose3) else len(v) for v in variables]
    return -b, *np.split(A, np.cumsum(dims)[:-1], axis=1)
