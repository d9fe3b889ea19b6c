"""The order of sums, for machines with fused multiply-add."""

from __future__ import annotations

from liegen.program.kinds import fused
from liegen.program.program import Program

from .dead_code import dead
from .shared_terms import Work
from .sign_sharing import signs


def contract(program: Program) -> Program:
    """Let sums begin with what is no product, so that each product goes with an addition as a b + c.

    e + a b + c d is two instructions with fused multiply-add, a b + c d + e is three. The program is
    returned where no more pairs are found, or where there would be more operations.
    """
    program = dead(program)
    work = Work(program)
    for n, own in work.sums.items():
        if len(own) > 2:
            work.sums[n] = sorted(own, key=work.contractible)
    before = fused(program)
    if work.fused() <= before:  # without looking further
        return program
    found = signs(work.emitted())
    better = fused(found) > before
    return found if better and found.operations <= program.operations else program
