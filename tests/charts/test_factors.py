"""Factors in charts: columns, rows, per-variable charts, refusals, and the default that changes nothing."""

import casadi as ca
import numpy as np
import pytest
from click.testing import CliRunner

import liegen
from liegen import R6, S2, SE3, SO2, Chart, DefinitionError, factor, function
from liegen.algebra.linear import eye, product
from liegen.charts import PRESETS, form_chart
from liegen.cli import app
from liegen.library import bearing_se3_r3, between_se2, between_se3, between_so3, prior_se3, range_se3_r3
from liegen.samples import CASES, Draw
from liegen.trace import latex
from liegen.verify import verify

SIX = ("between_se3", "prior_se3", "between_so3", "between_se2", "range_se3_r3", "projection_cal3_s2")


def drawn(f, seed=0):
    draw = Draw(np.random.default_rng(seed))
    return {p.name: draw.element(p.manifold) for p in f.graph.parameters}


def numbers(f, values):
    given = {p.name: values[p.name] for p in f.graph.parameters if not p.variable}
    return f.jacobians(*(values[p.name] for p in f.graph.parameters if p.variable), **given)


def column_map(form, preset, x):
    chart = form_chart(form, preset)
    if chart is None:
        return np.eye(form.dim)
    return np.array([[float(e) for e in row] for row in product(chart.columns(x))])


def ad_jacobian(f, name, values):
    """d res(x.retract(d))/dd at 0 with the chart's own retract, by CasADi through the whole program."""
    p = next(p for p in f.graph.parameters if p.name == name)
    form = p.manifold.form
    retract = (form_chart(form, p.chart) or form).retract
    d = ca.SX.sym("d", form.dim)
    inputs = {k: tuple(ca.SX(float(c)) for c in v.coords) for k, v in values.items()}
    inputs[name] = tuple(retract(inputs[name], tuple(d[i] for i in range(form.dim))))
    known = {id(q.node): inputs[q.name] for q in f.graph.parameters}
    for node in f.graph.nodes():
        if id(node) not in known:
            known[id(node)] = node.operation.value(*(known[id(n)] for n in node.operands))
    ((_, output),) = f.graph.outputs
    J = ca.jacobian(ca.vertcat(*known[id(output)]), d)
    return np.array(ca.Function("J", [d], [J])(np.zeros(form.dim)))


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("f", [between_se3, between_so3, between_se2, bearing_se3_r3], ids=lambda f: f.name)
def test_jacobians_are_those_of_the_charts_retract_and_local(f, name):
    f = f.in_chart(name)
    values = drawn(f)
    found = numbers(f, values)
    for p in f.graph.parameters:
        if p.variable:
            expected = ad_jacobian(f, p.name, values)
            scale = max(1, np.abs(expected).max())
            np.testing.assert_allclose(found[f"res_D_{p.name}"], expected, atol=1e-13 * scale)


@pytest.mark.parametrize("name", ["symforce", "sophus", "ceres", "g2o", "ros"])
def test_columns_are_j_m(name):
    values = drawn(range_se3_r3)
    plain, moved = numbers(range_se3_r3, values), numbers(range_se3_r3.in_chart(name), values)
    M = column_map(SE3.form, PRESETS[name], values["x"].coords)
    np.testing.assert_allclose(moved["res_D_x"], plain["res_D_x"] @ M, atol=1e-14)
    assert np.abs(moved["res_D_x"] - plain["res_D_x"]).max() > 1e-2
    np.testing.assert_array_equal(moved["res"], plain["res"])


def test_one_variable_in_another_chart():
    @factor(chart={"x": "ceres"})
    def mixed(x: SE3, y: SE3, *, z: SE3):
        return z.local(x.between(y))

    values = drawn(between_se3)
    plain, found = numbers(between_se3, values), numbers(mixed, values)
    M = column_map(SE3.form, PRESETS["ceres"], values["x"].coords)
    np.testing.assert_allclose(found["res_D_x"], plain["res_D_x"] @ M, atol=1e-14)
    np.testing.assert_array_equal(found["res"], plain["res"])
    np.testing.assert_array_equal(found["res_D_y"], plain["res_D_y"])
    assert mixed.fix("x").kernel.jacobians.operations < mixed.kernel.jacobians.operations
    assert mixed.kernel.jacobian_formulas[-2].endswith("Chart(x)")
    assert "Chart" not in mixed.kernel.jacobian_formulas[-1]


