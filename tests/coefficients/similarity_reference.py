"""The coefficients of Sim(2) and Sim(3) at 60 digits from their integrals, term by term.

phi_1(z) = int_0^1 e^(z t) dt, so each coefficient is an integral of e^(lambda t) t^m c_k(s t^2) over [0, 1], and its
series in s has the integrals of e^(lambda t) t^n as terms: Kummer's function. Nothing here uses liegen.
"""

import numpy as np
from coefficient_reference import at_digits, exact, mp

NAMES = ("A", "B", "C", "a", "b", "c", "A2", "B2", "C2", "Bs", "Cs")


def power(n, lam):
    """int e^(lam t) t^n dt."""
    return mp.hyp1f1(n + 1, n + 2, lam) / (n + 1)


def integral(m, k, lam, s):
    """int e^(lam t) t^m c_k(s t^2) dt."""
    total, factor, j = mp.mpf(0), 1 / mp.factorial(k), 0
    while True:
        term = factor * power(m + 2 * j, lam)
        total += term
        if abs(term) <= mp.eps * abs(total) * mp.mpf(2) ** -20 and j > 2:
            return total
        factor *= -s / ((2 * j + k + 1) * (2 * j + k + 2))
        j += 1


@at_digits
def coefficients(lam, s):
    """By name, for doubles."""
    lam, s = exact(lam), exact(s)
    A, B, C = (integral(k, k, lam, s if k else mp.mpf(0)) for k in range(3))
    real = A - s * C
    size = real**2 + s * B**2
    # (1/A - real/size)/s, multiplied out: no difference is left to divide
    inverse = 1 / A, B / size, (B**2 - C * real) / (A * size)
    second = A - power(1, lam), B - integral(2, 1, lam, s), C - integral(3, 2, lam, s)
    slopes = integral(3, 3, lam, s) - integral(3, 2, lam, s), 2 * integral(4, 4, lam, s) - integral(4, 3, lam, s)
    return dict(zip(NAMES, (A, B, C, *inverse, *second, *slopes), strict=True))


def in_units(values, exact_values, scales):
    """Errors of doubles in units of 2^-52 times the value at theta = 0."""
    return np.array(
        [float(abs(exact(v) - x) / abs(u)) * 2.0**52 for v, x, u in zip(values, exact_values, scales, strict=True)]
    )
