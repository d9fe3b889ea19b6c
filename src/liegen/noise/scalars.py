"""log(1 + y) and (exp(v) - 1) / v on any scalar, with all digits near 0."""

from __future__ import annotations

from functools import reduce

from liegen.algebra import Scalar, call, fabs, lt, select, sqrt

#: Below, log(1 + y) is a series in z^2 with z = y / (2 + y) <= 1/9, whose tenth term is below 2^-53.
_SMALL = 0.25
#: From here on, log(1 + x/b) is 2 log(1 + sqrt(x/b)) to the last digit.
_HUGE = 1e40
_LOG = tuple(1.0 / (2 * k + 1) for k in range(10))
_EXP = tuple(1.0 / d for d in (1, 2, 6, 24, 120, 720, 5040, 40320, 362880, 3628800, 39916800, 479001600))


def horner(coefficients: tuple[float, ...], x: Scalar) -> Scalar:
    """The polynomial with the given coefficients, lowest order first."""
    return reduce(lambda total, c: total * x + c, coefficients[-2::-1], coefficients[-1] + 0 * x)


def safe(condition: Scalar, x: Scalar, otherwise: float) -> Scalar:
    """``x`` where the condition holds, elsewhere a number that the unused arm of a select can take."""
    return select(condition, x, otherwise)


def log1p_over(x: Scalar, b: Scalar) -> Scalar:
    """b log(1 + x/b) for x >= 0, b >= 0: 0 for b = 0, x for b = inf."""
    positive = lt(0.0, b)
    b = safe(positive, b, 1.0)
    huge = lt(_HUGE * b, x)
    y = select(huge, sqrt(x), x) / select(huge, sqrt(b), b)  # x/b might overflow, its root does not
    near = lt(y, _SMALL)
    z = y / (2.0 + y)
    series = 2.0 * x / (2.0 + y) * horner(_LOG, z * z)
    # an infinite b is near: its product with log(1) = 0 must not be taken
    far = select(near, 1.0, select(huge, 2.0 * b, b)) * call("log", 1.0 + y)
    return select(positive, select(near, series, far), 0.0)


def log1p(y: Scalar) -> Scalar:
    """log(1 + y) for y >= 0."""
    return log1p_over(y, 1.0 + 0 * y)


def expm1_ratio(v: Scalar) -> Scalar:
    """(exp(v) - 1) / v; 1 at 0."""
    near = lt(fabs(v), _SMALL)
    w = select(near, 1.0, v)
    return select(near, horner(_EXP, select(near, v, 0.0)), (call("exp", w) - 1.0) / w)
