"""The coefficient functions of the similarity groups in double precision: on floats, arrays and SX alike.

With p_k = phi_k(-lambda) = sum_j (-lambda)^j / (j + k)! and the Stumpff functions c_k(s) all of them are
e^lambda times weighted means of a function of lambda alone and one in which lambda enters linearly,

    (lambda^2 X + s Y) / (lambda^2 + s),

where X = Y to first order at 0: no difference is divided by anything small, and only the weight is 0/0 at 0.
Errors are a few units of 2^-52 times the value at theta = 0, the largest for this lambda
(docs/coefficients.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from liegen.algebra import Scalar, call, fabs, le, lt, select

from . import tables
from .evaluate import TINY, horner, stumpff


@dataclass(frozen=True)
class _Exponentials:
    """e^lambda, p_k, and d_k = p_k - k p_{k+1} (the integral of t (1 - t)^{k-1} e^{-lambda t}/(k-1)!)."""

    e: Scalar
    p1: Scalar
    p2: Scalar
    p3: Scalar
    p4: Scalar
    p5: Scalar
    d1: Scalar
    d2: Scalar
    d3: Scalar


def _exponentials(lam: Scalar) -> _Exponentials:
    """Where |lambda| is small from a polynomial for p_5 downwards, else from e^-lambda upwards.

    p_k = 1/k! - lambda p_{k+1} and d_k = 1/(k+1)! - lambda (d_{k+1} + p_{k+2}). Upwards d_k is written out,
    as its two terms cancel.
    """
    low = le(fabs(lam), tables.SIMILARITY_END)
    e = call("exp", lam)
    p5 = horner(tables.P5, lam)
    p4 = 1.0 / 24.0 - lam * p5
    p3 = 1.0 / 6.0 - lam * p4
    p2 = 0.5 - lam * p3
    p1 = 1.0 - lam * p2
    d3 = 1.0 / 24.0 - lam * (p4 - 4.0 * p5 + p5)
    d2 = 1.0 / 6.0 - lam * (d3 + p4)
    d1 = 0.5 - lam * (d2 + p3)
    x, back = select(low, tables.SIMILARITY_END, lam), 1.0 / e
    r = 1.0 / x
    h1 = (1.0 - back) * r
    h2 = (1.0 - h1) * r
    h3 = (0.5 - h2) * r
    h4 = (1.0 / 6.0 - h3) * r
    h5 = (1.0 / 24.0 - h4) * r
    r2 = r * r
    above = (
        (h1, h2, h3, h4, h5),
        (
            (1.0 - (x + 1.0) * back) * r2,
            (x - 2.0 + (x + 2.0) * back) * (r2 * r),
            (x * (0.5 * x - 2.0) + 3.0 - (x + 3.0) * back) * (r2 * r2),
        ),
    )
    below = ((p1, p2, p3, p4, p5), (d1, d2, d3))
    p, d = (
        tuple(select(low, u, v) for u, v in zip(*pair, strict=True))
        for pair in zip(below, above, strict=True)
    )
    return _Exponentials(e, *p, *d)


def _weighing(lam: Scalar, s: Scalar) -> Callable[[Scalar, Scalar], Scalar]:
    """(lambda^2 X + s Y) / (lambda^2 + s) of X and Y; Y where both arguments are 0."""
    square = lam * lam
    other = select(lt(square + s, TINY), TINY, s)
    r = 1.0 / (square + other)
    q, rest = square * r, other * r
    return lambda x, y: q * x + rest * y


def similarity(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """(A, B, C)."""
    k, mean = _exponentials(lam), _weighing(lam, s)
    _, _, c2, c3, c4, _ = stumpff(s, 5)
    return k.e * k.p1, k.e * mean(k.p2, c2 - lam * c3), k.e * mean(k.p3, c3 - lam * c4)


def similarity_inverse(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """(a, b, c); the mean of p_1^2 e^lambda and 2 c_2 is |phi_1(z)|^2 e^-lambda, 0 at the poles."""
    k, mean = _exponentials(lam), _weighing(lam, s)
    _, _, c2, c3, c4, _ = stumpff(s, 5)
    axis = k.e * k.p1
    r = 1.0 / mean(k.p1 * axis, 2.0 * c2)
    b = mean(k.p2, c2 - lam * c3) * r
    return 1.0 / axis, b, mean(c2 * k.d2 / k.p1, c3 - 2.0 * c4) * r


def _sixth(s: Scalar, c4: Scalar) -> Scalar:
    """c_6."""
    low = le(s, tables.STUMPFF5_END)
    return select(low, horner(tables.C6_5, s), (1.0 / 24.0 - c4) / select(low, tables.STUMPFF5_END, s))


def similarity_derivatives(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar, Scalar, Scalar]:
    """(A2, B2, C2, Bs, Cs), the slopes by 2 dc_k/ds = k c_{k+2} - c_{k+1}."""
    k, mean = _exponentials(lam), _weighing(lam, s)
    _, _, _, c3, c4, c5 = stumpff(s, 5)
    c6 = _sixth(s, c4)
    g3 = mean(k.p3, c3 - lam * c4)
    g4 = mean(k.p4, c4 - lam * c5)
    g5 = mean(k.p5, c5 - lam * c6)
    b2 = k.e * mean(k.d2, g3 - lam * g4)
    c2 = k.e * mean(k.d3, g4 - lam * g5)
    by_b = k.e * mean(2.0 * g4, c3 - 2.0 * c4 - lam * (c4 - 3.0 * c5))
    by_c = k.e * mean(2.0 * g5, c4 - 3.0 * c5 - lam * (c5 - 4.0 * c6))
    return k.e * k.d1, b2, c2, -by_b, -by_c


def _hyperbolic(lam: Scalar) -> tuple[Scalar, ...]:
    """c_2 to c_6 at -lambda^2, all terms positive: c_k = 1/k! + lambda^2 c_{k+2}."""
    x = lam * lam
    low = le(x, tables.HYPERBOLIC_END)
    c6, c5 = horner(tables.C6_H, -x), horner(tables.C5_H, -x)
    c4, c3 = 1.0 / 24.0 + x * c6, 1.0 / 6.0 + x * c5
    c2 = 0.5 + x * c4
    far = select(low, math.sqrt(tables.HYPERBOLIC_END), lam)
    e = call("exp", lam)
    back, r = 1.0 / e, 1.0 / far
    r2 = r * r
    h2 = (0.5 * (e + back) - 1.0) * r2
    h3 = (0.5 * (e - back) * r - 1.0) * r2
    h4, h5 = (h2 - 0.5) * r2, (h3 - 1.0 / 6.0) * r2
    h6 = (h4 - 1.0 / 24.0) * r2
    return tuple(select(low, u, v) for u, v in zip((c2, c3, c4, c5, c6), (h2, h3, h4, h5, h6), strict=True))


def similarity_logarithm(lam: Scalar, s: Scalar) -> tuple[Scalar, ...]:
    """(D, D0, K, T, C, G, H, F), even in lambda.

    The differences of c_k(-lambda^2) and c_k(s) are (lambda^2 + s) times the mean of both c_{k+2}, which
    divides every difference of the definitions out.
    """
    h2, h3, h4, h5, h6 = _hyperbolic(lam)
    _, _, c2, c3, c4, c5 = stumpff(s, 5)
    c6, mean = _sixth(s, c4), _weighing(lam, s)
    u, half, half0 = c3 - 2.0 * c4, 0.5 / c2, 0.5 / h2
    d, d0 = u * half, (h3 - 2.0 * h4) * half0
    r = 1.0 / mean(2.0 * h2, 2.0 * c2)  # the mean is |2 sinh(z/2)/z|^2, 0 at the poles
    m4, m6 = mean(h4, c4), mean(h6, c6)
    f = (u * m4 - c2 * (mean(h5, c5) - 2.0 * m6)) * (2.0 * (half * half0))
    k = d0 + s * f
    kr = k * r
    g = r * mean(m4 * (d - d0) - m6, -0.5 * (c5 - 4.0 * c6))
    return d, d0, k, r * mean(h3, c3), 2.0 * (c2 * kr), g, 2.0 * (kr * m4), f
