"""The scalar types that generated C computes in."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .printer import Assignment
from .syntax import spell


@dataclass(frozen=True)
class Precision:
    """A scalar type of C, and how constants are spelt. ``suffix``, ``libm``: ends of functions' names."""

    type: str
    suffix: str
    libm: str
    constant: Callable[[float], str]


_spell_double = spell("NAN", "INFINITY")


def _spell_single(value: float) -> str:
    with np.errstate(over="ignore", under="ignore"):
        rounded = np.float32(value)
    if not np.isfinite(rounded):
        return _spell_double(float(rounded))
    digits = np.format_float_positional if 1e-4 <= abs(rounded) < 1e8 else np.format_float_scientific
    return f"{digits(rounded, unique=True, trim='0')}f"


DOUBLE = Precision("double", "", "", _spell_double)
SINGLE = Precision("float", "_f32", "f", _spell_single)


def precisions(scalar: str) -> tuple[Precision, ...]:
    """What is emitted where ``scalar`` is chosen: double always, float too where it is asked for."""
    return (DOUBLE, SINGLE) if scalar == SINGLE.type else (DOUBLE,)


_STATEMENTS = {
    "scalar": "const {0} {2} = {3};",
    "condition": "const {1} {2} = {3};",
    "pair": "{0} {2}; {3};",
}


def statement(assignment: Assignment, number: str, condition: str) -> str:
    """An assignment in C, with the types of numbers and of conditions."""
    return _STATEMENTS[assignment.kind].format(number, condition, assignment.name, assignment.text)


_COMMENT_OR_WORD = re.compile(
    r"/\*.*?\*/|\bdouble\b|(?<![\w.])(?:\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])", re.DOTALL
)


def in_single(text: str) -> str:
    """C on doubles as the same on floats: the name of the type, and all numbers rounded; comments stay."""

    def replaced(found: re.Match[str]) -> str:
        word = found[0]
        if word.startswith("/*"):
            return word
        return SINGLE.type if word == DOUBLE.type else SINGLE.constant(float(word))

    return _COMMENT_OR_WORD.sub(replaced, text)
