"""One function, five scalar types: floats, arrays, SX, mpmath numbers and SymPy expressions."""

import subprocess
import sys

import casadi as ca
import coefficient_reference as ref
import numpy as np
import pytest
import sympy as sp

from liegen.coefficients import inverse_jacobian, log_factor, stumpff, tables

SWITCHES = ref.around(2.0**-60, 2.0**-58, tables.STUMPFF3_END, tables.STUMPFF5_END, tables.INVERSE_END)
S = np.concatenate([ref.TINY, SWITCHES, np.linspace(0.01, 6, 200) ** 2, [1e6, 1e12]])
FUNCTIONS = {
    "stumpff 1": (lambda s: stumpff(s, 1), S),
    "stumpff 3": (lambda s: stumpff(s, 3), S),
    "stumpff 5": (lambda s: stumpff(s, 5), S),
    "log_factor": (lambda w: (log_factor(w),), np.linspace(0, 1, 101)),
    "inverse_jacobian": (inverse_jacobian, S[S < 10]),
    "inverse_jacobian anywhere": (lambda s: inverse_jacobian(s, principal=False), S),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_float_array_and_sx_agree(name):
    function, points = FUNCTIONS[name]
    array = np.array(function(points))
    with np.errstate(all="raise", under="ignore"):
        floats = np.array([[float(v) for v in function(float(x))] for x in points]).T
    symbol = ca.SX.sym("s")
    compiled = ca.Function("f", [symbol], [ca.vertcat(*function(symbol))])
    symbolic = np.array([np.array(compiled(x)).ravel() for x in points]).T
    # NumPy's sin of an array may differ from that of a number in the last digit, which c_1 shows near pi.
    np.testing.assert_allclose(floats, array, rtol=2e-15, atol=4e-16)
    np.testing.assert_allclose(symbolic, array, rtol=2e-15, atol=4e-16)
    assert np.all(np.isfinite(array))


@pytest.mark.parametrize("x", [*ref.TINY, 0.3, float(tables.STUMPFF3_END), 9.8, 39.0])
@pytest.mark.parametrize("digits", [15, 50])
def test_mpmath_is_right_to_the_working_precision(x, digits):
    with ref.mp.workdps(digits):
        ours = (*stumpff(ref.exact(x), 5), *inverse_jacobian(ref.exact(x)))
    for value, exact in zip(ours, (*(ref.c(k, x) for k in range(6)), ref.d(x), ref.e(x)), strict=True):
        assert abs(value - exact) <= abs(exact) * ref.mp.mpf(10) ** (1 - digits)


@pytest.mark.parametrize("w", [0.0, 0.5, 1 - 2.0**-53, 1.0, 1 + 2.0**-52])
def test_mpmath_log_factor(w):
    with ref.mp.workdps(50):
        value = log_factor(ref.exact(w))
    assert abs(value - ref.log_factor(w)) <= ref.mp.mpf(10) ** -49


def test_mpmath_at_the_neighbour_of_a_limit():
    with ref.mp.workdps(50):
        below = 1 - ref.mp.mpf(2) ** -150
        assert abs(log_factor(below) - 2) < ref.mp.mpf(10) ** -44
        assert log_factor(below) > 2


def test_values_at_zero_are_exact_rationals():
    assert stumpff(sp.Integer(0), 5) == tuple(1 / sp.factorial(k) for k in range(6))
    assert inverse_jacobian(sp.Integer(0)) == (sp.Rational(1, 12), sp.Rational(1, 360))
    assert log_factor(sp.Integer(1)) == 2
    assert [float(v) for v in stumpff(0.0, 5)] == [1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120]
    assert [float(v) for v in inverse_jacobian(0.0)] == [1 / 12, 1 / 360]


def test_sympy_identities():
    s = sp.Symbol("x", positive=True)
    c = stumpff(s, 5)
    for k in range(4):
        assert sp.simplify(c[k] - (1 / sp.factorial(k) - s * c[k + 2])) == 0
        assert sp.simplify(sp.diff(c[k], s) - (k * c[k + 2] - c[k + 1]) / 2) == 0
    d, e = inverse_jacobian(s)
    assert sp.simplify(e - 2 * sp.diff(d, s)) == 0
    assert sp.simplify(d - (1 - sp.sqrt(s) / 2 * sp.cot(sp.sqrt(s) / 2)) / s) == 0


def test_gradients_of_sx_are_those_of_the_functions():
    """The arms are differentiable too: CasADi's derivative in theta agrees with that of the series."""
    theta = ca.SX.sym("theta")
    derivative = ca.Function("f", [theta], [ca.jacobian(ca.vertcat(*stumpff(theta * theta, 5)), theta)])
    for t in (0.0, 1e-9, 1e-3, 0.1, 1.7, 1.75, 2.9, 3.1, 5.0):
        expected = [2 * t * float(ref.c_slope(k, t * t)) for k in range(6)]
        # sin and cos differentiated near zero lose what c_1 loses to rounding, over theta.
        np.testing.assert_allclose(
            np.array(derivative(t)).ravel(), expected, rtol=1e-12, atol=4e-16 / max(t, 1e-8)
        )


@pytest.mark.parametrize(
    ("outputs", "operations"),
    [
        (lambda x: log_factor(x), 25),
        (lambda x: inverse_jacobian(x)[0], 14),
        (lambda x: ca.vertcat(*inverse_jacobian(x)), 29),
    ],
)
def test_functions_of_the_logarithm_are_this_small(outputs, operations):
    symbol = ca.SX.sym("x")
    function = ca.Function("f", [symbol], [outputs(symbol)])
    free = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST)
    found = [function.instruction_id(k) for k in range(function.n_instructions())]
    assert sum(op not in free for op in found) == operations


@pytest.mark.parametrize("upto", [0, 2, 4, 6])
def test_other_orders_are_refused(upto):
    with pytest.raises(ValueError, match=f"upto is {upto}, it must be one of"):
        stumpff(1.0, upto)


def test_numbers_need_neither_sympy_nor_mpmath_nor_casadi():
    code = (
        "import sys; from liegen.coefficients import stumpff, log_factor, inverse_jacobian;"
        "stumpff(1.0, 5); log_factor(0.5); inverse_jacobian(1.0, False);"
        "assert not {'sympy', 'mpmath', 'casadi'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_exact_numbers_need_no_casadi():
    code = (
        "import sys, mpmath; from liegen.coefficients import stumpff;"
        "stumpff(mpmath.mpf(1), 5); assert 'casadi' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
