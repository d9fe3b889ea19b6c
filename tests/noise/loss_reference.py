"""Textbook formulas of the losses in mpmath; derivatives by mpmath's own differentiation."""

from __future__ import annotations

import math

from mpmath import mp, mpf

INF = math.inf


def barron(s, alpha, c):
    """Barron (2019), eq. 8 with the special values of the paper, times 2 c^2."""
    x2 = s / c**2
    if alpha == 2:
        f = x2 / 2
    elif alpha == 0:
        f = mp.log(x2 / 2 + 1)
    elif alpha == -INF:
        f = 1 - mp.exp(-x2 / 2)
    else:
        b = abs(alpha - 2)
        f = b / alpha * ((x2 / b + 1) ** (alpha / 2) - 1)
    return 2 * c**2 * f


RHO = {
    "huber": lambda s, k: s if s <= k**2 else 2 * k * mp.sqrt(s) - k**2,
    "pseudo-huber": lambda s, k: 2 * k**2 * (mp.sqrt(1 + s / k**2) - 1),
    "cauchy": lambda s, c: c**2 * mp.log(1 + s / c**2),
    "tukey": lambda s, c: c**2 / 3 * (1 - (1 - s / c**2) ** 3) if s < c**2 else c**2 / 3,
    "geman-mcclure": lambda s, c: c**2 * s / (c**2 + s),
    "welsch": lambda s, c: c**2 * (1 - mp.exp(-s / c**2)),
    "barron": barron,
}
#: rho' by hand, of x = s / c^2 where that is shorter: digits that differences of rho lose far out.
SLOPE = {
    "huber": lambda s, k: mpf(1) if s <= k**2 else k / mp.sqrt(s),
    "pseudo-huber": lambda s, k: 1 / mp.sqrt(1 + s / k**2),
    "cauchy": lambda s, c: 1 / (1 + s / c**2),
    "tukey": lambda s, c: (1 - s / c**2) ** 2 if s < c**2 else mpf(0),
    "geman-mcclure": lambda s, c: 1 / (1 + s / c**2) ** 2,
    "welsch": lambda s, c: mp.exp(-s / c**2),
    "barron": lambda s, a, c: (
        mpf(1)
        if a == 2
        else mp.exp(-s / c**2 / 2)
        if a == -INF
        else (1 + s / c**2 / abs(a - 2)) ** (a / 2 - 1)
    ),
}
