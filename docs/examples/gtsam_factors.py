"""Factors of GTSAM for `liegen check-jacobian` (pip install gtsam), as any program of yours makes them."""

import gtsam
import numpy as np

z = gtsam.Pose3(gtsam.Rot3.RzRyRx(0.5, -0.2, 0.3), np.array([1.0, 2.0, 3.0]))
noise = gtsam.noiseModel.Gaussian.Covariance(np.diag([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]) + 0.02)

between = gtsam.BetweenFactorPose3(0, 1, z, noise)
prior = gtsam.PriorFactorPose3(0, z, noise)
bearing = gtsam.BearingFactor3D(
    0, 1, gtsam.Unit3(np.array([1.0, 2.0, 3.0])), gtsam.noiseModel.Isotropic.Sigma(2, 0.1)
)
camera = gtsam.GenericProjectionFactorCal3_S2(
    np.array([300.0, 200.0]),
    gtsam.noiseModel.Isotropic.Sigma(2, 1.5),
    0,
    1,
    gtsam.Cal3_S2(500.0, 510.0, 0.1, 320.0, 240.0),
)


def error(factor, values, H):
    """A between factor with the approximation that GTSAM 4.2 makes: Jr^-1 left out."""
    first, second = factor.keys()
    x, y = values.atPose3(first), values.atPose3(second)
    if H is not None:
        H[0] = -x.between(y).inverse().AdjointMap()
        H[1] = np.eye(6)
    return gtsam.Pose3.Logmap(z.between(x.between(y)))


approximate = gtsam.CustomFactor(noise, [0, 1], error)
