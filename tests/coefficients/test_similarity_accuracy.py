"""The promised bounds of the coefficients of Sim(2) and Sim(3) over their two variables (shown by -s).

Bounds are in units of 2^-52 times the value at theta = 0, the largest for the lambda: the real and imaginary
parts of (e^z - 1)/z have zeros, and near them no relative error of a function of rounded arguments is
bounded.
"""

import casadi as ca
import numpy as np
import pytest
import similarity_reference as ref
import sympy as sp

from liegen.coefficients import (
    similarity,
    similarity_derivatives,
    similarity_inverse,
    similarity_logarithm,
    stumpff,
    tables,
)

mp = ref.mp
RANDOM = np.random.default_rng(77)
TINY = [0.0, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-200, 1e-162, 1e-160, 1e-155, 1e-100, 1e-30, 1e-17]
END = tables.SIMILARITY_END
BOUNDS = {name: 4 if name in ("A", "B", "C", "a") else 10 for name in ref.NAMES}
#: F is a difference of two means, a fifth of each.
LOGARITHM_BOUNDS = {"D": 8, "D0": 6, "K": 6, "T": 6, "C": 8, "G": 12, "H": 12, "F": 32}
ANYWHERE = [n for n in ref.NAMES if n not in ("a", "b", "c")]


def computed(lam, s):
    with np.errstate(all="raise", under="ignore"):  # both arms of every select are safe
        values = (*similarity(lam, s), *similarity_inverse(lam, s), *similarity_derivatives(lam, s))
    return dict(zip(ref.NAMES, values, strict=True))


