"""The coefficient functions at 60 digits from their power and hypergeometric series, and error measures.

Nothing here uses liegen: c_k(s) = 1F2(1; (k+1)/2, (k+2)/2; -s/4)/k!, D from the Bernoulli numbers' generating
function, E from its derivative, the logarithm's factor from 2F1.
"""

from functools import cache

import mpmath
import numpy as np

mp = mpmath.mp
DIGITS = 60
#: theta^2 at and near 0: denormals, and what underflows when theta is squared.
TINY = [0.0, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-200, 1e-160**2, 1e-100, 1e-30, 2.0**-60, 1e-16, 1e-8, 1e-4]


def exact(x):
    return mp.mpf(float(x))


def at_digits(function):
    def wrapped(*args):
        with mp.workdps(DIGITS):
            return function(*args)

    return wrapped


@at_digits
def c(k, s):
    return mp.hyp1f2(1, mp.mpf(k + 1) / 2, mp.mpf(k + 2) / 2, -exact(s) / 4) / mp.factorial(k)


@at_digits
def c_slope(k, s):
    """dc_k/ds = -1F2(2; (k+3)/2, (k+4)/2; -s/4)/(k+2)!, from the series term by term."""
    return -mp.hyp1f2(2, mp.mpf(k + 3) / 2, mp.mpf(k + 4) / 2, -exact(s) / 4) / mp.factorial(k + 2)


@cache
def _zeta(order, first):
    return mp.zeta(order, first)


def _partial_fractions(s, power, first=40):
    """sum_n 1/((2 pi n)^2 - s)^power: some terms, the rest by the series of zeta functions."""
    near = mp.fsum(1 / ((2 * mp.pi * n) ** 2 - s) ** power for n in range(1, first))
    far, j, term = mp.mpf(0), 0, mp.mpf(1)
    while abs(term) > mp.mpf(10) ** (-DIGITS - 5):
        order = 2 * (power + j)
        term = mp.binomial(power + j - 1, j) * s**j / (2 * mp.pi) ** order * _zeta(order, first)
        far, j = far + term, j + 1
    return near + far


@at_digits
def d(s):
    """D: (theta/2) cot(theta/2) = 1 - 2 s sum_n 1/((2 pi n)^2 - s) (Euler)."""
    return 2 * _partial_fractions(exact(s), 1)


@at_digits
def e(s):
    """E = 2 dD/ds."""
    return 4 * _partial_fractions(exact(s), 2)


@at_digits
def log_factor(w):
    """2 acos(w)/sqrt(1 - w^2) = 2 2F1(1, 1; 3/2; (1 - w)/2)."""
    return 2 * mp.hyp2f1(1, 1, mp.mpf(3) / 2, (1 - exact(w)) / 2)


def ulp(reference):
    return np.spacing(abs(np.array([float(r) for r in reference])))


def error(values, reference):
    """Absolute errors of doubles against mpmath numbers, as floats."""
    with mp.workdps(DIGITS):
        return np.array([float(abs(exact(v) - r)) for v, r in zip(values, reference, strict=True)])


def around(*points):
    """Each point with three doubles on either side."""
    out = []
    for p in points:
        low = high = p
        out.append(p)
        for _ in range(3):
            low, high = np.nextafter(low, -np.inf), np.nextafter(high, np.inf)
            out += [low, high]
    return np.array(out)
