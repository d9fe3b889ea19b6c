"""Factors on other stored numbers: the same results, verified, generated, explained; normalised arguments."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from liegen import R3, SE2, SE3, SO3, DefinitionError, Layout, factor, function
from liegen.cli import app
from liegen.layouts import LAYOUTS
from liegen.library import between_se2, between_se3, between_so3, prior_s2, projection_cal3_s2, range_se3_r3
from liegen.samples import Draw
from liegen.verify import verify


@function
def composed(x: SE3, y: SE3):
    return x.compose(y)


def drawn(f, seed=0):
    draw = Draw(np.random.default_rng(seed))
    return {p.name: draw.element(p.manifold) for p in f.graph.parameters}


def arrays(f, values):
    """The arguments in the factor's layout."""
    shown = {p.name: (p.storage, values[p.name]) for p in f.graph.parameters}
    return {name: np.array(s.write(v.coords), dtype=float).reshape(s.shape) for name, (s, v) in shown.items()}


def called(f, values):
    given = {p.name: values[p.name] for p in f.graph.parameters if not p.variable}
    return f.jacobians(*(values[p.name] for p in f.graph.parameters if p.variable), **given)


@pytest.mark.parametrize("name", LAYOUTS)
@pytest.mark.parametrize("f", [between_se3, between_se2, range_se3_r3], ids=lambda f: f.name)
def test_jacobians_do_not_depend_on_the_layout(f, name):
    values, other = drawn(f), f.in_layout(name)
    plain = called(f, values)
    for found in (called(other, values), called(other, arrays(other, values))):
        for key, expected in plain.items():
            np.testing.assert_allclose(found[key], expected, atol=1e-13, err_msg=key)


def test_one_argument_in_another_layout():
    @factor(layout={"z": "4x4"})
    def mixed(x: SE3, y: SE3, *, z: SE3):
        return z.local(x.between(y))

    values = drawn(mixed)
    assert [a.shape for a in mixed.kernel.arguments] == [(7,), (7,), (4, 4)]
    np.testing.assert_allclose(
        mixed(values["x"], values["y"], z=values["z"].matrix()).coords,
        between_se3(**values).coords,
        atol=1e-14,
    )
    assert mixed.bind(z=values["z"].matrix()).kernel.arguments[-1].shape == (7,)


def test_an_output_is_in_the_layout_too():
    f = composed.in_layout("4x4")
    values = drawn(f)
    product = values["x"].matrix() @ values["y"].matrix()
    np.testing.assert_allclose(called(f, values)["out"], product, atol=1e-14)
    np.testing.assert_allclose(f(**values).matrix(), product, atol=1e-14)  # typed values stay typed


def test_charts_and_layouts_are_independent():
    f = between_se3.in_chart("ceres")
    assert f.kernel.arguments[0].storage == between_se3.kernel.arguments[0].storage
    both = f.in_layout("ceres")
    assert both.kernel.arguments[0].storage[:4] == ("qw", "qx", "qy", "qz")
    assert both.kernel.jacobians.operations == f.kernel.jacobians.operations
    assert any("chart ceres: stored unit quaternion (w, x, y, z)" in line for line in both.kernel.conventions)


def test_quaternions_cost_nothing_and_a_matrix_only_what_is_used():
    plain = between_se3.kernel.jacobians.operations
    for name in ("wxyz", "manif", "ceres"):
        assert between_se3.in_layout(name).kernel.jacobians.operations == plain
    for f in (projection_cal3_s2, range_se3_r3):  # they turn vectors only, which a matrix does at once
        assert f.in_layout("4x4").kernel.jacobians.operations < f.kernel.jacobians.operations


@pytest.mark.parametrize("name", ["wxyz", "4x4", "matrix-col", "g2o"])
def test_verified(name):
    functions = [f.in_layout(name) for f in (between_so3, between_se2, composed)]
    report = verify(functions, samples=8, workers=1)
    assert report.passed, report.to_json()


def test_a_wrong_reading_is_found(monkeypatch):
    from liegen.layouts import rotations

    monkeypatch.setattr(rotations, "quaternion_of", lambda R: (-R[0][1], -R[0][2], -R[1][2], R[2][2]))
    (found,) = verify([between_so3.in_layout("matrix")], samples=6, workers=1).factors
    assert {c.name for c in found.checks if not c.passed} >= {"value", "Jacobian"}


