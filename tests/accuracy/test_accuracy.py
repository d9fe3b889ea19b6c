"""The accuracy table: its samples, its figures, what it leaves out, and that it sees lost digits."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from lossy_factors import stable, stated, textbook
from scipy.spatial.transform import Rotation

from liegen import R3, S2, Product, accuracy, factor, library, native
from liegen.accuracy.conditioning import amplification
from liegen.accuracy.figures import BOUND
from liegen.accuracy.points import ANGLES, COLUMNS, KINDS, draw_points
from liegen.accuracy.variants import variants
from liegen.charts import PRESETS
from liegen.cli import app
from liegen.errors import DefinitionError
from liegen.verify.draws import draw_samples
from liegen.verify.expected import expect
from liegen.verify.run import everything
from liegen.verify.sphere_slack import slack_of

FILE = Path(__file__).parent / "lossy_factors.py"
PI = ANGLES[-1][0]


def columns_of(report, name, block=None):
    """The worst figure of a function, or of one of its blocks, by column."""
    figures = [
        f
        for row in report.rows
        if row.function == name
        for f in row.measured.figures
        if block in (None, f.block)
    ]
    return {
        title: max((x for f in figures if (x := f.worst[k]) is not None), default=None)
        for k, title in enumerate(COLUMNS)
    }


@pytest.mark.parametrize("name", ["prior_so3", "between_so3", "prior_se3", "so3_log", "so3_exp"])
def test_samples_have_the_angle_of_their_column(name):
    points, refused = draw_points(everything()[name], 8, 0)
    assert refused == ()
    assert len(points) == 8 * len(ANGLES)
    seen = set()
    for point in points:
        v = point.sample.values
        if "d" in v:
            angle = np.linalg.norm(v["d"])
        else:
            R = {n: Rotation.from_quat(c[:4]) for n, c in v.items()}
            right = R["x"].inv() * R["y"] if "y" in R else R["x"]
            left = R["z"] if "z" in R else Rotation.identity()
            turn = (left.inv() * right).as_quat(canonical=True)
            angle = 2 * np.arctan2(np.linalg.norm(turn[:3]), turn[3])
            seen.add(bool(v["x"][3] < 0))
        assert angle == pytest.approx(ANGLES[point.column][1], rel=1e-3, abs=3e-15)
    assert seen <= {True, False}
    assert "d" in v or seen == {True, False}


def test_half_turns_are_exact_and_coordinate_axes_occur():
    points, _ = draw_points(library.prior_so3, 12, 0)
    exact = [p.sample.values for p in points if COLUMNS[p.column] == PI and p.sample.case == "axis"]
    assert len(exact) == 3
    for v in exact:
        # the fourth component of z^-1 x
        assert np.dot(v["z"], v["x"]) == 0.0
        assert sorted(map(abs, v["x"])) == [0, 0, 0, 1]
    axes = {tuple(np.abs(v["z"]) + np.abs(v["x"])) for v in exact}
    assert len(axes) == 3


def test_lost_digits_are_flagged_and_a_stable_formula_is_not():
    report = accuracy.accuracy([textbook, stable], preset="gtsam")
    assert not report.passed
    assert {e.function for e in report.excesses if e.block == "res"} == {"textbook"}
    lost = columns_of(report, "textbook", "res")
    # 1 - cos(a) has an error of 1e-16: over a^2
    assert all(lost[title] > BOUND for title in ("1e-6", "1e-5", "1e-4", "1e-3"))
    assert lost["1e-4"] > 1e-10
    assert lost["1"] < BOUND
    assert max(x for x in columns_of(report, "stable", "res").values() if x is not None) < 1e-15


def test_a_wrong_jacobian_is_flagged():
    wrong = library.prior_so3.in_chart("gtsam")
    program = wrong.kernel.jacobians
    res, J = program.results
    swapped = replace(program, results=(res, (J[1], J[0], *J[2:])))
    wrong.__dict__["kernel"] = replace(wrong.kernel, jacobians=swapped)
    report = accuracy.accuracy([wrong], preset="gtsam", samples=1)
    assert {e.block for e in report.excesses} == {"res_D_x"}
    assert {"1e-3", "0.1", "1", "pi-1e-3"} <= {e.column for e in report.excesses}


@pytest.mark.parametrize(
    "name", ["between_so2", "so3_log", "so3_Jr_inv", "prior_s2", "prior_so3", "range_r2"]
)
def test_figures_of_all_presets_are_within_the_bound(name):
    report = accuracy.accuracy([everything()[name]], samples=2)
    assert report.excesses == ()
    assert report.passed
    assert {preset for row in report.rows for preset in row.presets} == set(PRESETS)
    targets = {f.target for row in report.rows for f in row.measured.figures}
    assert targets == ({"C", "NumPy"} if native.find_compiler() else {"NumPy"})
    found = columns_of(report, name)
    angles = [title for title, _ in ANGLES]
    if name == "range_r2":
        assert [t for t, x in found.items() if x is not None] == ["no angle"]
    else:
        missing = [title for title in angles if found[title] is None]
        assert missing == ([PI] if name == "prior_s2" else [])


def test_points_without_a_value_are_listed_with_what_the_code_gives():
    functions = [library.prior_s2, library.range_r3, library.bearing_se3_r3, library.projection_cal3_s2]
    report = accuracy.accuracy(functions, preset="gtsam", samples=1)
    said = {u.where: u.returns for u in report.undefined}
    assert all(u.reason for u in report.undefined)
    assert "res finite" in said["opposite directions on S2"]
    assert "res_D_y 0" in said["a distance of 0"]
    assert said["a bearing to coincident positions"].startswith("res NaN")
    assert "res NaN, " in said["point behind the camera"]
    if native.find_compiler():
        assert said["point behind the camera"].endswith("C status 1")
    left = [x for row in report.rows if row.function == "prior_s2" for x in row.measured.left]
    assert [(x.column, x.why) for x in left] == [(PI, "no digits left")]


def test_presets_that_agree_are_measured_once_and_those_that_do_not_apply_are_named():
    found, remarks = variants([library.prior_so3, library.prior_r3, stated], PRESETS)
    shared = {(v.function.name, v.presets) for v in found}
    assert shared == {
        ("prior_so3", ("gtsam", "gtsam-4.2", "symforce", "sophus", "manif")),
        ("prior_so3", ("ceres",)),
        ("prior_so3", ("g2o",)),
        ("prior_so3", ("ros",)),
        ("prior_r3", tuple(PRESETS)),
        ("stated", tuple(PRESETS)),
    }
    reasons = {r.function: r.reason for r in remarks}
    assert reasons == {
        "prior_r3": "presets make no difference: each of its charts is the only one of its manifold",
        "stated": "the factor states its chart itself",
    }


def test_every_function_of_every_group_has_a_variant_and_presets_that_it_refuses_are_named():
    functions = list(everything().values())
    found, remarks = variants(functions, PRESETS)
    assert {v.function.name for v in found} == {f.name for f in functions}
    mine = {
        name: [v.presets for v in found if v.function.name == name] for name in ("sim3_local", "se23_log")
    }
    assert mine == {name: [("gtsam", "gtsam-4.2")] for name in mine}
    (said,) = [r for r in remarks if r.function == "sim3_local"]
    assert said.presets == tuple(name for name in PRESETS if name not in ("gtsam", "gtsam-4.2"))
    assert said.reason.startswith(
        "Sim3 has no chart 'symforce'; the one that exists is x.retract(d) = x exp(d)"
    )


def test_retract_by_a_quaternion_vector_loses_digits_towards_half_a_turn():
    graph = everything()["so3_retract"].in_chart("g2o").graph
    x = (0.0, 0.0, 0.0, 1.0)
    w = 1e-3
    values = {"x": x, "d": (0.0, np.sqrt(1 - w * w), 0.0)}
    assert amplification(graph, values, "out") == pytest.approx(1 / w, rel=1e-6)
    assert amplification(graph, values, "out_D_d") == pytest.approx(1 / w**2, rel=1e-6)
    assert amplification(graph, {"x": x, "d": (1.0, 0.0, 0.0)}, "out") == np.inf
    plain = everything()["so3_retract"].graph
    assert amplification(plain, values, "out_D_d") == 1.0


class Aimed(Product):
    direction: S2
    position: R3


@factor
def aimed(x: Aimed, *, z: Aimed):
    return z.local(x)


def test_directions_inside_products_count():
    angle = np.pi - 1e-3
    n, m = (1.0, 0.0, 0.0), (np.cos(angle), np.sin(angle), 0.0)
    values = {"x": (*n, 1.0, 2.0, 3.0), "z": (*m, 0.0, 0.0, 0.0)}
    assert slack_of(aimed.graph, values) == pytest.approx(1 / np.sin(angle))
    sphere = {"x": n, "z": m}
    assert slack_of(aimed.graph, values) == pytest.approx(slack_of(library.prior_s2.graph, sphere))
    assert slack_of(library.prior_so3.graph, {"x": (0, 0, 0, 1), "z": (1, 0, 0, 0)}) == 1.0
    expected = expect(aimed, draw_samples(aimed, 24, 0).inside, conditioned=False)
    assert expected.slack.max() > 10


def test_a_loss_is_refused():
    with pytest.raises(DefinitionError, match="has a loss"):
        accuracy.accuracy([library.prior_so2.whitened(None, "huber")])


def run(*words):
    return CliRunner().invoke(app, ["verify", "--accuracy", *words])


def test_command_prints_the_table_and_exits_with_0():
    done = run("-f", "prior_so2", "--samples", "2")
    assert done.exit_code == 0, done.output
    rows = [line.split()[:2] for line in done.output.splitlines()[1:3]]
    assert rows == [["prior_so2", "value"], ["prior_so2", "Jacobian"]]
    assert "bound 1e-14 relative to max(1, s)" in done.output
    assert "there are two logarithms" in done.output


def test_command_exits_with_1_and_names_what_is_beyond():
    done = run(str(FILE), "--chart", "gtsam", "-f", "textbook", "--samples", "1", "--json")
    assert done.exit_code == 1
    content = json.loads(done.output)
    assert not content["passed"]
    assert {e["function"] for e in content["exceeding"]} == {"textbook"}
    assert content["angles"] == list(COLUMNS)
    done = run(str(FILE), "--chart", "gtsam", "-f", "textbook", "--samples", "1")
    assert done.exit_code == 1
    assert "BEYOND: textbook, res" in done.output


def test_wrong_use():
    assert "give both" in CliRunner().invoke(app, ["verify", "--peers"]).output
    assert "without a loss" in run("-f", "prior_so2", "--loss", "huber").output
    unknown = run("-f", "prior_so2", "--chart", "sopus")
    assert unknown.exit_code == 2
    assert "unknown chart 'sopus'; one of gtsam, " in unknown.output


def test_kinds():
    assert KINDS == ("axis", "pose", "random", "negated")
