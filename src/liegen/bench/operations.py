"""Arithmetic in C++ text, by kind: for generators that write only a total, or none."""

from __future__ import annotations

import re
from collections import Counter

#: Calls that are one instruction; every other function of std is a call of the library.
SIMPLE = {"fabs": "abs", "abs": "abs", "sqrt": "sqrt", "min": "compare", "max": "compare", "copysign": "sign"}
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_STATEMENT = re.compile(r"=(?!=)([^;]*);")
_POWER = re.compile(r"std::pow\((\w+), Scalar\((\d+)\)\)")
_CONSTANT = re.compile(r"\(?Scalar\(-?[\d.eE+-]+\)( / Scalar\([\d.eE+-]+\)\))?|\d+\.?\d*(?:e[+-]?\d+)?")
_CALL = re.compile(r"std::(\w+)")
_TOKEN = re.compile(r"[A-Za-z_]\w*|<=|>=|<|>|[-+*/()]")


def counted(text: str) -> dict[str, int]:
    """Operations on the right of the assignments of a C++ function, constants folded.

    ``std::pow`` with a small integer counts as its multiplications; a sign before a value is a negation.
    """
    body = _COMMENT.sub("", text).partition("{\n")[2]
    counts: Counter[str] = Counter()
    for match in _STATEMENT.finditer(body[body.find(") {") :]):
        counts.update(_of(" ".join(match.group(1).split())))
    return dict(sorted((kind, n) for kind, n in counts.items() if n))


def _of(expression: str) -> Counter[str]:
    counts: Counter[str] = Counter()
    for match in _POWER.finditer(expression):
        power = int(match[2])
        counts["mul"] += power.bit_length() + power.bit_count() - 2
    plain = _CONSTANT.sub("k", _POWER.sub("p", expression))
    plain = re.sub(r"std::(min|max)<Scalar>", r"std::\1", plain)
    for match in _CALL.finditer(plain):
        counts[SIMPLE.get(match[1], match[1])] += 1
    before = "("
    for token in _tokens(_CALL.sub("", plain)):
        if token in "+-" and before in "(+-*/<>=":
            counts["neg"] += token == "-"
        elif token in _KINDS:
            counts[_KINDS[token]] += 1
        before = token
    return counts


def _tokens(expression: str) -> list[str]:
    return [match.group(0) for match in _TOKEN.finditer(expression)]


_KINDS = {"+": "add", "-": "sub", "*": "mul", "/": "div", "<": "lt", ">": "lt", "<=": "lt", ">=": "lt"}
