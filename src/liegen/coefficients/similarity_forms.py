"""The coefficient functions of the similarity groups as SymPy expressions, and their exact evaluation.

They are functions of the logarithm of the scale, lambda, and of s = theta^2. With z = lambda + i theta and
phi_1(z) = (e^z - 1)/z they are the real and imaginary parts of phi_1, of its inverse and of its derivatives,
arranged as the coefficients of I, W = [phi]x and W^2 (Eade, "Lie groups for 2D and 3D transformations",
2017, section 6, has the first of them).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from .closed_forms import S, mp, sp

LAMBDA: Any = sp.Symbol("lambda", real=True)
#: Bits that the expressions lose for each bit by which an argument is small: powers of |z| in denominators.
ORDER = 12

Expressions = tuple[Any, ...]


@cache
def _mean() -> tuple[Any, Any, Any]:
    """phi_1(lambda), and Re phi_1(z), Im phi_1(z) / theta."""
    theta, e, size = sp.sqrt(S), sp.exp(LAMBDA), LAMBDA**2 + S
    real = (LAMBDA * (e * sp.cos(theta) - 1) + theta * e * sp.sin(theta)) / size
    imaginary = (LAMBDA * e * sp.sin(theta) / theta - e * sp.cos(theta) + 1) / size
    return (e - 1) / LAMBDA, real, imaginary


@cache
def similarity_forms() -> Expressions:
    """(A, B, C) with A I + B W + C W^2 = phi_1(lambda + W)."""
    axis, real, imaginary = _mean()
    return axis, imaginary, (axis - real) / S


@cache
def similarity_inverse_forms() -> Expressions:
    """(a, b, c): a I - b W + c W^2 is the inverse of phi_1(lambda + W)."""
    axis, real, imaginary = _mean()
    size = real**2 + S * imaginary**2
    return 1 / axis, imaginary / size, (1 / axis - real / size) / S


@cache
def similarity_derivative_forms() -> Expressions:
    """(A2, B2, C2, Bs, Cs): F - dF/dlambda of A, B, C, which is phi_2(lambda + W); 2 dB/ds, 2 dC/ds."""
    forms = similarity_forms()
    second = tuple(f - sp.diff(f, LAMBDA) for f in forms)
    return (*second, *(2 * sp.diff(f, S) for f in forms[1:]))


@cache
def similarity_logarithm_forms() -> Expressions:
    """(D, D0, K, T, C, G, H, F) of k(z) = (z/2) coth(z/2) - 1, of which the Jacobians of log are made.

    With k0 = k(lambda), k1 = k(i theta): D = -k1/s, D0 = k0/lambda^2, K = (k0 - k1)/(lambda^2 + s),
    T = Im k(z)/(lambda theta), C = (k0 - Re k(z))/s, G = (K - Re(k(z)/z)/lambda)/(2 s),
    H = ((Re k(z) - k1)/lambda^2 - K)/s, F = (D - D0)/(lambda^2 + s).
    """
    theta, size = sp.sqrt(S), LAMBDA**2 + S
    base = 2 * (sp.cosh(LAMBDA) - sp.cos(theta))
    real = (LAMBDA * sp.sinh(LAMBDA) + theta * sp.sin(theta)) / base - 1
    t = (sp.sinh(LAMBDA) / LAMBDA - sp.sin(theta) / theta) / base
    k0, k1 = LAMBDA / 2 * sp.coth(LAMBDA / 2) - 1, theta / 2 * sp.cot(theta / 2) - 1
    k, d, d0 = (k0 - k1) / size, -k1 / S, k0 / LAMBDA**2
    g = (k - (real + S * t) / size) / (2 * S)
    h = ((real - k1) / LAMBDA**2 - k) / S
    return d, d0, k, t, (k0 - real) / S, g, h, (d - d0) / size


@cache
def _compiled(forms: Expressions) -> Callable[[Any, Any], list[Any]]:
    return sp.lambdify((LAMBDA, S), list(forms), modules="mpmath", cse=True)


def _numbers(forms: Expressions, lam: Any, s: Any) -> Expressions:
    """At 0 the entire functions are evaluated beside it, closer than the working precision tells apart."""
    if not (mp.isfinite(lam) and mp.isfinite(s)):
        return tuple(mp.nan for _ in forms)
    beside = mp.ldexp(1, -mp.prec - 40)
    x, y = lam or beside, s or beside
    lost = ORDER * max(0, -mp.mag(x), -mp.mag(y))
    with mp.workprec(mp.prec + 40 + lost):
        values = _compiled(forms)(mp.mpf(x), mp.mpf(y))
    return tuple(+mp.re(value) for value in values)


def _expression(form: Any, lam: Any, s: Any) -> Any:
    """Of SymPy arguments; at 0 the limit."""
    form = sp.limit(form, LAMBDA, 0) if lam == 0 else form.subs(LAMBDA, lam)
    if s != 0:
        return form.subs(S, s)
    t = sp.Symbol("t", positive=True)
    return sp.limit(sp.simplify(form.subs(S, t**2)), t, 0)


def evaluate(forms: Expressions, lam: Any, s: Any) -> Expressions:
    """The forms: mpmath numbers right to the working precision, or SymPy expressions."""
    if isinstance(lam, sp.Basic) or isinstance(s, sp.Basic):
        return tuple(_expression(f, lam, s) for f in forms)
    return _numbers(forms, lam, s)
