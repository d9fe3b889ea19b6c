"""The transcendental scalars of the Lie groups, each once, as a SymPy expression; and their exact evaluation.

Sources: K. Stumpff, Himmelsmechanik I (1959), for c_k; Sola, Deray, Atchuthan, "A micro Lie theory" (2018),
equations (143) to (147) and (174) to (179), for the Jacobians in which c_k, D and E occur.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

sp: Any = importlib.import_module("sympy")  # ships no type information
mp: Any = importlib.import_module("mpmath").mp

S: Any = sp.Symbol("s", positive=True)
W: Any = sp.Symbol("w", positive=True)


@dataclass(frozen=True)
class ClosedForm:
    """An expression in one symbol whose singularity at ``point`` is removable.

    Evaluating it at a distance d from ``point`` cancels about ``order * log2(1/d)`` bits.
    """

    name: str
    symbol: Any
    expression: Any
    point: int
    order: int


@cache
def stumpff_form(k: int) -> ClosedForm:
    """c_k(s) = sum_j (-s)^j / (2j + k)!, by c_{k+2} = (1/k! - c_k) / s from cos and sin."""
    theta = sp.sqrt(S)
    if k < 2:
        return ClosedForm(f"c{k}", S, (sp.cos(theta), sp.sin(theta) / theta)[k], 0, 1)
    lower = stumpff_form(k - 2).expression
    return ClosedForm(f"c{k}", S, (1 / sp.factorial(k - 2) - lower) / S, 0, k // 2 + 1)


@cache
def remainder_form(k: int) -> ClosedForm:
    """p_k(x) = sum_j (-x)^j / (j + k)!, by p_{k+1} = (1/k! - p_k) / x from e^-x; x of either sign."""
    if k == 0:
        return ClosedForm("p0", S, sp.exp(-S), 0, 0)
    lower = remainder_form(k - 1).expression
    return ClosedForm(f"p{k}", S, (1 / sp.factorial(k - 1) - lower) / S, 0, k)


@cache
def inverse_form() -> ClosedForm:
    """D(s), the coefficient of [phi]x^2 in Jr^-1(phi); poles at theta = 2 pi n, n >= 1."""
    half = sp.sqrt(S) / 2
    return ClosedForm("D", S, (1 - half * sp.cot(half)) / S, 0, 2)


@cache
def inverse_derivative_form() -> ClosedForm:
    """E = 2 dD/ds."""
    return ClosedForm("E", S, 2 * sp.diff(inverse_form().expression, S), 0, 3)


@cache
def log_form() -> ClosedForm:
    """The factor from a unit quaternion to its logarithm, theta/sin(theta/2), in w = cos(theta/2)."""
    return ClosedForm("log_factor", W, 2 * sp.acos(W) / sp.sqrt(1 - W**2), 1, 1)


@cache
def limit(form: ClosedForm) -> Any:
    """The form's value at its removable singularity, a SymPy rational, from its series there."""
    t: Any = sp.Symbol("t", positive=True)
    # With s = t^2 and w = cos(t) the forms become meromorphic in t, which SymPy expands without branches.
    inner = t**2 if form.point == 0 else sp.cos(t)
    expression = sp.simplify(form.expression.subs(form.symbol, inner).subs(sp.acos(sp.cos(t)), t))
    expression = expression.subs(sp.Abs(sp.sin(t)), sp.sin(t))
    return sp.series(expression, t, 0, 2).removeO().coeff(t, 0)


@cache
def _compiled(forms: tuple[ClosedForm, ...]) -> Callable[[Any], list[Any]]:
    expressions = [form.expression for form in forms]
    return sp.lambdify(forms[0].symbol, expressions, modules="mpmath", cse=True)


def _numbers(forms: tuple[ClosedForm, ...], x: Any) -> tuple[Any, ...]:
    point = forms[0].point
    if x == point:
        return tuple(mp.mpf(value.p) / value.q for value in map(limit, forms))
    if not mp.isfinite(x):
        return tuple(mp.nan for _ in forms)
    distance = max(0, -mp.mag(mp.fsub(x, point, exact=True)))
    lost = max(form.order for form in forms) * distance
    with mp.workprec(mp.prec + 24 + lost):
        values = _compiled(forms)(x)
    # The logarithm's factor beyond w = 1 is a quotient of two imaginary numbers.
    return tuple(+mp.re(value) for value in values)


def evaluate(forms: tuple[ClosedForm, ...], x: Any) -> tuple[Any, ...]:
    """The forms at ``x``: mpmath numbers right to the working precision, or SymPy expressions."""
    if not isinstance(x, sp.Basic):
        return _numbers(forms, x)
    if x == forms[0].point:
        return tuple(map(limit, forms))
    return tuple(form.expression.subs(form.symbol, x) for form in forms)


def stumpff(s: Any, upto: int) -> tuple[Any, ...]:
    """(c_0, ..., c_upto) at s = theta^2."""
    return evaluate(tuple(map(stumpff_form, range(upto + 1))), s)


def log_factor(w: Any) -> Any:
    """2 acos(w) / sqrt(1 - w^2)."""
    return evaluate((log_form(),), w)[0]


def inverse_jacobian(s: Any) -> tuple[Any, Any]:
    """(D, E) at s = theta^2."""
    d, e = evaluate((inverse_form(), inverse_derivative_form()), s)
    return d, e
