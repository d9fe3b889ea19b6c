"""Samples are solved for the singular points of a formula's own operations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from naive_formulas import NAIVE
from sound_formulas import SOUND

import liegen
from liegen import R1, R3, SE3, SO3, DefinitionError, atan2, dot, factor, norm, singular, sqrt
from liegen.explain import explanation
from liegen.verify import verify
from liegen.verify.backends import programs
from liegen.verify.draws import draw_samples
from liegen.verify.singular import singular_points
from liegen.verify.singular.candidates import solve


def checked(function):
    return singular_points(function, draw_samples(function, 8, 0), programs(function.kernel))


def line_of(function, text):
    """The line of a function's file that holds a text, the first after its ``def``."""
    code = function.function.__code__
    lines = Path(code.co_filename).read_text(encoding="utf-8").splitlines()
    start = code.co_firstlineno
    return next(k + 1 for k in range(start + 2, len(lines)) if text in lines[k])


#: A part of the line at which the operation is written.
WRITTEN = {
    "root": "sqrt(", "azimuth": "atan2(", "angle_over_radius": "/ r", "pixel": "/ q[2]", "behind": "/ q[2]",
    "unit_vector": "/ norm(d)", "between_directions": "acos(", "elevation": "asin(", "pitch": "asin(",
    "yaw": "atan2(", "trace_angle": "acos(", "log_range": "log(", "log_of_given": "log(", "power": "log(",
    "square_of_square": "sqrt(", "inverse_square": "x / dot", "sum_of_lengths": "sqrt(", "polar": "atan2(",
    "rotation_axis": "/ norm(w)", "rotation_angle": "sqrt(", "half_tangent": "/ (norm", "projected": "/ q[2]",
    "ratio_of_sines": "/ x", "through_a_product": "sqrt(", "either_arm": "sqrt(",
}  # fmt: skip


@pytest.mark.parametrize("name", NAIVE)
def test_naive_formulas_fail_with_the_line_and_the_cure(name):
    check = checked(NAIVE[name])
    assert not check.passed
    for part in NAIVE[name].doc.split(" | "):
        assert part in check.note
    if name in WRITTEN:
        assert f"naive_formulas.py:{line_of(NAIVE[name], WRITTEN[name])}: " in check.note
    assert 'singular("...")' in check.note


def test_in_a_function_that_is_called_it_is_that_functions_line():
    check = checked(NAIVE["in_a_helper"])
    (helper,) = [n.site for n in NAIVE["in_a_helper"].plain.nodes() if n.operation.name == "sqrt"]
    assert check.note.startswith(f"{helper}: sqrt(")


#: Those that have results at their singular points.
REACHED = {"root", "geodesic", "scaled_local", "huber", "guarded", "in_a_helper", "between_directions"}


@pytest.mark.parametrize("name", SOUND)
def test_formulas_that_are_written_well_pass(name):
    check = checked(SOUND[name])
    assert check.passed, check.note
    if name in REACHED:
        assert check.kept


@pytest.mark.parametrize("name", ["declared_here", "declared_everywhere"])
def test_what_is_declared_is_left_out_and_listed(name):
    check = checked(SOUND[name])
    assert len(check.skipped) == 1
    assert check.skipped[0].startswith("where T.transform_to(p)[1] and T.transform_to(p)[0] are 0, sound_")
    assert check.skipped[0].endswith("declared singular: point on the axis")
    assert "declared singular: point on the axis (sound_formulas.py:" in check.note


def test_documented_holes_are_left_out_and_listed():
    assert any("the vector 0 has no direction" in s for s in checked(SOUND["plane_bearing"]).skipped)
    skipped = checked(SOUND["direction_of_pose"]).skipped
    assert any("opposite directions have no Jacobian" in s for s in skipped)


def test_a_declaration_of_another_point_does_not_help():
    @factor
    def azimuth(T: SE3, p: R3, *, z: R1):
        d = T.transform_to(p)
        singular("point one metre up", d[2] - 1)
        return atan2(d[1], d[0]) - z

    assert "atan2(a[1], a[0])" in checked(azimuth).note


def test_points_are_hit_exactly_by_every_argument_and_in_pairs():
    hits, _ = solve(SOUND["root"], draw_samples(SOUND["root"], 8, 0).inside)
    exact = [h for h in hits if h.values["T"][4:] == h.values["p"]]
    assert len({h.values["T"] for h in exact}) > 1
    assert len({h.values["p"] for h in exact}) > 1
    pairs = solve(NAIVE["sum_of_lengths"], draw_samples(NAIVE["sum_of_lengths"], 8, 0).inside)[0]
    assert any(h.values["x"] == (0.0, 0.0) == h.values["y"] for h in pairs)


def test_a_finite_derivative_that_is_wrong_is_seen():
    """The program's derivative at the point is replaced; away from it nothing changes."""

    @factor
    def square(x: R3, *, z: R1):
        return norm(x) * norm(x) - z

    good = programs(square.kernel)

    def wrong(arguments):
        results = dict(good[0].evaluate(arguments))
        at = np.abs(arguments["x"]).max(axis=1) == 0
        results["res_D_x"] = np.where(at[:, None, None], 1.0, results["res_D_x"])
        return results

    bad = type(good[0])("program", True, wrong)
    drawn = draw_samples(square, 8, 0)
    assert singular_points(square, drawn, good).passed
    check = singular_points(square, drawn, (bad,))
    assert not check.passed
    assert "res_D_x of program is finite and wrong" in check.note


def test_verify_holds_it_in_every_back_end_and_passes_the_cure():
    report = verify([NAIVE["root"], SOUND["root_apart"]], samples=6, workers=1)
    naive, sound = report.factors
    assert [c.name for c in naive.checks if not c.passed] == ["singular points"]
    assert sound.passed


def test_generated_code_does_not_depend_on_the_declaration():
    kernels = [SOUND[name].kernel for name in ("declared_here", "declared_everywhere")]
    assert kernels[0].jacobians.code == kernels[1].jacobians.code


def test_explain_prints_declared_points():
    text = explanation(SOUND["declared_here"])
    assert "Singular points:\n  point on the axis, where norm(" in text
    assert "Singular points:\n  point on the axis\n" in explanation(SOUND["declared_everywhere"])


def test_a_declaration_follows_the_chart():
    there = liegen.factor(chart="sophus")

    @there
    def turned(x: SO3, y: SO3, *, z: R1):
        w = x.local(y)
        singular("no rotation", w)
        return sqrt(dot(w, w)) - z

    assert checked(turned).passed


def test_a_declaration_needs_a_text():
    with pytest.raises(DefinitionError, match=r'test_singular.py:\d+: singular needs a text.*singular\("'):
        singular(norm([1.0, 0.0]))  # type: ignore[arg-type]
