"""The coefficients of Sim(2) and Sim(3) at 60 digits from their integrals, term by term.

phi_1(z) = int_0^1 e^(z t) dt, so each coefficient is an integral of e^(lambda t) t^m c_k(s t^2) over [0, 1],
and its series in s has the integrals of e^(lambda t) t^n as terms: Kummer's function. Nothing here uses
liegen.
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
    slopes = (
        integral(3, 3, lam, s) - integral(3, 2, lam, s),
        2 * integral(4, 4, lam, s) - integral(4, 3, lam, s),
    )
    return dict(zip(NAMES, (A, B, C, *inverse, *second, *slopes), strict=True))


LOGARITHM = ("D", "D0", "K", "T", "C", "G", "H", "F")


def logarithm(lam, s):
    """The coefficients of k(ad): divided differences of k(z) = z/(e^z - 1) + z/2 - 1 in 300 digits.

    Closer to 0 than 1e-30 nothing changes in 50 digits: the functions are even and entire there.
    """
    with mp.workdps(300):
        tiny = mp.mpf(10) ** -30
        x, theta = max(abs(mp.mpf(float(lam))), tiny), max(mp.sqrt(mp.mpf(float(s))), tiny)

        def k(z):
            return z / mp.expm1(z) + z / 2 - 1

        z, turn = mp.mpc(x, theta), mp.mpc(0, theta)
        both, k0, k1 = k(z), k(x), k(turn).real
        first, second, third = (both - k1) / x, both / z, (k0 - k1) / (x - turn)
        g = (third.real - second.real) / (2 * theta**2 * x)
        alpha = (second.real + third.real) / 2
        h = (first.real - alpha) / theta**2 / x - g
        f = 2 * g - (k0 / x - second.real) / (theta**2 * x)
        values = (
            -k1 / theta**2,
            k0 / x**2,
            third.imag / theta,
            first.imag / theta,
            (k0 - both.real) / theta**2,
            g,
            h,
            f,
        )
        return dict(zip(LOGARITHM, values, strict=True))


def in_units(values, exact_values, scales):
    """Errors of doubles in units of 2^-52 times the value at theta = 0."""
    return np.array(
        [
            float(abs(exact(v) - x) / abs(u)) * 2.0**52
            for v, x, u in zip(values, exact_values, scales, strict=True)
        ]
    )
