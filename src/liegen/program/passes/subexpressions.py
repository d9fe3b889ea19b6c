"""Common subexpressions, across all outputs: equal operations on equal operands are done once."""

from __future__ import annotations

from liegen.program.program import Program
from liegen.program.rewrite import Builder, rebuilt


def cse(program: Program) -> Program:
    """Share equal instructions; a + b equals b + a. Bit for bit the same values. Idempotent."""
    builder = Builder()
    place: list[int] = []
    for ins in program.code:
        place.append(builder.moved(ins, place))
    return rebuilt(program, builder.code, place)