def test_a_layout_that_is_stated_stays():
    @factor(layout=Layout("wxyz"))
    def stated(x: SO3, *, z: SO3):
        return z.local(x)

    assert stated.in_layout("4x4") is stated
    assert stated.kernel.arguments[0].storage[0] == "qw"
    assert any("Layout(rotation='wxyz')" in line for line in stated.kernel.conventions)


def test_refusals_name_the_factor_and_list_what_exists():
    def f(x: SE3, p: R3, *, z: SE3):
        return z.local(x) * p[0]

    for layout, message in (
        ("drake", r"f: unknown layout 'drake'; one of xyzw, wxyz, matrix, matrix-col, 4x4"),
        ({"x": "drake"}, "layout of 'x': unknown layout 'drake'"),
        ({"y": "wxyz"}, "names no argument; there are x, p, z"),
        ({"p": "wxyz"}, "'p' is R3, which is stored in one way only"),
    ):
        with pytest.raises(DefinitionError, match=message):
            factor(layout=layout)(f)
    with pytest.raises(DefinitionError, match=r"argument 'x': an array of shape \(\.\.\., 4, 4\) is needed"):
        between_se3.in_layout("4x4")(np.zeros(7), np.eye(4), z=np.eye(4))


def stretched(values, by):
    """The same rotations in numbers that are off unit length."""
    found = {}
    for name, v in values.items():
        coords = np.array(v.coords, dtype=float)
        coords[: {7: 4, 4: 2 if isinstance(v, SE2) else 4}[len(coords)]] *= 1 + by
        found[name] = type(v).from_storage(coords)
    return found


@pytest.mark.parametrize("f", [between_se3, between_se2, between_so3], ids=lambda f: f.name)
@pytest.mark.parametrize("by", [1e-8, 1e-3, 0.5])
def test_normalised_arguments_may_be_off_unit_length(f, by):
    values, unit = drawn(f), f.in_layout(None, normalise=True)
    exact, found, raw = called(f, values), *(called(g, stretched(values, by)) for g in (unit, f))
    for name, expected in exact.items():
        np.testing.assert_allclose(found[name], expected, atol=3e-14, err_msg=name)
    assert max(np.abs(raw[n] - exact[n]).max() for n in exact) > by / 2  # and without it they may not


def test_normalising_costs_and_is_stated():
    @factor(normalise=True)
    def unit(x: SO3, *, z: SO3):
        return z.local(x)

    plain = factor(unit.function)
    assert unit.kernel.jacobians.operations - plain.kernel.jacobians.operations <= 2 * 13
    assert any("normalised" in line for line in unit.kernel.conventions)
    assert not any("normalised" in line for line in plain.kernel.conventions)


def test_verify_reports_what_is_off_unit_length():
    report = verify([between_se3, prior_s2, projection_cal3_s2], samples=2, workers=1)
    for f in json.loads(report.to_json())["factors"]:
        small, large = f["off_unit"]
        assert (small["off"], large["off"]) == (1e-8, 1e-3)
        assert 1e-9 < small["as_is"] < 1e-6
        assert 1e-4 < large["as_is"] < 1e-1
        assert max(small["normalised"], large["normalised"]) < 2e-14


def test_command_line(tmp_path):
    run, out = CliRunner().invoke, str(tmp_path / "out")
    done = run(app, ["generate", "-f", "between_se3", "-o", out, "--layout", "4x4", "--normalise"])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "out/liegen_factors/_between_se3.py").read_text()
    assert "--layout 4x4 --normalise" in text
    assert "SE3: stored 4x4 matrix [[R, t], [0, 1]] (layout 4x4)" in text
    assert "x: 4 x 4, SE3 (r00" in text
    assert run(app, ["check", out]).exit_code == 0
    for command in (["generate", "-o", out], ["verify"], ["explain", "between_se3"]):
        done = run(app, [*command, "--layout", "drake"])
        assert done.exit_code == 2
        assert f"--layout: unknown layout 'drake'; one of {', '.join(LAYOUTS)}" in done.output
    done = run(app, ["explain", "between_se3", "--chart", "ceres", "--layout", "ceres"])
    assert "chart ceres: stored unit quaternion (w, x, y, z)" in done.output
    assert "Jr^-1[ceres](z, a)" in done.output
    done = run(app, ["explain", "between_se3", "--chart", "drake"])
    assert done.exit_code == 2
    assert "--chart: unknown chart 'drake'; one of gtsam" in done.output
    done = run(app, ["verify", "-f", "between_so3", "--layout", "wxyz", "--samples", "3"])
    assert done.exit_code == 0, done.output
    assert "off unit length" in done.output
