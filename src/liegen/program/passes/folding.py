"""Constant folding and the identities of 0, 1 and -1."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from liegen.program.program import Instruction, Program
from liegen.program.rewrite import Builder, rebuilt

from .dead_code import dead


def fold(program: Program) -> Program:
    """Fold constants and x + 0, x - x, x * 0, x * 1, x / 2^k, -(-x), selects that are decided.

    ``x * 0`` and ``0 / x`` become 0 and ``x - x`` becomes 0: a zero factor is structure, values are taken
    to be finite. ``x / c`` becomes a product only for a power of two, where that is exact. A comparison of
    constants stays an instruction (a condition is never a constant), but what it decides is folded.
    The count never grows. Idempotent together with CSE and dead code removal.
    """
    state = _Folding(Builder())
    builder, place = state.builder, list[int]()
    code = builder.code
    for ins in program.code:
        op, operands, _ = ins
        found = None
        if op in _BINARY:  # two different numbers, none of them a constant, have no rule
            a, b = place[operands[0]], place[operands[1]]
            if a == b or code[a].op == "const" or code[b].op == "const":
                found = _RULES[op](state, op, (a, b))
        elif op in _RULES:
            found = _RULES[op](state, op, tuple([place[a] for a in operands]))
        place.append(builder.moved(ins, place) if found is None else found)
    return dead(rebuilt(program, builder.code, place))


_BINARY = frozenset({"add", "sub", "mul", "div"})


@dataclass(frozen=True)
class _Folding:
    """The new code, and the conditions whose outcome is known."""

    builder: Builder
    decided: dict[int, bool] = field(default_factory=dict[int, bool])

    def value(self, i: int) -> float | None:
        return self.builder.value(i)

    def at(self, i: int) -> Instruction:
        return self.builder.code[i]

    def decide(self, op: str, args: tuple[int, ...], outcome: bool) -> int:
        """Remember the outcome of a condition that stays an instruction."""
        i = self.builder.share(op, args)
        self.decided[i] = outcome
        return i


def _quotient(a: float, b: float) -> float:
    return a / b


_ARITHMETIC: Mapping[str, Any] = {
    **{"add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": _quotient},
    **{"neg": operator.neg, "abs": math.fabs, "sqrt": math.sqrt, "exp": math.exp, "log": math.log},
    **{"sin": math.sin, "cos": math.cos, "tan": math.tan, "atan2": math.atan2},
    **{"asin": math.asin, "acos": math.acos, "atan": math.atan},
}


def _constant(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    """The constant that an operation on constants gives, if that is a finite number."""
    values = [p.builder.value(a) for a in args]
    if None in values:
        return None
    try:
        value = _ARITHMETIC[op](*values)
    except (ValueError, ZeroDivisionError, OverflowError):
        return None
    return p.builder.const(value) if math.isfinite(value) else None


def _add(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    a, b = args
    if p.value(a) == 0.0:
        return b
    if p.value(b) == 0.0:
        return a
    if a == b:  # a constant factor carries a sign for nothing, and shares with other doubles
        return _product(p, p.builder.const(2.0), a)
    return _constant(p, op, args)


def _sub(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    a, b = args
    if a == b:
        return p.builder.const(0.0)
    if p.value(b) == 0.0:
        return a
    if p.value(a) == 0.0:
        return _negated(p, b)
    return _constant(p, op, args)


def _negated(p: _Folding, a: int) -> int:
    """Minus a, with what _neg folds."""
    found = _neg(p, "neg", (a,))
    return p.builder.share("neg", (a,)) if found is None else found


def _neg(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    inner = p.at(args[0])
    return inner.args[0] if inner.op == "neg" else _constant(p, op, args)


def power_of_two(value: float | None) -> bool:
    """Whether a product with this number is exact (short of overflow)."""
    return value is not None and math.isfinite(value) and abs(math.frexp(value)[0]) == 0.5


def _mul(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    for c, x in (args, args[::-1]):
        value = p.value(c)
        if value == 0.0:
            return c
        if value == 1.0:
            return x
        if value == -1.0:
            return _negated(p, x)
        inner = p.at(x)
        if value is not None and inner.op == "mul":
            for k, y in (inner.args, inner.args[::-1]):
                if p.value(k) is not None and (power_of_two(value) or power_of_two(p.value(k))):
                    product = _constant(p, "mul", (c, k))  # exact, so the order of the factors is free
                    if product is not None:
                        return _product(p, product, y)
    return _constant(p, op, args)


def _product(p: _Folding, c: int, x: int) -> int:
    """The product c x, with what _mul folds."""
    found = _mul(p, "mul", (c, x))
    return p.builder.share("mul", (c, x)) if found is None else found


def _div(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    a, b = args
    if p.value(a) == 0.0 and p.value(b) != 0.0:
        return a
    value = p.value(b)
    if value is not None and power_of_two(value):
        return _product(p, p.builder.const(1.0 / value), a)
    return _constant(p, op, args)


def _select(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    c, a, b = args
    if c in p.decided:
        return a if p.decided[c] else b
    # an arm that asks the same condition again is decided there
    one, two = p.at(a), p.at(b)
    a = one.args[1] if one.op == "select" and one.args[0] == c else a
    b = two.args[2] if two.op == "select" and two.args[0] == c else b
    if a == b:
        return a
    if p.at(c).op == "not":
        return p.builder.share(op, (p.at(c).args[0], b, a))
    return p.builder.share(op, (c, a, b))


def _compare(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    a, b = p.value(args[0]), p.value(args[1])
    if a is not None and b is not None:
        return p.decide(op, args, a < b or (op == "le" and a == b))
    return p.decide(op, args, False) if op == "lt" and args[0] == args[1] else None


def _junction(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    if args[0] == args[1]:
        return args[0]
    for c, other in (args, args[::-1]):
        if c in p.decided:  # "and" is decided by a False, "or" by a True
            return c if p.decided[c] == (op == "or") else other
    return None


def _not(p: _Folding, op: str, args: tuple[int, ...]) -> int | None:
    inner = p.at(args[0])
    if inner.op == "not":
        return inner.args[0]
    return p.decide(op, args, not p.decided[args[0]]) if args[0] in p.decided else None


_RULES: Mapping[str, Callable[[_Folding, str, tuple[int, ...]], int | None]] = {
    **dict.fromkeys(_ARITHMETIC, _constant),
    "add": _add, "sub": _sub, "mul": _mul, "div": _div, "neg": _neg,
    "select": _select, "lt": _compare, "le": _compare, "and": _junction, "or": _junction, "not": _not,
}  # fmt: skip
