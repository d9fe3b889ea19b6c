"""Dead code: what no output and no requirement needs is left out."""

from __future__ import annotations

from liegen.program.program import Instruction, Program, instruction
from liegen.program.rewrite import needed, rebuilt


def dead(program: Program) -> Program:
    """Keep, in order, the instructions that an output or a requirement depends on. Idempotent."""
    live = needed(program)
    if all(live):
        return program
    place = [0] * len(live)
    code: list[Instruction] = []
    for k, ins in enumerate(program.code):
        if live[k]:
            place[k] = len(code)
            args = tuple([place[a] for a in ins.args])
            code.append(ins if args == ins.args else instruction((ins.op, args, ins.value)))
    return rebuilt(program, code, place)
