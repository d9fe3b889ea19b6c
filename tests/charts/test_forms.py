"""Each preset against its definition, its blocks and column map against AD of its own retract and local."""

from dataclasses import replace
from itertools import product

import casadi as ca
import numpy as np
import preset_definitions as definitions
import pytest

from liegen.algebra.linear import product as multiplied
from liegen.charts import PRESETS, Chart, Preset, form_chart, preset
from liegen.errors import DefinitionError
from liegen.manifolds import R3, S2, SE2, SE3, SO2, SO3, Cal3_S2

GROUPS = {"SO3": SO3, "SE3": SE3, "SE2": SE2, "SO2": SO2}
#: Everything that a Chart can say of a rotation and a pose, apart from a coupled translation without exp.
EVERY = [
    Chart(*choice)
    for choice in product(("right", "left"), ("exp", "cayley", "quaternion-vector"), (1, 2),
                          ("coupled", "body", "world"), ("rotation-first", "translation-first"))
    if choice[1] == "exp" or choice[3] != "coupled"
]  # fmt: skip


def random_coords(G, seed, size=2.0):
    g = np.random.default_rng(seed)
    n = {"SO3": 4, "SE3": 4, "SE2": 2, "SO2": 2}[G.form.name]
    q = g.normal(size=n)
    return np.array([*(q / np.linalg.norm(q)), *(g.normal(size=G.form.size - n) * size)])


def steps(G, seed):
    return np.random.default_rng(seed).uniform(-0.5, 0.5, G.form.dim)


class OwnChart:
    """The manifold's own chart with the same interface."""

    def __init__(self, form):
        self.form = form
        self.retract, self.local = form.retract, form.local


def chart_of(G, p):
    return form_chart(G.form, p) or OwnChart(G.form)


def matrix(G, coords):
    return np.array(G.form.matrix(coords), dtype=float)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("group", ["SO3", "SE3", "SE2"])
def test_retract_is_the_librarys(group, name):
    G = GROUPS[group]
    x, d = random_coords(G, 1), steps(G, 2)
    n = {"SO3": 3, "SE3": 3, "SE2": 2}[group]
    X = matrix(G, x)
    parts = (X,) if group == "SO3" else (X[:n, :n], X[:n, n])
    expected = getattr(definitions, group)[name](*parts, d)
    found = chart_of(G, PRESETS[name]).retract(x, d)
    np.testing.assert_allclose(matrix(G, found), expected, atol=3e-15)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("group", ["SO3", "SE3", "SE2", "SO2"])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["q", "-q"])
def test_local_inverts_retract(group, name, side):
    G = GROUPS[group]
    x, d = random_coords(G, 3), steps(G, 4)
    chart = chart_of(G, PRESETS[name])
    y = np.array(chart.retract(x, d), dtype=float)
    y[:4] *= side if group in ("SO3", "SE3") else 1.0
    np.testing.assert_allclose(np.array(chart.local(x, y), float), d, atol=5e-15)


def function(f, *sizes):
    """f of vectors, and its derivative by the last, as numbers."""
    s = [ca.SX.sym(f"s{k}", n) for k, n in enumerate(sizes)]
    value = ca.vertcat(*f(*[tuple(v.nz[i] for i in range(v.numel())) for v in s]))
    J = ca.Function("J", s, [ca.jacobian(value, s[-1])])
    return lambda *v: np.array(J(*v))


def numbers(chain, rows):
    return np.array([[float(x) for x in row] for row in multiplied(chain)]).reshape(rows, -1)


def charts(G):
    rotation = G.form.name in ("SO2", "SE2")
    for c in EVERY:
        if rotation and c.rotation != "exp":
            continue
        chart = form_chart(G.form, Preset("", c, c))
        if chart is not None:
            yield chart


@pytest.mark.parametrize("group", GROUPS)
def test_column_map_is_the_derivative_of_the_charts_own_retract(group):
    G = GROUPS[group]
    x, n, seen = random_coords(G, 5), G.form.dim, 0
    for chart in charts(G):
        slope = function(lambda x, d, c=chart: c.form.log(c.form.between(x, c.retract(x, d))), G.form.size, n)
        M = numbers(chart.columns(tuple(x)), n)
        np.testing.assert_allclose(M, slope(x, np.zeros(n)), atol=1e-14, err_msg=str(chart.chart))
        np.testing.assert_allclose(numbers(chart.rows(tuple(x)), n) @ M, np.eye(n), atol=1e-14)
        seen += 1
    assert seen >= (1 if group == "SO2" else 6)


