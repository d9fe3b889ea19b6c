"""NavState's chart against GTSAM 4.3: residual and Jacobian of its prior factor (../shared/oracle)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liegen import SE23, NavState, factor
from liegen.verify import reference

FILE = Path(__file__).resolve().parents[3] / "shared" / "oracle" / "PriorFactorNavState.npz"
pytestmark = pytest.mark.skipif(
    not FILE.is_file(), reason="the folder ../shared/oracle with GTSAM's values is absent"
)


@factor
def prior_nav_state(x: NavState, *, z: NavState):
    """GTSAM's PriorFactor: in another chart than the exponential one this is not z.local(x)."""
    return -x.local(z)


@factor
def prior_seen_from_z(x: NavState, *, z: NavState):
    return z.local(x)


@factor
def prior_se23(x: SE23, *, z: SE23):
    return z.local(x)


def stored(T: Any) -> Any:
    """From GTSAM's 5 x 5 matrix [[R, p, v], [0, I]]."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    return np.hstack([rotation.from_matrix(T[:3, :3]).as_quat(), T[:3, 3], T[:3, 4]])


@pytest.fixture(scope="module")
def cases() -> Any:
    file = np.load(FILE)
    assert not any(file["err"])
    return file, [{n: stored(file[f"in_{n}"][k]) for n in ("x", "z")} for k in range(len(file["tag"]))]


def largest(a: Any, b: Any) -> float:
    return float(np.max(np.abs(a - b)) / max(1.0, np.max(np.abs(b))))


def test_residual_and_jacobian_are_gtsams(cases: Any) -> None:
    """In all 251 cases; GTSAM loses digits of the rotation near pi, at pi it may take the other branch."""
    file, samples = cases
    compared = 0
    for k, sample in enumerate(samples):
        tag, r = str(file["tag"][k]), file["r"][k]
        near = tag.startswith(("nearpi_", "pi"))
        ours = prior_nav_state.jacobians(**sample)
        if tag == "pi" and np.dot(ours["res"][:3], r[:3]) < 0:
            other = np.hstack([r[:3] * (1 - 2 * np.pi / np.linalg.norm(r[:3])), r[3:]])
            assert largest(ours["res"], other) < 1e-7, k
            continue
        assert largest(ours["res"], r) < (1e-7 if near else 1e-14), (tag, k)
        assert largest(ours["res_D_x"], file["J_x"][k]) < (1e-7 if near else 1e-14), (tag, k)
        if tag == "random":
            assert largest(ours["res_D_x"], file["Jnum_x"][k]) < 1e-8, k
        compared += 1
    assert compared >= 248


def test_the_reference_has_gtsams_chart_too(cases: Any) -> None:
    file, samples = cases
    for k in range(0, 60, 5):
        r = reference.outputs(prior_nav_state.graph, samples[k])["res"]
        J = reference.jacobians(prior_nav_state.graph, samples[k])["res", "x"]
        assert largest(np.array(r, float), file["r"][k]) < 1e-10
        assert largest(np.array(J, float), file["Jnum_x"][k]) < 1e-8


@pytest.mark.parametrize("other", [prior_se23, prior_seen_from_z], ids=lambda f: f.name)
def test_other_charts_do_not_agree(cases: Any, other: Any) -> None:
    file, samples = cases
    assert largest(other.jacobians(**samples[0])["res"], file["r"][0]) > 1e-2
