"""The order within sums and products, for the shortest wait."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.program.kinds import kinds
from liegen.program.program import FREE, Program

from .dead_code import dead
from .shared_terms import Work
from .sign_sharing import signs

#: Cycles until a result can be used, about the same on the processors of today; other operations take 3.
LATENCY: Mapping[str, int] = {
    "neg": 1, "abs": 1, "select": 2, "div": 13, "sqrt": 18, "exp": 40, "log": 40, "sin": 40, "cos": 40,
    "tan": 60, "asin": 40, "acos": 40, "atan": 40, "atan2": 60,
}  # fmt: skip


def early(program: Program) -> Program:
    """Let sums and products take first what is ready first.

    The program is returned where its longest chain gets no shorter, or where there would be more operations,
    or more instructions (a b + c is one).
    """
    program = dead(program)
    work = Work(program)
    ready = _ready(work)
    for groups in (work.sums, work.products):
        for n, own in groups.items():
            if len(own) > 2:
                groups[n] = sorted(own, key=lambda term: (ready[term[0]], term))
    found = signs(work.emitted())
    no_worse = found.operations <= program.operations and _instructions(found) <= _instructions(program)
    return found if no_worse and critical_path(found) < critical_path(program) else program


def _instructions(program: Program) -> int:
    return program.operations - kinds(program)["fused"]


def _ready(work: Work) -> dict[int, int]:
    """When each node is ready, its sums and products in the order of its operands' times."""
    ready: dict[int, int] = {}
    for root in (*work.conditions, *[n for n, _ in work.results]):
        stack = [root]
        while stack:
            n = stack[-1]
            missing = [m for m, _ in work.operands(n) if m not in ready]
            if missing:
                stack += missing
                continue
            stack.pop()
            op = work.nodes[n].op
            own = sorted(ready[m] for m, _ in work.operands(n))
            if op in FREE:
                ready[n] = 0
            elif len(own) > 2 and op in ("add", "mul"):
                time = own[0]
                for t in own[1:]:
                    time = max(time, t) + 3
                ready[n] = time
            else:
                ready[n] = max(own) + LATENCY.get(op, 3)
    return ready


def critical_path(program: Program) -> int:
    """Cycles from the inputs to the last result, were nothing in the way."""
    times: list[int] = []
    for ins in program.code:
        start = max((times[a] for a in ins.args), default=0)
        times.append(start if ins.op in FREE else start + LATENCY.get(ins.op, 3))
    return max((times[k] for indices in program.results for k in indices), default=0)
