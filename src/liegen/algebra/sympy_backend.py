"""SymPy expressions: to show closed forms and to prove identities of the groups."""

from __future__ import annotations

import importlib
from typing import Any

from .base import Algebra

sp: Any = importlib.import_module("sympy")  # ships no type information


def _select(condition: Any, a: Any, b: Any) -> Any:
    return sp.Piecewise((a, condition), (b, True))


BACKEND = Algebra(
    name="sympy",
    exact=True,
    constant=sp.nsimplify,
    functions={
        "sqrt": sp.sqrt, "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "asin": sp.asin, "acos": sp.acos,
        "atan": sp.atan, "exp": sp.exp, "log": sp.log, "abs": sp.Abs, "atan2": sp.atan2,
        "lt": sp.Lt, "le": sp.Le, "and": sp.And, "or": sp.Or, "not": sp.Not,
        "select": _select,
    },
)  # fmt: skip
