"""How a language spells an operation, and the fewest parentheses that keep its operands apart."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

#: Binding strengths shared by the languages: what needs no parentheses anywhere, down to a choice ``?:``.
ATOM, PREFIX, PRODUCT, SUM, COMPARISON, CHOICE = 100, 90, 80, 70, 50, 0

_OPPOSITE: Mapping[str, str] = {"add": "sub", "sub": "add"}


class Operator(NamedTuple):
    """A prefix or infix operator. Chains within one ``family`` associate to the left."""

    symbol: str
    binding: int
    family: str = ""


class Expression(NamedTuple):
    """Text, how strongly its outermost operator binds, that operator's family, and whether it is a number."""

    text: str
    binding: int = ATOM
    family: str = ""
    number: bool = False


@dataclass(frozen=True)
class Syntax:
    """How a language spells the operations of a program.

    ``choice`` is the format of a select where it is no call: ``"{0} ? {1} : {2}"``. ``lift`` is the format of
    a number where the language takes no plain one: as an argument of a call and as a result. ``sincos``
    is the format of a call for both functions of an angle: ``"sincos({0}, &{1}, &{2})"``.
    """

    operators: Mapping[str, Operator]
    calls: Mapping[str, str]
    constant: Callable[[float], str]
    truth: Mapping[bool, str]
    choice: str = ""
    lift: str = ""
    sincos: str = ""

    def express(self, op: str, operands: Sequence[Expression]) -> Expression:
        """The text of one operation."""
        operator = self.operators.get(op)
        if operator is None:
            if op == "select" and self.choice:
                arms = [_wrap(x, x.binding > CHOICE) for x in operands]
                return Expression(self.choice.format(*arms), CHOICE)
            return Expression(f"{self.calls[op]}({', '.join([self.result(x) for x in operands])})")
        symbol, binding, family = operator
        last = operands[-1]
        if last.family == "negative" and op in _OPPOSITE:  # a + (-c) is a - c, to the last bit
            return self.express(_OPPOSITE[op], [operands[0], Expression(last.text[1:])])
        if len(operands) == 1:
            return Expression(symbol + _wrap(last, last.binding > binding), binding, family)
        first = operands[0]
        chain = first.binding == binding and first.family == family != ""
        left = first.text if chain or first.binding > binding else f"({first.text})"
        # A term or factor that starts with a minus sign is legal bare, but reads badly.
        signed = binding >= SUM and last.text.startswith("-")
        right = last.text if last.binding > binding and not signed else f"({last.text})"
        return Expression(f"{left} {symbol} {right}", binding, family)

    def result(self, operand: Expression) -> str:
        """The text of an operand that stands alone."""
        return self.lift.format(operand.text) if self.lift and operand.number else operand.text

    def literal(self, value: float | bool) -> Expression:
        """A constant, by the shortest text that reads back as the same number."""
        if isinstance(value, bool):
            return Expression(self.truth[value])
        text = self.constant(value)
        return (
            Expression(text, PREFIX, "negative", True)
            if text.startswith("-")
            else Expression(text, number=True)
        )


def _wrap(operand: Expression, bare: bool) -> str:
    return operand.text if bare else f"({operand.text})"


def spell(nan: str, infinity: str) -> Callable[[float], str]:
    """A printer of float constants; finite ones always have a decimal point or an exponent."""
    special = {"nan": nan, "inf": infinity, "-inf": f"-{infinity}"}
    return lambda value: special.get(repr(float(value)), repr(float(value)))
