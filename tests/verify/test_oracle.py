"""The generated code against the values of GTSAM 4.3 (../shared/oracle), for every factor that both have."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liegen import library
from liegen.verify import reference
from liegen.verify.backends import numpy_backends

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "oracle"
pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the folder ../shared/oracle with GTSAM's values is absent"
)

ORACLE: dict[str, Any] = {
    "PriorFactorPoint2": library.prior_r2,
    "PriorFactorPoint3": library.prior_r3,
    "PriorFactorRot2": library.prior_so2,
    "PriorFactorRot3": library.prior_so3,
    "PriorFactorPose2": library.prior_se2,
    "PriorFactorPose3": library.prior_se3,
    "PriorFactorUnit3": library.prior_s2_gtsam,
    "BetweenFactorPoint2": library.between_r2,
    "BetweenFactorPoint3": library.between_r3,
    "BetweenFactorRot2": library.between_so2,
    "BetweenFactorRot3": library.between_so3,
    "BetweenFactorPose2": library.between_se2,
    "BetweenFactorPose3": library.between_se3,
    "RangeFactor2": library.range_r2,
    "RangeFactor3": library.range_r3,
    "RangeFactor2D": library.range_se2_r2,
    "RangeFactor3D": library.range_se3_r3,
    "RangeFactorPose2": library.range_se2,
    "RangeFactorPose3": library.range_se3,
    "BearingFactor2D": library.bearing_se2_r2,
    "BearingFactorPose2": library.bearing_se2,
    "BearingFactor3D": library.bearing_se3_r3_gtsam,
    "GenericProjectionFactorCal3_S2": library.projection_cal3_s2,
    "GenericProjectionFactorCal3DS2": library.projection_cal3_ds2,
    "GeneralSFMFactor2Cal3_S2": library.sfm_cal3_s2,
    "GeneralSFMFactor2Cal3Bundler": library.sfm_cal3_bundler,
}
#: Tags where GTSAM itself loses digits or nothing is defined: there the code is held against mpmath.
EXEMPT = ("behind", "coincident", "near_", "antipode", "rot_", "nearpi_", "pi")
#: GTSAM's analytic Jacobian is right at zero residual only: its differences are taken instead.
INEXACT = ("BearingFactor3D",)


def quaternions(R):
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(R).as_quat()


STORED = {
    "SO2": lambda R: R[:, :, 0],
    "SE2": lambda T: np.concatenate([T[:, :2, 0], T[:, :2, 2]], axis=1),
    "SO3": quaternions,
    "SE3": lambda T: np.concatenate([quaternions(T[:, :3, :3]), T[:, :3, 3]], axis=1),
}


def loaded(name):
    """The file, and the arguments as arrays of stored numbers."""
    pytest.importorskip("scipy")
    file = np.load(FOLDER / f"{name}.npz")
    stored = {
        p.name: STORED.get(p.manifold.form.name, lambda a: a)(file[f"in_{p.name}"])
        for p in ORACLE[name].graph.parameters
    }
    return file, {key: np.asarray(a, dtype=np.float64) for key, a in stored.items()}


@pytest.mark.parametrize("name", list(ORACLE))
def test_agrees_with_gtsam(name, library_place, capsys):
    function = ORACLE[name]
    file, arguments = loaded(name)
    tags = file["tag"].astype(str)
    values, everything = (
        b.evaluate(arguments) for b in numpy_backends(function.kernel, library_place.folder)
    )
    residual, r = values["res"], file["r"]
    exempt = np.array([tag.startswith(EXEMPT) for tag in tags])
    assert not file["err"][~exempt].any()

    apart = np.abs(residual - r).max(axis=1) / np.maximum(1.0, np.abs(r).max(axis=1))
    assert apart[~exempt].max() <= 1e-10

    special = [0.0]
    for k in np.flatnonzero(exempt):
        sample = {key: tuple(a[k]) for key, a in arguments.items()}
        if not all(reference.holds(function.graph, sample)):
            assert np.isnan(residual[k]).all()
            continue
        branches = [
            _floats(reference.outputs(function.graph, sample, flip=flip)["res"]) for flip in (False, True)
        ]
        if tags[k] == "antipode":  # the direction is undefined, the angle is pi
            special.append(abs(float(np.linalg.norm(residual[k])) - np.pi))
            continue
        error = min(float(np.abs(residual[k] - b).max()) for b in branches)
        special.append(error / max(1.0, float(np.abs(residual[k]).max())))
    assert max(special) <= 1e-10

    random = tags == "random"
    assert random.sum() >= 190
    worst = 0.0
    for p in (p for p in function.graph.parameters if p.variable):
        kind = "Jnum" if name in INEXACT else "J"
        expected = file[f"{kind}_{p.name}"][random]
        mine = everything[f"res_D_{p.name}"][random]
        usable = np.isfinite(expected).all(axis=(1, 2))
        assert usable.sum() >= 190
        scale = np.abs(expected).max(axis=(1, 2))
        error = np.abs(mine - expected).max(axis=(1, 2)) / np.where(scale > 0, scale, 1.0)
        worst = max(worst, float(error[usable].max()))
    with capsys.disabled():
        figures = (
            f"residual {apart[~exempt].max():.1e}, exempt cases {max(special):.1e}, Jacobian {worst:.1e}"
        )
        print(f"\n{name}: {figures}", end=" ")
    assert worst <= 1e-8


def _floats(element):
    return np.array([float(x) for x in element])


def test_the_exact_flags_are_those_of_the_files():
    """Where GTSAM's own Jacobian is wrong is written in the files."""
    for name in ORACLE:
        meta = json.loads(str(np.load(FOLDER / f"{name}.npz")["meta"]))
        assert meta["gtsam_jacobian_exact"] is (name not in INEXACT)
