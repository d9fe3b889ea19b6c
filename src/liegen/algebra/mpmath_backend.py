"""mpmath numbers at the working precision of ``mpmath.mp``: exact closed forms to any number of digits."""

from __future__ import annotations

from typing import Any

import mpmath

from .base import Algebra

mp: Any = mpmath.mp


def _select(condition: Any, a: Any, b: Any) -> Any:
    return a if condition else b


def _guarded(name: str) -> Any:
    """A real function that is NaN outside its real domain, as in C."""
    function = getattr(mp, name)

    def real(x: Any) -> Any:
        try:
            value = function(x)
        except (ValueError, ZeroDivisionError):
            return mp.nan
        return value if isinstance(value, mpmath.mpf) else mp.nan

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
        "lt": lambda a, b: bool(a < b),
        "le": lambda a, b: bool(a <= b),
        "and": lambda a, b: bool(a and b),
        "or": lambda a, b: bool(a or b),
        "not": lambda a: not a,
        "select": _select,
    },
)