def test_exp_and_log_do_not_follow_the_chart():
    @factor
    def by_log(x: SE3, *, z: SE3):
        return z.between(x).log()

    values = drawn(by_log)
    plain = numbers(by_log, values)["res"]
    for name in ("ceres", "g2o"):
        # to rounding: sums are put in the order in which the Jacobian can share them
        np.testing.assert_allclose(numbers(by_log.in_chart(name), values)["res"], plain, rtol=1e-14)
        assert np.abs(numbers(prior_se3.in_chart(name), values)["res"] - plain).max() > 1e-2


@pytest.mark.parametrize("name", ["symforce", "sophus", "ceres", "g2o", "ros"])
def test_rows_of_an_output_on_a_group_are_in_the_chart(name):
    @function
    def moved(x: SE3, *, z: SE3):
        return x.compose(z)

    values = drawn(moved)
    plain, found = numbers(moved, values), numbers(moved.in_chart(name), values)
    x, y = values["x"], values["x"].compose(values["z"])
    Mx, My = (column_map(SE3.form, PRESETS[name], v.coords) for v in (x, y))
    np.testing.assert_allclose(found["out_D_x"], np.linalg.inv(My) @ plain["out_D_x"] @ Mx, atol=1e-13)


def test_a_chart_of_ones_own():
    own = Chart(side="left", translation="body", order="translation-first")
    f = between_se3.in_chart(own)
    values = drawn(f)
    np.testing.assert_allclose(numbers(f, values)["res_D_y"], ad_jacobian(f, "y", values), atol=1e-12)
    assert any("Chart(side='left', translation='body'" in line for line in f.kernel.conventions)


def test_translation_in_the_body_has_the_identity_as_column_map():
    body = Chart(translation="body")  # GTSAM 4.2 without GTSAM_POSE3_EXPMAP
    x = drawn(prior_se3)["x"].coords
    preset = prior_se3.in_chart(body).graph.chart
    np.testing.assert_array_equal(column_map(SE3.form, preset, x), np.eye(6))
    d = (0.1, -0.2, 0.3, 1.0, 2.0, 3.0)
    moved, start = form_chart(SE3.form, preset).retract(x, d), SE3.from_storage(x)
    shift = start.rotation.matrix() @ d[3:]
    np.testing.assert_allclose(moved[4:], np.asarray(start)[4:] + shift, atol=1e-14)  # t' = t + R v
    values = drawn(between_se3)
    found = numbers(between_se3.in_chart(body), values)
    np.testing.assert_allclose(
        found["res_D_x"], ad_jacobian(between_se3.in_chart(body), "x", values), atol=1e-12
    )


def test_jacobians_of_a_chart_have_names():
    kernel = between_se3.in_chart("ceres").kernel
    assert kernel.jacobian_formulas[-1] == "res_D_y = Jr^-1[ceres](z, a) Chart(y)"
    own = between_se3.in_chart(Chart(side="left")).kernel
    assert own.jacobian_formulas[-2] == "res_D_x = -Jr^-1[chart](z, a) Ad(a^-1) Chart(x)"

    @factor(chart="g2o")
    def moved(x: SE3, d: R6, *, z: SE3):
        return z.local(x.retract(d))

    lines = moved.kernel.jacobian_formulas
    assert lines[-2] == "res_D_x = Jr^-1[g2o](z, a) Ad[g2o](x, d) Chart(x)"
    assert lines[-1] == "res_D_d = Jr^-1[g2o](z, a) Jr[g2o](x, d)"
    assert r"J_{r,\,\text{g2o}}^{-1}\left(" in latex(moved.graph)


def test_the_default_is_gtsam_and_costs_nothing():
    kernel, same = between_se3.kernel, between_se3.in_chart("gtsam").kernel
    assert same.jacobians.digest() == kernel.jacobians.digest()
    assert (same.conventions, same.jacobian_formulas) == (kernel.conventions, kernel.jacobian_formulas)
    assert between_se3.in_chart("sophus").kernel.jacobians.operations == kernel.jacobians.operations


