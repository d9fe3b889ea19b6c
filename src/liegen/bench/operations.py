"""Arithmetic in C++ text, by kind: for generators that write only a total, or none."""

from __future__ import annotations

import re
from collections import Counter

#: Functions that are an instruction or two; every other function of std is a call of the library.
SIMPLE = {"fabs": "abs", "abs": "abs", "sqrt": "sqrt", "min": "compare", "max": "compare", "copysign": "sign"}
KINDS = {"+": "add", "-": "sub", "*": "mul", "/": "div", "<": "lt", ">": "lt", "<=": "lt", ">=": "lt"}
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_SIGNATURE = re.compile(r"\)\s*\{\n")
_STATEMENT = re.compile(r"(?<![<>=!])=(?!=)([^;]*);")
_TEMPLATE = re.compile(r"<Scalar>")
_NUMBER = r"\d+\.?\d*(?:[eE][+-]?\d+)?"
_CAST = re.compile(rf"\bScalar\((-?{_NUMBER})\)")
_FRACTION = re.compile(rf"(?<![\w.])-?{_NUMBER} / {_NUMBER}(?![\w.])")
_POWER = re.compile(r"std::pow\(([\w:]+), (\d+)\)")
_TOKEN = re.compile(rf"{_NUMBER}|[A-Za-z_][\w:]*|<=|>=|[-+*/<>(),]")


def counted(text: str) -> dict[str, int]:
    """Operations on the right of the assignments of a C++ function, constants folded.

    ``std::pow`` with a small integer counts as its multiplications; a sign before a value is a negation.
    """
    body = _SIGNATURE.split(_COMMENT.sub("", text), maxsplit=1)[-1]
    counts: Counter[str] = Counter()
    for match in _STATEMENT.finditer(body):
        counts.update(_of(" ".join(match[1].split())))
    return dict(sorted((kind, n) for kind, n in counts.items() if n))


def _of(expression: str) -> Counter[str]:
    plain = _FRACTION.sub("1", _CAST.sub(r"\1", _TEMPLATE.sub("", expression)))
    counts: Counter[str] = Counter()
    for match in _POWER.finditer(plain):
        power = int(match[2])
        counts["mul"] += power.bit_length() + power.bit_count() - 2
    before = "("
    for match in _TOKEN.finditer(_POWER.sub("p", plain)):
        token = match[0]
        if token.startswith("std::"):
            name = token.removeprefix("std::")
            counts[SIMPLE.get(name, name)] += 1
        elif token in "+-" and before in ("(", ",", "+", "-", "*", "/", "<", ">", "<=", ">="):
            counts["neg"] += token == "-"
        elif token in KINDS:
            counts[KINDS[token]] += 1
        before = token
    return counts
