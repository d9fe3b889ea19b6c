"""CasADi SX: the scalar graph that is differentiated and lowered to a program.

CasADi's Python operators look for a matrix among the operands, and among the conversions to one, before they
find that two scalars meet: ten microseconds an operation. :class:`Scalar` names the operation instead, which
gives the same node of the graph in one.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

from .base import Algebra

ca: Any = importlib.import_module("casadi")  # ships no type information
_unary: Callable[..., Any] = ca.SX.unary
_binary: Callable[..., Any] = ca.SX.binary


def scalar(x: Any) -> Any:
    """A number, or an SX of one entry, as a :class:`Scalar`."""
    found = x if isinstance(x, ca.SX) else ca.SX(x)
    found.__class__ = Scalar
    return found


def symbol(name: str) -> Any:
    """A fresh scalar."""
    return scalar(ca.SX.sym(name))


def _operator(code: int, *, reflected: bool = False) -> Callable[..., Any]:
    """The method of a binary operation on scalars."""

    def forward(a: Any, b: Any) -> Any:
        found = _binary(code, a, b)
        found.__class__ = Scalar
        return found

    def backward(b: Any, a: Any) -> Any:
        found = _binary(code, a, b)
        found.__class__ = Scalar
        return found

    return backward if reflected else forward


def _function(code: int) -> Callable[[Any], Any]:
    """A function of one scalar."""

    def applied(x: Any) -> Any:
        found = _unary(code, x)
        found.__class__ = Scalar
        return found

    return applied


def _select(condition: Any, a: Any, b: Any) -> Any:
    """As ``ca.if_else``."""
    return _if_else_zero(condition, a) + _if_else_zero(_not(condition), b)


class Scalar(ca.SX):
    """An SX of one entry; every function of CasADi takes it."""

    __module__ = ca.__name__  # by which liegen.algebra knows whose scalar it is
    __add__, __radd__ = _operator(ca.OP_ADD), _operator(ca.OP_ADD, reflected=True)
    __sub__, __rsub__ = _operator(ca.OP_SUB), _operator(ca.OP_SUB, reflected=True)
    __mul__, __rmul__ = _operator(ca.OP_MUL), _operator(ca.OP_MUL, reflected=True)
    __truediv__, __rtruediv__ = _operator(ca.OP_DIV), _operator(ca.OP_DIV, reflected=True)
    __neg__ = _function(ca.OP_NEG)


_not = _function(ca.OP_NOT)
_if_else_zero = _operator(ca.OP_IF_ELSE_ZERO)
BACKEND = Algebra(
    name="casadi",
    exact=False,
    constant=scalar,
    functions={
        "sqrt": _function(ca.OP_SQRT), "sin": _function(ca.OP_SIN), "cos": _function(ca.OP_COS),
        "tan": _function(ca.OP_TAN), "asin": _function(ca.OP_ASIN), "acos": _function(ca.OP_ACOS),
        "atan": _function(ca.OP_ATAN), "exp": _function(ca.OP_EXP), "log": _function(ca.OP_LOG),
        "abs": _function(ca.OP_FABS), "atan2": _operator(ca.OP_ATAN2),
        "lt": _operator(ca.OP_LT), "le": _operator(ca.OP_LE),
        "and": _operator(ca.OP_AND), "or": _operator(ca.OP_OR), "not": _not,
        "select": _select,
    },
)  # fmt: skip
