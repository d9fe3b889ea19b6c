"""The order within sums and products, for machines with fused multiply-add."""

from __future__ import annotations

from liegen.program.kinds import fused
from liegen.program.program import Program

from .arrival import critical_path, ready
from .dead_code import dead
from .shared_terms import Work
from .sign_sharing import signs


def contract(program: Program) -> Program:
    """Let sums begin with what is no product, and take first what is ready first; products too.

    e + a b + c d is two instructions with fused multiply-add, a b + c d + e is three. The program is
    returned where there would be no fewer instructions and no shorter longest chain of them, or more
    operations.
    """
    program = dead(program)
    work = Work(program)
    before, longest = fused(program), critical_path(program)
    times = ready(work)
    if work.fused() <= before and max(times[n] for n, _ in work.results) >= longest:
        return program  # without looking further
    for n, own in work.sums.items():
        if len(own) > 2:
            work.sums[n] = sorted(own, key=lambda term: (work.contractible(term), times[term[0]]))
    for n, own in work.products.items():
        if len(own) > 2:
            work.products[n] = sorted(own, key=lambda term: times[term[0]])
    found = signs(work.emitted())
    if found.operations > program.operations:
        return program
    cost = found.operations - fused(found), critical_path(found)
    return found if cost < (program.operations - before, longest) else program
