"""SymPy expressions: to show closed forms and to prove identities of the groups."""

from __future__ import annotations

from typing import Any

import sympy

from .base import Algebra

sp: Any = sympy

BACKEND = Algebra(
    name="sympy",
    exact=True,
    constant=sp.nsimplify,
    functions={
        "sqrt": sp.sqrt, "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "asin": sp.asin, "acos": sp.acos,
        "atan": sp.atan, "exp": sp.exp, "log": sp.log, "abs": sp.Abs, "atan2": sp.atan2,
        "lt": sp.Lt, "le": sp.Le, "and": sp.And, "or": sp.Or, "not": sp.Not,
        "select": lambda c, a, b: sp.Piecewise((a, c), (b, True)),
    },
)  # fmt: skip
