"""A factor or divisor that both terms of a sum, or both arms of a select, have is taken out."""

from __future__ import annotations

from liegen.program.program import Instruction, Program, instruction
from liegen.program.rewrite import rebuilt, use_counts

from .dead_code import dead
from .folding import power_of_two

_SUMS = frozenset({"add", "sub", "select"})


def factor(program: Program) -> Program:
    """The sum a b + a c becomes a (b + c), a / z - b / z becomes (a - b) / z.

    Only where neither term has another use. Also for a select between such terms, and for constants that
    differ by their sign. Each one saves an operation. The order of summation is kept: the result differs by
    rounding of the terms only. Powers of two move to the outside of a product, where they can be taken out.
    """
    code: list[Instruction] = []
    uses: list[int] = []
    place: list[int] = []
    before = use_counts(program)

    def emit(op: str, args: tuple[int, ...], used: int) -> int:
        code.append(Instruction(op, args))
        uses.append(used)
        return len(code) - 1

    def keep(k: int) -> int:
        op, args, value = ins = program.code[k]
        now = tuple([place[a] for a in args])
        code.append(ins if now == args else instruction((op, now, value)))
        uses.append(before[k])
        return len(code) - 1

    for k, (op, operands, _) in enumerate(program.code):
        found = hoisted = None
        if op in _SUMS:
            x, y = place[operands[-2]], place[operands[-1]]
            if x != y and uses[x] == uses[y] == 1 and code[x].op == code[y].op:
                found = _common(code, op, code[x], code[y])
        elif op == "mul":
            hoisted = _hoisted(code, uses, place[operands[0]], place[operands[1]])
        if found:
            inner, common, a, b = found
            shared = emit(inner, (*[place[c] for c in operands[:-2]], a, b), 1)
            place.append(emit(code[place[operands[-1]]].op, (shared, common), before[k]))
        elif hoisted:
            scale, a, b = hoisted
            place.append(emit("mul", (scale, emit("mul", (a, b), 1)), before[k]))
        else:
            place.append(keep(k))
    return dead(rebuilt(program, code, place))


def _hoisted(code: list[Instruction], uses: list[int], x: int, y: int) -> tuple[int, int, int] | None:
    """(c, a, b) with x y = c (a b), for a power of two c: that is exact."""
    for one, other in ((x, y), (y, x)):
        if code[one].op == "mul" and uses[one] == 1:
            for c, a in (code[one].args, code[one].args[::-1]):
                if code[c].op == "const" and power_of_two(code[c].value) and code[other].op != "const":
                    return c, a, other
    return None


_OPPOSITE = {"add": "sub", "sub": "add"}


def _common(
    code: list[Instruction], op: str, one: Instruction, two: Instruction
) -> tuple[str, int, int, int] | None:
    """(op, common, a, b): the terms combined by ``op`` are ``op(a, b)`` times, or over, what they share."""
    if one.op == "div":
        return (op, one.args[1], one.args[0], two.args[0]) if one.args[1] == two.args[1] else None
    if one.op != "mul":
        return None
    for p, a in (one.args, one.args[::-1]):
        for q, b in (two.args, two.args[::-1]):
            if p == q:
                return op, p, a, b
            if op in _OPPOSITE and code[p].op == code[q].op == "const" and code[p].value == -code[q].value:
                return _OPPOSITE[op], p, a, b
    return None
