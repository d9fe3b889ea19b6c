"""Camera factors: x is the pose of a camera that looks along +z, p a point of the world, z its pixel.

Generic projection holds the calibration fixed; in general structure from motion it is a variable.
"""

from __future__ import annotations

from liegen.decorate import factor
from liegen.manifolds import R2, R3, SE3, Cal3_S2, Cal3Bundler, Cal3DS2, Calibration
from liegen.trace import require

from . import sampling


def reprojection(x: SE3, p: R3, K: Calibration, z: R2):
    """The one formula: pixel of p minus z."""
    q = x.transform_to(p)
    require(q[2] > 0, "point behind the camera")
    return K.uncalibrate(q[:2] / q[2]) - z


@factor(sample=sampling.camera(Cal3_S2))
def projection_cal3_s2(x: SE3, p: R3, *, K: Cal3_S2, z: R2):
    """Pixel of p in the camera x with known pinhole calibration K, minus its measurement z [px]."""
    return reprojection(x, p, K, z)


@factor(sample=sampling.camera(Cal3DS2))
def projection_cal3_ds2(x: SE3, p: R3, *, K: Cal3DS2, z: R2):
    """Pixel of p in the camera x with known distortion K, minus its measurement z [px]."""
    return reprojection(x, p, K, z)


@factor(sample=sampling.camera(Cal3Bundler))
def projection_cal3_bundler(x: SE3, p: R3, *, K: Cal3Bundler, z: R2):
    """Pixel of p in the camera x with known radial distortion K, minus its measurement z [px]."""
    return reprojection(x, p, K, z)


sfm_cal3_s2 = projection_cal3_s2.vary(
    "K", name="sfm_cal3_s2", doc="Pixel of p in the camera x with pinhole calibration K, minus z [px]."
)
sfm_cal3_bundler = projection_cal3_bundler.vary(
    "K", name="sfm_cal3_bundler", doc="Pixel of p in the camera x with radial distortion K, minus z [px]."
)
