"""The transcendental scalar functions of the Lie groups, for every scalar backend.

mpmath numbers and SymPy expressions get the closed forms; floats, arrays and SX get polynomials (and selects)
derived from those by :mod:`liegen.coefficients.fit`, a few units in the last place from the exact value.
"""

from __future__ import annotations

import importlib
from typing import Any

from liegen.algebra import Scalar, algebra_of

from . import evaluate, similarity_doubles

_LAST = (1, 3, 5)


def _closed_forms() -> Any:
    """Loaded on first use: it needs SymPy, which takes long to start."""
    return importlib.import_module(".closed_forms", __name__)


def _similarity_forms() -> Any:
    return importlib.import_module(".similarity_forms", __name__)


def stumpff(s: Scalar, upto: int) -> tuple[Scalar, ...]:
    """Stumpff functions ``(c_0, ..., c_upto)`` at ``s`` = theta^2 (rad^2); ``upto`` is 1, 3 or 5.

    c_k(s) = sum_j (-s)^j / (2j + k)!: c_0 = cos(theta), c_1 = sin(theta)/theta,
    c_2 = (1 - cos(theta))/theta^2, c_3 = (theta - sin(theta))/theta^3, and so on (Stumpff 1959).
    They obey c_k = 1/k! - s c_{k+2} and dc_k/ds = (k c_{k+2} - c_{k+1})/2.
    Write ``0.25 * s`` for a half angle, then its sine and cosine are shared with ``stumpff(s, 3)``.
    Raises ValueError for another ``upto``.
    """
    if upto not in _LAST:
        raise ValueError(f"stumpff: upto is {upto}, it must be one of {_LAST}")
    module = _closed_forms() if algebra_of(s).exact else evaluate
    return module.stumpff(s, upto)


def log_factor(w: Scalar) -> Scalar:
    """The factor f = 2 acos(w)/sqrt(1 - w^2), w in [0, 1]: the unit quaternion (v, w) has the logarithm f v.

    It is theta/sin(theta/2) at w = cos(theta/2), from pi at w = 0 to 2 at w = 1; w may exceed 1 by rounding.
    """
    return _closed_forms().log_factor(w) if algebra_of(w).exact else evaluate.log_factor(w)


def inverse_jacobian(s: Scalar, principal: bool = True) -> tuple[Scalar, Scalar]:
    """``(D, E)`` at ``s`` = theta^2: Jr^-1(phi) = I + [phi]x / 2 + D [phi]x^2, and E = 2 dD/ds.

    D = (1 - (theta/2) cot(theta/2))/theta^2 (Sola, Deray, Atchuthan 2018, equation 144, rearranged).
    ``principal`` promises theta <= pi, as logarithms have it, and needs no trigonometry; without it theta
    may have any value but the poles 2 pi, 4 pi, ...
    """
    if algebra_of(s).exact:
        return _closed_forms().inverse_jacobian(s)
    return evaluate.inverse_jacobian(s) if principal else evaluate.inverse_jacobian_anywhere(s)


def similarity(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """``(A, B, C)`` at ``lam`` = log(scale) and ``s`` = theta^2: V = A I + B W + C W^2 with W = [phi]x.

    V = phi_1(lam + W), phi_1(z) = (e^z - 1)/z: the exponential of Sim(3) moves by V rho. With
    z = lam + i theta, A = phi_1(lam), B = Im phi_1(z) / theta, C = (A - Re phi_1(z)) / s. ``lam = 0``: 1,
    c_2, c_3.
    """
    if algebra_of(lam, s).exact:
        module = _similarity_forms()
        a, b, c = module.evaluate(module.similarity_forms(), lam, s)
        return a, b, c
    return similarity_doubles.similarity(lam, s)


def similarity_inverse(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """``(a, b, c)`` with V^-1 = a I - b W + c W^2 (see ``similarity``). ``lam = 0``: 1, 1/2, D.

    Its only poles are at lam = 0 and theta = 2 pi n, n >= 1.
    """
    if algebra_of(lam, s).exact:
        module = _similarity_forms()
        a, b, c = module.evaluate(module.similarity_inverse_forms(), lam, s)
        return a, b, c
    return similarity_doubles.similarity_inverse(lam, s)


def similarity_derivatives(lam: Scalar, s: Scalar) -> tuple[Scalar, Scalar, Scalar, Scalar, Scalar]:
    """``(A2, B2, C2, Bs, Cs)``, what the Jacobians of Sim(3) need beside ``similarity``.

    A2 I + B2 W + C2 W^2 = phi_2(lam + W) = V - dV/dlam with phi_2(z) = (e^z - 1 - z)/z^2; Bs = 2 dB/ds and
    Cs = 2 dC/ds.
    """
    if algebra_of(lam, s).exact:
        module = _similarity_forms()
        a, b, c, by_b, by_c = module.evaluate(module.similarity_derivative_forms(), lam, s)
        return a, b, c, by_b, by_c
    return similarity_doubles.similarity_derivatives(lam, s)


def similarity_logarithm(lam: Scalar, s: Scalar) -> tuple[Scalar, ...]:
    """``(D, D0, K, T, C, G, H, F)``, even in ``lam``, of k(z) = (z/2) coth(z/2) - 1, for log's Jacobians.

    Jl^-1 = I - ad/2 + k(ad) and Jr^-1 = I + ad/2 + k(ad). With k0 = k(lam) and k1 = k(i theta): D = -k1/s,
    D0 = k0/lam^2, K = (k0 - k1)/(lam^2 + s), T = Im k(z)/(lam theta), C = (k0 - Re k(z))/s,
    G = (K - Re(k(z)/z)/lam)/(2 s), H = ((Re k(z) - k1)/lam^2 - K)/s, F = (D - D0)/(lam^2 + s).
    ``lam = 0``: D, 1/12, D, 2 D + s E, D, -E/2, and so on, with (D, E) of ``inverse_jacobian``.
    """
    if algebra_of(lam, s).exact:
        module = _similarity_forms()
        return module.evaluate(module.similarity_logarithm_forms(), lam, s)
    return similarity_doubles.similarity_logarithm(lam, s)
