"""The reference against the values of GTSAM 4.3 (../shared/oracle)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reference_tools as factors

from liegen.verify import reference

ORACLE: dict[str, Any] = {
    "PriorFactorPoint2": factors.prior_r2,
    "PriorFactorRot2": factors.prior_so2,
    "PriorFactorRot3": factors.prior_so3,
    "PriorFactorPose2": factors.prior_se2,
    "PriorFactorPose3": factors.prior_se3,
    "PriorFactorUnit3": factors.prior_s2_gtsam,
    "PriorFactorCal3_S2": factors.prior_cal3_s2,
    "BetweenFactorPoint3": factors.between_r3,
    "BetweenFactorRot2": factors.between_so2,
    "BetweenFactorRot3": factors.between_so3,
    "BetweenFactorPose2": factors.between_se2,
    "BetweenFactorPose3": factors.between_se3,
    "RangeFactor2": factors.range_r2,
    "RangeFactor2D": factors.range_se2_r2,
    "RangeFactorPose3": factors.range_se3,
    "RangeFactorWithTransform3D": factors.range_from_sensor,
    "BearingFactor2D": factors.bearing_se2_r2,
    "BearingFactorPose2": factors.bearing_se2,
    "BearingFactor3D": factors.bearing_gtsam,
    "BearingRangeFactor3D": factors.bearing_range_gtsam,
    "GenericProjectionFactorCal3_S2": factors.projection_cal3_s2,
    "GenericProjectionFactorCal3DS2": factors.projection_cal3_ds2,
    "GeneralSFMFactor2Cal3_S2": factors.sfm_cal3_s2,
    "GeneralSFMFactor2Cal3Bundler": factors.sfm_cal3_bundler,
}
FOLDER = Path(__file__).resolve().parents[3] / "shared" / "oracle"
needs_oracle = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the folder ../shared/oracle with GTSAM's values is absent"
)
#: Tags where GTSAM itself loses digits or where nothing is defined.
ELSEWHERE = ("behind", "coincident", "near_", "antipode", "rot_", "nearpi_", "pi")


def _quaternion(R: Any) -> Any:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(R).as_quat()


STORED: dict[str, Callable[[Any], Any]] = {
    "SO2": lambda R: (R[0, 0], R[1, 0]),
    "SE2": lambda T: (T[0, 0], T[1, 0], T[0, 2], T[1, 2]),
    "SO3": _quaternion,
    "SE3": lambda T: (*_quaternion(T[:3, :3]), *T[:3, 3]),
}


def cases(name: str) -> Any:
    """(tag, sample, row number) of every case that GTSAM evaluated, and the file."""
    pytest.importorskip("scipy")
    file = np.load(FOLDER / f"{name}.npz")
    parameters = ORACLE[name].graph.parameters
    data = {p.name: file[f"in_{p.name}"] for p in parameters}
    stored = {p.name: STORED.get(p.manifold.form.name, np.ravel) for p in parameters}
    rows = [k for k in range(len(file["tag"])) if not file["err"][k]]
    return file, [(str(file["tag"][k]), {n: stored[n](data[n][k]) for n in data}, k) for k in rows]


@needs_oracle
@pytest.mark.parametrize("name", list(ORACLE))
def test_residuals_agree_with_gtsam(name: str) -> None:
    file, samples = cases(name)
    checked = 0
    for tag, sample, k in samples:
        expected = file["rref" if tag.startswith(ELSEWHERE) else "r"][k]
        if tag == "behind" or not np.all(np.isfinite(expected)):
            continue
        bound = 1e-10 * max(1.0, float(np.max(np.abs(expected))))
        ends = [
            np.array(reference.outputs(ORACLE[name].graph, sample, flip=flip)["res"], float)
            for flip in (False, True)
        ]
        assert min(float(np.max(np.abs(r - expected))) for r in ends) < bound, (tag, k)
        checked += 1
    assert checked >= 190


@needs_oracle
@pytest.mark.parametrize("name", list(ORACLE))
def test_jacobians_agree_with_gtsams_differences(name: str) -> None:
    file, samples = cases(name)
    random = [(sample, k) for tag, sample, k in samples if tag == "random"][:12]
    assert len(random) == 12
    for sample, k in random:
        for (_, variable), rows in reference.jacobians(ORACLE[name].graph, sample).items():
            expected = file[f"Jnum_{variable}"][k]
            bound = 1e-8 * max(1.0, float(np.max(np.abs(expected))))
            assert np.max(np.abs(np.array(rows, float) - expected)) < bound, (variable, k)