def lambdas(count, largest=5.0):
    edges = [side * x for x in (END, np.nextafter(END, 0), np.nextafter(END, 9), largest) for side in (1, -1)]
    tiny = [side * x for x in TINY for side in (1, -1)]
    near = 10.0 ** RANDOM.uniform(-16, 0, count // 3) * RANDOM.choice([-1, 1], count // 3)
    return np.concatenate([edges, tiny, near, RANDOM.uniform(-largest, largest, count)])


def angles(high, count):
    edges = [np.sqrt(tables.STUMPFF3_END), np.sqrt(tables.STUMPFF5_END), 2.0**-30, high]
    near = 10.0 ** RANDOM.uniform(-16, 0, count // 3)
    theta = np.concatenate([TINY, edges, near, RANDOM.uniform(0, high, count)])
    return theta[theta <= high]


def grid(high, count):
    """Every lambda with some angle and every angle with some lambda, and all pairs of the smallest."""
    lam, theta = lambdas(count), angles(high, count)
    tiny = np.array([0.0, 1e-320, 1e-160, -1e-20, 2.0**-31, 2.0**-30, 1e-8])
    small = np.array([(a, abs(b)) for a in tiny for b in tiny]).T
    by_lambda = np.array([lam, RANDOM.choice(theta, len(lam))])
    by_theta = np.array([RANDOM.choice(lam, len(theta)), theta])
    return np.concatenate([by_lambda, by_theta, small], axis=1)


@pytest.mark.parametrize(
    ("high", "names"), [(np.pi, ref.NAMES), (2 * np.pi, ANYWHERE)], ids=["to pi", "to 2 pi"]
)
@pytest.mark.parametrize("count", [120, pytest.param(2_500, marks=pytest.mark.slow)])
def test_bounds(high, names, count):
    lam, theta = grid(high, count)
    s = theta * theta
    found = computed(lam, s)
    exact = [ref.coefficients(*x) for x in zip(lam, s, strict=True)]
    scales = [ref.coefficients(x, 0.0) for x in lam]
    for name in names:
        error = ref.in_units(found[name], [e[name] for e in exact], [e[name] for e in scales])
        k = int(np.argmax(error))
        print(f"{name}: {error[k]:.2f} at lambda {lam[k]:.3g}, theta {theta[k]:.3g}")
        assert error[k] <= BOUNDS[name], (name, lam[k], theta[k])


def test_scales_to_ten_to_the_thirteen():
    """Beyond |lambda| = 5 the same: of the weighted terms none outgrows the value at theta = 0."""
    lam, theta = RANDOM.uniform(-30, 30, 60), RANDOM.uniform(0, np.pi, 60)
    found = computed(lam, theta * theta)
    exact = [ref.coefficients(x, t * t) for x, t in zip(lam, theta, strict=True)]
    scales = [ref.coefficients(x, 0.0) for x in lam]
    for name in ref.NAMES:
        error = ref.in_units(found[name], [e[name] for e in exact], [e[name] for e in scales])
        assert np.max(error) <= BOUNDS[name], name


@pytest.mark.parametrize(
    ("count", "largest"), [(60, 5.0), (60, 30.0), pytest.param(2_000, 30.0, marks=pytest.mark.slow)]
)
def test_bounds_of_the_logarithm(count, largest):
    """As above on [0, pi]; G changes its sign: its unit is that of F, of which it is half at lambda = 0."""
    lam, theta = grid(np.pi, count)
    lam = lam * (largest / 5.0)
    s = theta * theta
    with np.errstate(all="raise", under="ignore"):
        found = dict(zip(ref.LOGARITHM, similarity_logarithm(lam, s), strict=True))
    exact = [ref.logarithm(*x) for x in zip(lam, s, strict=True)]
    scales = [ref.logarithm(x, 0.0) for x in lam]
    for name in ref.LOGARITHM:
        unit = [e["F" if name == "G" else name] for e in scales]
        error = ref.in_units(found[name], [e[name] for e in exact], unit)
        k = int(np.argmax(error))
        print(f"{name}: {error[k]:.2f} at lambda {lam[k]:.3g}, theta {theta[k]:.3g}")
        assert error[k] <= LOGARITHM_BOUNDS[name], (name, lam[k], theta[k])


def test_limits_at_the_identity_are_exact():
    for lam in (0.0, 1e-320, 1e-200, -1e-160):
        for s in (0.0, 5e-324, 1e-320, 1e-200):
            values = computed(lam, s)
            limits = (1, 1 / 2, 1 / 6, 1, 1 / 2, 1 / 12, 1 / 2, 1 / 6, 1 / 24, -1 / 12, -1 / 60)
            for name, limit in zip(ref.NAMES, limits, strict=True):
                assert float(values[name]) == pytest.approx(limit, rel=4e-16, abs=0), (name, lam, s)
            limits = (1 / 12, 1 / 12, 1 / 12, 1 / 6, 1 / 12, -1 / 720, 1 / 144, 1 / 720)
            np.testing.assert_allclose(similarity_logarithm(lam, s), limits, rtol=1e-15)


@pytest.mark.parametrize("digits", [15, 50])
def test_closed_forms_are_the_integrals(digits):
    """The SymPy expressions in mpmath, at every kind of argument, to the working precision."""
    for lam in (0.0, 1e-320, 1e-160, -1e-9, 0.3, -4.0, 5.0):
        for theta in (0.0, 1e-160, 1e-9, 0.4, 3.1):
            s = theta * theta
            exact = ref.coefficients(lam, s)
            with mp.workdps(digits):
                found = computed_exactly(mp.mpf(lam), mp.mpf(s))
                for name, value in found.items():
                    assert abs(value - exact[name]) <= 4 * mp.eps * abs(exact[name]), (name, lam, theta)
                values = similarity_logarithm(mp.mpf(lam), mp.mpf(s))
                for name, value in zip(ref.LOGARITHM, values, strict=True):
                    wanted = ref.logarithm(lam, s)[name]
                    assert abs(value - wanted) <= 8 * mp.eps * abs(wanted), (name, lam, theta)


def computed_exactly(lam, s):
    values = (*similarity(lam, s), *similarity_inverse(lam, s), *similarity_derivatives(lam, s))
    return dict(zip(ref.NAMES, values, strict=True))


def test_without_scale_they_are_the_stumpff_functions():
    """Proved in SymPy: A = 1, B = c_2, C = c_3, and the values at 0."""
    s, zero = sp.Symbol("x", positive=True), sp.Integer(0)
    _, _, c2, c3 = stumpff(s, 3)
    for mine, known in zip(similarity(zero, s), (1, c2, c3), strict=True):
        assert sp.simplify(mine - known) == 0
    assert similarity(zero, zero) == (1, sp.Rational(1, 2), sp.Rational(1, 6))
    assert similarity_inverse(zero, zero) == (1, sp.Rational(1, 2), sp.Rational(1, 12))


def test_a_wrong_coefficient_is_seen():
    """Five units more than the bound of any are seen: the measure measures."""
    exact = ref.coefficients(0.7, 2.0)
    assert ref.in_units([float(exact["B"]) * (1 + 9 * 2.0**-52)], [exact["B"]], [exact["B"]])[0] > 8


def test_on_arrays_and_sx_as_on_floats():
    lam, theta = grid(np.pi, 20)
    x, y = ca.SX.sym("lam"), ca.SX.sym("s")
    f = ca.Function("f", [x, y], [ca.vertcat(*everything(x, y))])
    table = everything(lam, theta * theta)
    for k in range(0, len(lam), 5):
        values = np.ravel(np.array(f(lam[k], theta[k] ** 2)))
        for i, single in enumerate(everything(float(lam[k]), float(theta[k] ** 2))):
            assert float(single) == table[i][k]
            assert values[i] == pytest.approx(float(single), rel=1e-14)


def everything(lam, s):
    return (
        *similarity(lam, s),
        *similarity_inverse(lam, s),
        *similarity_derivatives(lam, s),
        *similarity_logarithm(lam, s),
    )
