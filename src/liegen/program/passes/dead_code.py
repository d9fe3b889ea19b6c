"""Dead code: what no output and no requirement needs is left out."""

from __future__ import annotations

from liegen.program.program import Instruction, Program
from liegen.program.rewrite import rebuilt, roots


def dead(program: Program) -> Program:
    """Keep, in order, the instructions that an output or a requirement depends on. Idempotent."""
    live = [False] * len(program.code)
    for i in roots(program):
        live[i] = True
    for k in range(len(program.code) - 1, -1, -1):
        if live[k]:
            for a in program.code[k].args:
                live[a] = True
    if all(live):
        return program
    place = [0] * len(program.code)
    code: list[Instruction] = []
    for k, ins in enumerate(program.code):
        if live[k]:
            place[k] = len(code)
            code.append(Instruction(ins.op, tuple([place[a] for a in ins.args]), ins.value))
    return rebuilt(program, code, place)
