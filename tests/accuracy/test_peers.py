"""Peers in the accuracy table: a lossy one is flagged, a right one is not, missing ones are named."""

from __future__ import annotations

import importlib
import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from liegen.accuracy.peers import measure_peers, measured
from liegen.accuracy.peers.contract import Operation, Peer, quaternion, rotation_matrix
from liegen.accuracy.points import COLUMNS
from liegen.cli import app
from liegen.verify.run import everything

FUNCTIONS = [everything()[n] for n in ("between_so3", "so3_log", "so3_exp", "se2_log", "between_se3")]


def acos_log(a):
    """The textbook: the angle from the trace."""
    R = rotation_matrix(a["x"])
    angle = np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1))
    v = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return {"out": v * (angle / (2 * np.sin(angle)) if np.sin(angle) else 0.5)}


def half_angle_log(a):
    v, w = a["x"][:3], a["x"][3]
    n = np.linalg.norm(v)
    return {"out": (2 * np.arctan2(n * np.copysign(1, w), abs(w)) / n if n else 2.0) * v}


def peer(name, evaluate):
    return lambda: Peer(name, "1", "a test", (Operation("so3_log", "gtsam", evaluate),))


def absent():
    return importlib.import_module("a_library_that_nobody_has")


def test_a_lossy_peer_is_told_from_a_good_one(monkeypatch):
    loaders = {"textbook": peer("textbook", acos_log), "good": peer("good", half_angle_log), "absent": absent}
    monkeypatch.setattr(measured, "LOADERS", loaders)
    report = measure_peers(FUNCTIONS, samples=2, seed=0)
    assert report.missing == (("absent", "No module named 'a_library_that_nobody_has'"),)
    row = next(r for r in report.rows if r.block == "out")
    figures = dict(row.theirs)
    assert figures["good"].largest < 1e-15
    assert figures["textbook"].worst[COLUMNS.index("pi-1e-8")] > 1e-9
    assert all(f.largest < 1e-14 for f in row.ours)
    # the library has no Jacobian
    assert next(r for r in report.rows if r.block == "out_D_x").theirs == ()
    assert "absent: missing" in "\n".join(report.lines())


@pytest.mark.parametrize("name", measured.LOADERS)
def test_libraries_agree_away_from_special_angles(name):
    """A wrong order, side or frame in an adapter would be wrong by 1."""
    try:
        peer = measured.LOADERS[name]()
    except ImportError as error:
        pytest.skip(str(error))
    known = everything()
    for operation in peer.operations:
        function = known[operation.function].in_chart(operation.preset)
        points, _ = measured.draw_points(function, 1, 3)
        chosen = [p for p in points if COLUMNS[p.column] == "1"]
        expected, _ = measured.reference_blocks(function, chosen)
        for figure in measured._figures(operation, name, expected, chosen):
            # its between factor leaves Jr^-1 out
            known_wrong = peer.version.startswith("4.2") and operation.function.startswith("between")
            if figure.is_value or not known_wrong:
                assert figure.largest < 1e-9, (operation.function, figure.block)


def test_quaternions_of_matrices():
    for q in np.vstack([np.eye(4), Rotation.random(20, rng=1).as_quat()]):
        R = rotation_matrix(q)
        np.testing.assert_allclose(R, Rotation.from_quat(q).as_matrix(), atol=1e-15)
        found = quaternion(R)
        assert min(np.abs(found - q).max(), np.abs(found + q).max()) < 1e-15


def test_the_command_prints_them_beside_its_own(monkeypatch):
    monkeypatch.setattr(measured, "LOADERS", {"textbook": peer("textbook", acos_log), "absent": absent})
    words = ["verify", "--accuracy", "--peers", "-f", "so3_log", "--chart", "gtsam", "--samples", "2"]
    done = CliRunner().invoke(app, words)
    # the bound is liegen's own
    assert done.exit_code == 0, done.output
    _, own, other = next(
        lines for lines in pairwise3(done.output.splitlines()) if lines[0].startswith("function (chart)")
    )
    assert own.split()[:3] == ["so3_log", "out", "liegen"]
    assert other.split()[0] == "textbook"
    assert "!" in other
    assert "!" not in own
    assert "absent: missing (No module named" in done.output
    content = json.loads(CliRunner().invoke(app, [*words, "--json"]).output)["peers"]
    assert {f["library"] for f in content["figures"]} == {"liegen", "textbook"}
    assert [m["name"] for m in content["missing"]] == ["absent"]


def pairwise3(lines):
    return zip(lines, lines[1:], lines[2:], strict=False)
