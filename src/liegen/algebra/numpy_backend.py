"""Floats and NumPy arrays: the numbers that users hold, one element or a batch at a time."""

from __future__ import annotations

import numpy as np

from .base import Algebra

BACKEND = Algebra(
    name="numpy",
    exact=False,
    constant=np.float64,
    functions={
        "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos,
        "atan": np.arctan, "exp": np.exp, "log": np.log, "abs": np.abs, "atan2": np.arctan2,
        "lt": np.less, "le": np.less_equal, "and": np.logical_and, "or": np.logical_or,
        "not": np.logical_not, "select": np.where,
    },
)  # fmt: skip
