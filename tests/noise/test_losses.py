"""The closed forms of the losses against textbook formulas in mpmath, and SciPy's where they are the same."""

from __future__ import annotations

import math

import numpy as np
import pytest
from loss_reference import RHO, SLOPE
from mpmath import mp, mpf
from scipy.optimize import least_squares

from liegen.noise import LOSSES

POINTS = (0.0, 5e-324, 1e-300, 1e-160, 1e-20, 1e-8, 1e-3, 0.1, 0.2499, 0.2501, 0.5, 0.9, 1.5, 4.0, 30.0, 1e3,
          1e10,
          1e100, 1e300)  # fmt: skip
ROWS = [(name, shape) for name, loss in LOSSES.items() for shape in loss.shapes]
SCALES = (1.0, 1.345, 3e-5, 2e4)
EPS = 2.0**-52


@pytest.mark.parametrize(("name", "shape"), ROWS, ids=str)
@pytest.mark.parametrize("scale", SCALES)
def test_rho_and_slope_keep_their_digits(name, shape, scale):
    loss = LOSSES[name]
    for x in POINTS:
        s = np.float64(x * scale * scale)
        if not np.isfinite(s):
            continue
        with np.errstate(all="ignore"):
            rho = float(loss.rho(s, *map(np.float64, (*shape, scale))))
            slope = float(loss.slope(s, *map(np.float64, (*shape, scale))))
        with mp.workdps(400):
            exact = RHO[name](mpf(float(s)), *map(mpf, (*shape, scale)))
            steep = SLOPE[name](mpf(float(s)), *map(mpf, (*shape, scale)))
            if abs(exact) < mpf(1e300):
                # rounding of x by half a unit moves a power or an exponential by its exponent
                exponent = abs(mp.log(steep)) if steep else mpf(0)
                tolerance = 16 * EPS * (1 + min(exponent, 800))
                # Barron's rho goes through exp(v), v <= log(1 + x/b): as many units as v
                power = 1 + mp.log(1 + x / abs(shape[0] - 2)) if shape and shape[0] not in (2, -np.inf) else 1
                assert abs(mpf(rho) - exact) <= tolerance * power * exact + mpf(5e-324), (x, rho)
                assert abs(mpf(slope) - steep) <= tolerance * steep + mpf(1e-307), (x, slope)


@pytest.mark.parametrize(("name", "shape"), ROWS, ids=str)
def test_derivatives_are_those_of_rho(name, shape):
    loss = LOSSES[name]
    scale = 1.345
    for x in (0.0, 1e-6, 0.3, 0.7, 1.3, 5.0, 40.0):
        s = np.float64(x * scale * scale)
        got = [float(f(s, *map(np.float64, (*shape, scale)))) for f in (loss.slope, loss.curvature)]
        with mp.workdps(60):
            for order, value in enumerate(got, start=1):
                exact = mp.diff(lambda t: RHO[name](t, *map(mpf, (*shape, scale))), mpf(float(s)), order)
                assert abs(mpf(value) - exact) <= 1e-13 * max(1e-3, abs(exact)), (x, order)


@pytest.mark.parametrize("name", LOSSES)
def test_slope_is_one_at_zero(name):
    """SymForce's pseudo-Huber whitening has slope 0 there."""
    for shape in LOSSES[name].shapes:
        for scale in SCALES:
            assert float(LOSSES[name].slope(np.float64(0), *map(np.float64, (*shape, scale)))) == 1.0


@pytest.mark.parametrize(
    ("name", "theirs"), [("huber", "huber"), ("pseudo-huber", "soft_l1"), ("cauchy", "cauchy")]
)
def test_scipy_has_the_same_cost(name, theirs):
    for r in (0.0, 1e-3, 0.5, 1.2, 1.5, 40.0):
        # no step is taken from the start, so the cost is that of r; SciPy's is 1/2 C^2 rho((r/C)^2)
        found = least_squares(lambda x, r=r: [r + 0 * x[0]], [0.0], loss=theirs, f_scale=1.345, max_nfev=1)
        mine = 0.5 * float(LOSSES[name].rho(np.float64(r * r), np.float64(1.345)))
        assert found.cost == pytest.approx(mine, rel=4e-15, abs=1e-15)  # theirs cancels near 0


@pytest.mark.parametrize(
    ("alpha", "other"), [(0.0, "cauchy"), (-2.0, "geman-mcclure"), (1.0, "pseudo-huber")]
)
def test_barron_contains_the_others(alpha, other):
    """Barron (2019), section 1: Charbonnier at 1, Cauchy at 0, Geman-McClure at -2, with scaled c."""
    b = 2.0 - alpha
    for x in (0.0, 0.3, 7.0):
        mine = LOSSES["barron"].rho(np.float64(x), np.float64(alpha), np.float64(1.0))
        assert float(mine) == pytest.approx(
            float(LOSSES[other].rho(np.float64(x), np.float64(np.sqrt(b)))), rel=1e-14
        )


@pytest.mark.parametrize("name", LOSSES)
def test_what_is_said_of_the_scale_is_so(name):
    """The weight where |S r| is the scale, as the meaning of the parameter states it."""
    loss, k = LOSSES[name], np.float64(1.7)
    shape = [np.float64(x) for x in loss.shapes[-1]]
    said = loss.meaning(loss.scale).partition("rho' is ")[2].partition(",")[0]
    if name == "huber":
        ends = [loss.rho(np.float64(r * r), k) for r in (k, 2 * k, 3 * k)]
        assert np.diff(ends)[0] == pytest.approx(np.diff(ends)[1])
        assert said == ""
    elif name == "tukey":
        assert loss.slope(k * k * (1 + 1e-9), k) == float(said) == 0
    else:
        space = {"sqrt": math.sqrt, "e": math.e, "alpha": shape[0] if shape else 0, "b": 1.0}
        space["b"] = abs(space["alpha"] - 2)
        weight = eval(said.replace("^", "**"), space)
        assert loss.slope(k * k, *shape, k) == pytest.approx(weight, rel=1e-14)
