"""Names and numbers in LaTeX."""

import pytest

from liegen import R3, SO3, NavState, factor
from liegen.trace import latex
from liegen.trace.latex_names import latex_name, latex_number, spelled


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("T_WB", "T_{WB}"), ("T_WBi", "T_{WBi}"), ("T_WB1", "T_{WB1}"), ("x1", "x_{1}"), ("p_W", "p_{W}"),
        ("rho", r"\rho"), ("lambda_", r"\lambda"), ("Omega_next", r"\Omega_{\mathrm{next}}"),
        ("T_World_Cam", r"T_{\mathrm{World}\,\mathrm{Cam}}"), ("gyro", r"\mathrm{gyro}"),
        ("sigma_theta", r"\sigma_{\theta}"), ("gyro2_bias", r"\mathrm{gyro}_{2\,\mathrm{bias}}"),
        ("_", r"\mathrm{\_}"), ("__x", "x"),
    ],
)  # fmt: skip
def test_names(name, expected):
    assert latex_name(name) == expected


def test_names_that_would_look_alike_stay_apart():
    assert spelled(["x1", "x_1", "x__1"]) == {
        "x1": "x_{1}",
        "x_1": r"\mathrm{x\_1}",
        "x__1": r"\mathrm{x\_\_1}",
    }
    assert spelled(["r", "res"]) == {"r": "r", "res": r"\mathrm{res}"}


@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.0, "2"), (-9.81, "-9.81"), (2.5e-7, r"2.5 \cdot 10^{-7}"), (1e300, r"1 \cdot 10^{300}")],
)
def test_numbers(value, expected):
    assert latex_number(value) == expected


def test_operations_are_called_as_they_are_written():
    @factor
    def flight(R: SO3, p: R3, v: R3, *, z: NavState):
        return z.local(NavState(R, p, v))

    text = latex(flight.graph)
    assert r"\mathrm{NavState}\left(R,\, p,\, v\right)" in text
    assert r"\_" not in text
