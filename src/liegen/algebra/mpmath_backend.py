"""mpmath numbers at the working precision of ``mpmath.mp``: exact closed forms to any number of digits."""

from __future__ import annotations

import importlib
from typing import Any

from .base import Algebra

mp: Any = importlib.import_module("mpmath").mp  # ships no type information


def _select(condition: Any, a: Any, b: Any) -> Any:
    return a if condition else b


def _lt(a: Any, b: Any) -> bool:
    return bool(a < b)


def _le(a: Any, b: Any) -> bool:
    return bool(a <= b)


def _and(a: Any, b: Any) -> bool:
    return bool(a and b)


def _or(a: Any, b: Any) -> bool:
    return bool(a or b)


def _not(a: Any) -> bool:
    return not a


def _guarded(name: str) -> Any:
    """A real function that is NaN outside its real domain, as in C."""
    function = getattr(mp, name)

    def real(x: Any) -> Any:
        try:
            value = function(x)
        except (ValueError, ZeroDivisionError):
            return mp.nan
        return value if isinstance(value, mp.mpf) else mp.nan

    return real


BACKEND = Algebra(
    name="mpmath",
    exact=True,
    constant=mp.mpf,
    functions={
        **{
            name: _guarded(name)
            for name in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log")
        },
        "abs": abs,
        "atan2": mp.atan2,
        "lt": _lt,
        "le": _le,
        "and": _and,
        "or": _or,
        "not": _not,
        "select": _select,
    },
)
