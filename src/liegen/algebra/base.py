"""What a scalar type can do beyond ``+ - * /``: one frozen record per scalar backend."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

#: A float, a NumPy array, an mpmath number, a SymPy expression or a CasADi SX.
Scalar = Any

#: The names that every backend defines, with their number of arguments.
FUNCTIONS: Mapping[str, int] = {
    "sqrt": 1, "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "exp": 1, "log": 1, "abs": 1,
    "atan2": 2, "lt": 2, "le": 2, "and": 2, "or": 2, "not": 1, "select": 3,
}  # fmt: skip


@dataclass(frozen=True)
class Algebra:
    """A scalar backend.

    ``exact`` backends (mpmath, SymPy) evaluate coefficient functions by their closed form, the others
    by the polynomials of :mod:`liegen.coefficients`. ``constant`` lifts a Python float.
    """

    name: str
    exact: bool
    functions: Mapping[str, Callable[..., Scalar]]
    constant: Callable[[float], Scalar]

    def __post_init__(self) -> None:
        missing = FUNCTIONS.keys() - self.functions.keys()
        if missing:
            raise TypeError(f"backend {self.name} lacks {sorted(missing)}")