@pytest.mark.parametrize("group", GROUPS)
def test_blocks_are_the_derivatives_of_local_and_retract(group):
    """By right exponential perturbations, differentiated by CasADi through the values."""
    G = GROUPS[group]
    form, n, size = G.form, G.form.dim, G.form.size
    x, y, d = random_coords(G, 6), random_coords(G, 7), steps(G, 8)
    zero = np.zeros(n)
    for chart in charts(G):
        blocks = [numbers(b, n) for b in chart.local_blocks()(chart.local(x, y), x, y)]
        by_x = function(lambda x, y, e, c=chart: c.local(form.retract(x, e), y), size, size, n)
        by_y = function(lambda x, y, e, c=chart: c.local(x, form.retract(y, e)), size, size, n)
        for block, slope in zip(blocks, (by_x, by_y), strict=True):
            expected = slope(x, y, zero)
            scale = max(1.0, np.abs(expected).max())
            np.testing.assert_allclose(block, expected, atol=2e-13 * scale, err_msg=str(chart.chart))
        z = np.array(chart.retract(x, d), float)
        by_x, by_d = [numbers(b, n) for b in chart.retract_blocks()(z, x, d)]
        moved = function(
            lambda z, x, d, e, c=chart: form.local(z, c.retract(form.retract(x, e), d)), size, size, n, n
        )
        stepped = function(lambda z, x, d, c=chart: form.local(z, c.retract(x, d)), size, size, n)
        np.testing.assert_allclose(by_x, moved(z, x, d, zero), atol=1e-13, err_msg=str(chart.chart))
        np.testing.assert_allclose(by_d, stepped(z, x, d), atol=1e-13, err_msg=str(chart.chart))


def test_other_manifolds_keep_their_chart():
    for manifold, p in product((R3, S2, Cal3_S2), PRESETS.values()):
        assert form_chart(manifold.form, p) is None
    for manifold in GROUPS.values():
        assert form_chart(manifold.form, PRESETS["gtsam"]) is None
    assert form_chart(SE2.form, PRESETS["sophus"]) is None
    assert form_chart(SE3.form, PRESETS["sophus"]) is not None


def test_unknown_choices_list_those_that_exist():
    with pytest.raises(DefinitionError, match=r"unknown chart 'drake'; one of gtsam, gtsam-4\.2, symforce"):
        preset("drake", "here")
    with pytest.raises(DefinitionError, match=r"test_forms\.py:\d+: .*side is one of 'right', 'left'"):
        Chart(side="up")
    for G, chart, cure in (
        (SO2, Chart(rotation="cayley"), "its rotation maps are: 'exp'"),
        (SE3, Chart(rotation="cayley"), "those with translation='body' and translation='world' exist"),
    ):
        with pytest.raises(DefinitionError, match=cure):
            form_chart(G.form, preset(chart, ""))


@pytest.mark.parametrize("w", [0.0, -0.0])
def test_at_half_a_turn_the_quaternion_keeps_its_sign(w):
    """Both (v, 0) and (-v, 0) are the rotation; what is stored decides, whatever the sign of its zero."""
    chart = chart_of(SO3, PRESETS["g2o"])
    for v in ((0.6, 0.0, -0.8), (-0.6, 0.0, 0.8)):
        np.testing.assert_array_equal(chart.local((0.0, 0.0, 0.0, 1.0), (*v, w)), v)


@pytest.mark.parametrize("chart", [c for c in EVERY if c.scale == 2 and c.rotation == "exp"], ids=str)
@pytest.mark.parametrize("name", ["SO3", "SE3"])
def test_a_scale_of_2_takes_half_of_the_rotations_coordinates(name, chart):
    G = GROUPS[name]
    whole = chart_of(G, preset(replace(chart, scale=1), ""))
    half = chart_of(G, preset(chart, ""))
    x, y = random_coords(G, 1), random_coords(G, 2)
    turned = slice(0, 3) if chart.order == "rotation-first" or name == "SO3" else slice(3, 6)
    expected = np.array(whole.local(x, y), dtype=float)
    expected[turned] /= 2
    np.testing.assert_allclose(np.array(half.local(x, y), dtype=float), expected, atol=1e-14)
