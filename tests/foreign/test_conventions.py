"""Functions that are right in a declared chart and layout: no alarm there, elsewhere the chart is named."""

import itertools

import numpy as np
import pytest

from liegen import Chart, library
from liegen.errors import LiegenError
from liegen.foreign import compare
from liegen.foreign.calls import Foreign

CHARTS = (
    "gtsam", "gtsam-4.2", "symforce", "sophus", "manif", "ceres", "g2o", "ros", Chart(side="left"),
    Chart(scale=2, translation="body"), Chart(rotation="cayley", translation="body"),
    Chart(side="left", translation="body", order="translation-first"),
)  # fmt: skip
LAYOUTS = ("xyzw", "wxyz", "matrix", "4x4", "ros")
FACTORS = (
    library.between_se3, library.between_so3, library.between_se2, library.prior_se3, library.range_se3_r3,
    library.bearing_se3_r3,
)  # fmt: skip


def as_foreign(function):
    variables = [p.name for p in function.graph.variables]
    names = [p.name for p in function.graph.parameters]

    def call(arguments):
        values = dict(zip(names, arguments, strict=True))
        given = {n: v for n, v in values.items() if n not in variables}
        return tuple(function.jacobians(*(values[n] for n in variables), **given).values())

    return Foreign(call)


def declared(function):
    """The function in every chart and layout that it has."""
    for chart, layout in itertools.product(CHARTS, LAYOUTS):
        try:
            other = function.in_chart(chart).in_layout(layout)
            other.kernel  # noqa: B018
        except LiegenError:
            continue
        yield chart, layout, other


@pytest.mark.slow
@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_no_false_alarm_in_a_declared_convention(function):
    checked = [compare(other, as_foreign(other), samples=8) for _, _, other in declared(function)]
    assert [c.findings for c in checked if not c.passed] == []
    assert len(checked) >= 40


@pytest.mark.parametrize("chart", CHARTS, ids=str)
@pytest.mark.parametrize("function", [library.prior_se3, library.between_so3], ids=lambda f: f.name)
def test_the_chart_is_named_where_it_is_not_declared(function, chart):
    try:
        other = function.in_chart(chart)
    except LiegenError as error:
        pytest.fail(str(error))
    found = compare(function, as_foreign(other), samples=8)
    if found.passed:  # the chart is GTSAM's for this manifold
        np.testing.assert_allclose(_at_one_point(other), _at_one_point(function), rtol=1e-9)
        return
    assert found.convention.startswith("the chart ")
    if found.options:  # --chart NAME
        name = found.options.split()[-1]
        assert compare(function.in_chart(name), as_foreign(other), samples=8).passed


def _at_one_point(function):
    points = [[0.5, 0.5, -0.5, 0.5, 1, 2, 3], [0.1, 0.7, 0.1, 0.7, -1, 0, 2], [0.1, -0.7, 0.7, 0.1, 0, 1, 1]]
    arguments = [
        np.array(p[: x.storage.size]) for p, x in zip(points, function.graph.parameters, strict=False)
    ]
    return np.concatenate([np.ravel(a) for a in as_foreign(function).call(arguments)])


def test_chart_and_layout_together():
    other = library.prior_se3.in_chart("ros").in_layout("wxyz")
    found = compare(library.prior_se3, as_foreign(other), samples=8)
    assert (found.convention, found.options) == (
        "the chart ros and the layout wxyz", "--chart ros --layout wxyz",
    )  # fmt: skip


def test_ambient_jacobians_are_recognised():
    """By the stored numbers (the derivative of the formula on quaternions), and [J 0]."""
    prior = library.prior_so3

    def ambient(arguments):
        x, z = arguments
        J = prior.jacobians(x, z=z)
        x, y, z, w = x
        plus = 0.5 * np.array([[w, -z, y], [z, w, -x], [-y, x, w], [-x, -y, -z]])
        return J["res"], J["res_D_x"] @ np.linalg.pinv(plus)

    def padded(arguments):
        J = prior.jacobians(arguments[0], z=arguments[1])
        return J["res"], np.hstack([J["res_D_x"], np.zeros((3, 1))])

    res, by_x = compare(prior, Foreign(ambient)).findings
    assert res.correct
    assert "it is by the 4 stored numbers of x (ambient, as J * MinusJacobian)" in by_x.verdict
    res, by_x = compare(prior, Foreign(padded)).findings
    assert "[J 0], the Jacobian by the 3 tangent coordinates and 1 of zeros" in by_x.verdict
