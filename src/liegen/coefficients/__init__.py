"""The transcendental scalar functions of the Lie groups, for every scalar backend.

mpmath numbers and SymPy expressions get the closed forms; floats, arrays and SX get polynomials (and selects)
derived from those by :mod:`liegen.coefficients.fit`, a few units in the last place from the exact value.
"""

from __future__ import annotations

import importlib
from typing import Any

from liegen.algebra import Scalar, algebra_of

from . import evaluate

_LAST = (1, 3, 5)


def _closed_forms() -> Any:
    """Loaded on first use: it needs SymPy, which takes long to start."""
    return importlib.import_module(".closed_forms", __name__)


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