def test_a_factor_that_states_its_chart_keeps_it():
    @factor(chart="sophus")
    def stated(x: SE3, *, z: SE3):
        return z.local(x)

    assert stated.in_chart("g2o") is stated
    with pytest.raises(DefinitionError, match="chart sophus, but is called in a factor in the chart gtsam"):

        @factor
        def outer(x: SE3, *, z: SE3):
            return stated(x, z=z)


def test_refusals_name_the_factor_and_list_what_exists():
    def f(x: SE3, n: S2, *, z: SE3, m: S2):
        return liegen.stack(z.local(x), m.local(n))

    def planar(x: SO2, *, z: SO2):
        return z.local(x)

    for g, chart, message in (
        (f, "drake", r"f: unknown chart 'drake'; one of gtsam, gtsam-4\.2, symforce, sophus, manif"),
        (f, {"x": "drake"}, "chart of 'x': unknown chart 'drake'; one of gtsam"),
        (f, {"z": "sophus"}, "names no variable; there are x, n"),
        (f, {"n": "sophus"}, "'n' is S2, which has only its own chart"),
        (planar, Chart(rotation="cayley"), "planar: SO2 has no chart with rotation='cayley'"),
        (f, Chart(rotation="cayley"), "SE3 has no coupled chart with rotation='cayley'"),
    ):
        with pytest.raises(DefinitionError, match=message):
            factor(chart=chart)(g)


def test_command_line(tmp_path):
    out = tmp_path / "out"
    run = CliRunner().invoke
    done = run(app, ["generate", "-f", "between_se3", "-o", str(out), "--chart", "g2o"])
    assert done.exit_code == 0, done.output
    text = (out / "liegen_factors" / "_between_se3.py").read_text()
    assert "--chart g2o" in text
    assert "SE3, chart g2o: stored quaternion" in text
    assert run(app, ["check", str(out)]).exit_code == 0
    for command in (["generate", "-o", str(out)], ["verify"]):
        done = run(app, [*command, "--chart", "drake"])
        assert done.exit_code == 2
        assert f"unknown chart 'drake'; one of {', '.join(PRESETS)}" in done.output
    done = run(app, ["verify", "-f", "between_so3", "--chart", "ceres", "--samples", "3"])
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize("name", PRESETS)
def test_verified_in_every_preset(name):
    from liegen import library

    functions = [getattr(library, n).in_chart(name) for n in SIX]
    report = verify(functions, samples=len(CASES) // 4, workers=1)
    assert report.passed, report.to_json()


def test_a_wrong_column_map_is_found(monkeypatch):
    from liegen.charts.poses import SplitChart

    monkeypatch.setattr(SplitChart, "columns", lambda self, x: (self.to_own(eye(3), eye(3)),))
    report = verify([prior_se3.in_chart("ceres")], samples=6, workers=1)
    assert {c.name for c in report.factors[0].checks if not c.passed} >= {"Jacobian", "differences", "Taylor"}


def test_frames_say_where_the_chart_has_other_axes():
    @factor(chart="symforce")
    def framed(T_WB: SE3, *, z_WB: SE3):
        return z_WB.local(T_WB)

    assert any("chart symforce: columns of T_WB" in line for line in framed.kernel.frames)


ONE_CHART = [liegen.Sim2, liegen.Sim3, liegen.SE23, liegen.NavState, liegen.Gal3]


@pytest.mark.parametrize("G", ONE_CHART, ids=lambda G: G.__name__)
@pytest.mark.parametrize("name", PRESETS)
def test_similarities_and_extended_poses_have_their_own_chart_and_refuse_the_others(G, name):
    def prior_of(x, *, z):
        return z.local(x)

    prior_of.__annotations__ = {"x": G, "z": G}
    f = factor(prior_of)
    same = ("gtsam",) if G is liegen.Sim2 else ("gtsam", "gtsam-4.2")
    if name in same:
        values = drawn(f)
        charted = numbers(f.in_chart(name), values)["res_D_x"]
        np.testing.assert_array_equal(numbers(f, values)["res_D_x"], charted)
        return
    with pytest.raises(
        DefinitionError, match=f"{G.__name__} has no chart '{name}'; the one that exists is .* 'gtsam'"
    ):
        _ = f.in_chart(name).graph
