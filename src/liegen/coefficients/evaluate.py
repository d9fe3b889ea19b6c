"""The coefficient functions in double precision: on floats, NumPy arrays and SX alike.

No form branches, both arms of every select are finite. Errors in units in the last place (ulp) are bounds
that the tests check against mpmath; "conditioning" is what half an ulp in theta makes of the function.
Operations count each select, comparison and call as one, as ``Program.operations`` does.
"""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra import Scalar, cos, le, lt, select, sin, sqrt

from . import tables

#: For a smaller theta^2 the functions are constant to the last digit. 1/TINY^2 is finite in single precision.
TINY = 2.0**-60


def horner(coefficients: Sequence[float], x: Scalar) -> Scalar:
    """The polynomial with these coefficients, lowest power first, at ``x``."""
    *rest, total = coefficients
    if total == 1.0:  # a leading 1 costs no multiplication
        total = x + rest.pop()
    for a in reversed(rest):
        total = total * x + a
    return total


def _above_zero(square: Scalar) -> Scalar:
    """``square``, large enough to divide by it and by its root."""
    return select(lt(square, TINY), TINY, square)


def stumpff(s: Scalar, upto: int) -> tuple[Scalar, ...]:
    """(c_0, ..., c_upto) at s = theta^2, for ``upto`` 1, 3 or 5: 6, 31, 60 operations for all of them.

    c_0, c_1 and c_2 = 2 (sin(theta/2)/theta)^2 lose no digits anywhere and need no polynomial. The others do
    in 1/k! - c_k for small angles: there c_4 and c_5 (or c_3 alone) are polynomials.
    The half angle's sine and cosine are those of the unit quaternion, ``stumpff(0.25 * s, 1)``.
    At any theta within 4 ulp and conditioning.
    """
    if upto == 1:
        theta = sqrt(_above_zero(s))
        return cos(theta), sin(theta) / theta
    quarter = _above_zero(0.25 * s)
    half = sqrt(quarter)
    ratio = sin(half) / half
    c0, c1, c2 = cos(2.0 * half), ratio * cos(half), 0.5 * (ratio * ratio)
    inverse = 0.25 / quarter
    c3_high = (1.0 - c1) * inverse
    if upto == 3:
        return c0, c1, c2, select(lt(s, tables.STUMPFF3_END), horner(tables.C3_3, s), c3_high)
    low = lt(s, tables.STUMPFF5_END)
    c5_low = horner(tables.C5_5, s)
    # 1/6 - c_3 written out: s - 6 is exact where the difference is small.
    c5_high = ((s - 6.0) * (1.0 / 6.0) + c1) * (inverse * inverse)
    c3 = select(low, 1.0 / 6.0 - s * c5_low, c3_high)
    c4 = select(low, horner(tables.C4_5, s), (0.5 - c2) * inverse)
    return c0, c1, c2, c3, c4, select(low, c5_low, c5_high)


def log_factor(w: Scalar) -> Scalar:
    """2 acos(w) / sqrt(1 - w^2) for w in [0, 1], as 2 + (1 - w) P(w)/Q(w): 25 operations, within 2 ulp.

    A Stieltjes function of w: all coefficients are positive, so nothing cancels. 2 exactly at w = 1.
    """
    constant, *numerator = tables.LOG_P
    return constant + (1.0 - w) * (horner(numerator, w) / horner(tables.LOG_Q, w))


def inverse_jacobian(s: Scalar) -> tuple[Scalar, Scalar]:
    """(D, E) at s = theta^2 in [0, pi^2], as 1/12 + s P/Q and 1/360 + s R/Q^2.

    14 operations for D, within 1.5 ulp; 29 for both, E within 3 ulp.
    """
    d0, *d = tables.INVERSE_D
    e0, *e = tables.INVERSE_E
    r = 1.0 / horner(tables.INVERSE_Q, s)
    sr = s * r
    return d0 + horner(d, s) * sr, e0 + horner(e, s) * (sr * r)


def inverse_jacobian_anywhere(s: Scalar) -> tuple[Scalar, Scalar]:
    """(D, E) at every s = theta^2 >= 0 but the poles, which are at theta = 2 pi n, n >= 1: 46 operations.

    The closed form above pi is within 5 ulp (E) and conditioning, which grows towards the poles.
    """
    end = tables.INVERSE_END
    low = le(s, end)
    # 1 and not 0 for the arm that is not taken: CasADi spreads a select against 0 over all products with it.
    d_low, e_low = inverse_jacobian(select(low, s, 1.0))
    high = select(low, end, s)
    half = 0.5 * sqrt(high)
    k = half * (cos(half) / sin(half))
    d_high = (1.0 - k) / high
    e_high = (0.25 - (k + 2.0) * d_high) / high  # from k' = (k - k^2 - s/4) / (2 s)
    return select(low, d_low, d_high), select(low, e_low, e_high)
