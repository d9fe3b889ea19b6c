"""CasADi SX: the scalar graph that is differentiated and lowered to a program."""

from __future__ import annotations

import importlib
from typing import Any

from .base import Algebra

ca: Any = importlib.import_module("casadi")  # ships no type information

BACKEND = Algebra(
    name="casadi",
    exact=False,
    constant=ca.SX,
    functions={
        "sqrt": ca.sqrt, "sin": ca.sin, "cos": ca.cos, "tan": ca.tan, "asin": ca.asin, "acos": ca.acos,
        "atan": ca.atan, "exp": ca.exp, "log": ca.log, "abs": ca.fabs, "atan2": ca.atan2,
        "lt": ca.lt, "le": ca.le, "and": ca.logic_and, "or": ca.logic_or, "not": ca.logic_not,
        "select": ca.if_else,
    },
)  # fmt: skip
