"""Divisions by one denominator share its reciprocal."""

from __future__ import annotations

from liegen.program.program import FREE, Program
from liegen.program.rewrite import Builder, rebuilt

#: What a division costs, in units of a product.
DIVISION = 4
#: From so many divisions by one denominator on, a reciprocal is worth an operation more.
WORTH = 3


def reciprocals(program: Program) -> Program:
    """Write x / b as x * (1 / b) where 1 / b is there already, or where at least three values are over b.

    The quotient is rounded twice instead of once. The count grows by at most one for a denominator with
    three or more divisions; the cost with a division counted as four products (:func:`cost`) never grows.
    Constant denominators are left alone. Idempotent.
    """
    code = program.code
    numerators: dict[int, list[int]] = {}
    for ins in code:
        if ins.op == "div" and code[ins.args[1]].op != "const":
            numerators.setdefault(ins.args[1], []).append(ins.args[0])
    shared = {
        b for b, found in numerators.items()
        if len(found) >= WORTH or (len(found) > 1 and any(_one(program, a) for a in found))
    }  # fmt: skip
    if not shared:
        return program
    builder = Builder()
    place: list[int] = []
    inverse: dict[int, int] = {}
    for ins in code:
        args = tuple([place[a] for a in ins.args])
        if ins.op == "div" and ins.args[1] in shared:
            b = ins.args[1]
            if b not in inverse:
                inverse[b] = builder.emit("div", (builder.const(1.0), args[1]))
            place.append(
                inverse[b] if _one(program, ins.args[0]) else builder.emit("mul", (args[0], inverse[b]))
            )
        elif ins.op in FREE:
            place.append(builder.share(ins.op, (), ins.value))
        else:
            place.append(builder.emit(ins.op, args))
    return rebuilt(program, builder.code, place)


def cost(program: Program) -> int:
    """Number of operations, a division counted as four."""
    return program.operations + (DIVISION - 1) * program.op_counts().get("div", 0)


def _one(program: Program, i: int) -> bool:
    ins = program.code[i]
    return ins.op == "const" and ins.value == 1.0
