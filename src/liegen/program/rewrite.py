"""What the lowering and the passes share: a list of instructions under construction, and rebuilt programs."""

from __future__ import annotations

import gc
from collections.abc import Generator, Sequence
from contextlib import contextmanager

from .program import COMMUTATIVE, Instruction, Program, Requirement, instruction


@contextmanager
def uncollected() -> Generator[None]:
    """Without the search for reference cycles: derivation makes many tuples, which set it off, and no cycles.

    The search goes through all that the process holds, and took a quarter of the time that large factors
    take. Where it was off, it stays off.
    """
    searching = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if searching:
            gc.enable()


class Builder:
    """Instructions under construction: ``emit`` appends, ``share`` first looks for an equal one."""

    def __init__(self) -> None:
        self.code: list[Instruction] = []
        self._index: dict[Instruction, int] = {}

    def emit(self, op: str, args: tuple[int, ...] = (), value: float = 0.0) -> int:
        """Append an instruction, return its index."""
        self.code.append(instruction((op, args, value)))
        return len(self.code) - 1

    def share(self, op: str, args: tuple[int, ...] = (), value: float = 0.0) -> int:
        """Return the instruction equal to this one (commutative operands in any order), appended if new."""
        if op in COMMUTATIVE and args[0] > args[1]:
            args = (args[1], args[0])
        ins = instruction((op, args, value))
        found = self._index.setdefault(ins, len(self.code))
        if found == len(self.code):
            self.code.append(ins)
        return found

    def moved(self, ins: Instruction, place: Sequence[int]) -> int:
        """``share`` of an instruction whose operands are in new places; the same value where they are not."""
        op, args, value = ins
        now = tuple([place[a] for a in args])
        if op in COMMUTATIVE and now[0] > now[1]:
            now = (now[1], now[0])
        if now != args:
            ins = instruction((op, now, value))
        found = self._index.setdefault(ins, len(self.code))
        if found == len(self.code):
            self.code.append(ins)
        return found

    def const(self, value: float) -> int:
        """Return the constant, appended if new; -0.0 is 0.0."""
        return self.share("const", (), value + 0.0)

    def value(self, index: int) -> float | None:
        """Return the number of a constant, None for any other instruction."""
        ins = self.code[index]
        return ins.value if ins.op == "const" else None


def rebuilt(program: Program, code: Sequence[Instruction], place: Sequence[int]) -> Program:
    """Return ``program`` on new code; ``place[i]`` is where the value of the old instruction i now is."""
    return Program(
        program.name,
        program.inputs,
        program.outputs,
        tuple(code),
        tuple([tuple([place[i] for i in indices]) for indices in program.results]),
        tuple([Requirement(place[r.condition], r.message) for r in program.requirements]),
    )


def roots(program: Program) -> list[int]:
    """Instructions that must be kept: outputs in order, then requirements."""
    return [
        *(i for indices in program.results for i in indices),
        *(r.condition for r in program.requirements),
    ]


def use_counts(program: Program) -> list[int]:
    """How often each instruction is used by another one, an output or a requirement."""
    uses = [0] * len(program.code)
    for _, args, _ in program.code:
        for a in args:
            uses[a] += 1
    for i in roots(program):
        uses[i] += 1
    return uses


def needed(program: Program) -> bytearray:
    """For each instruction 1 where an output or a requirement depends on it, else 0."""
    live = bytearray(len(program.code))
    for i in roots(program):
        live[i] = 1
    k = len(live)
    for _, args, _ in reversed(program.code):
        k -= 1
        if live[k]:
            for a in args:
                live[a] = 1
    return live
