"""When values are ready: estimates of the time that a processor waits for them."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.program.program import FREE, Program

from .shared_terms import Work

#: Cycles until a result can be used, about the same on the processors of today; other operations take 3.
LATENCY: Mapping[str, int] = {
    "neg": 1, "abs": 1, "select": 2, "div": 13, "sqrt": 18, "exp": 40, "log": 40, "sin": 40, "cos": 40,
    "tan": 60, "asin": 40, "acos": 40, "atan": 40, "atan2": 60,
}  # fmt: skip


def ready(work: Work) -> dict[int, int]:
    """Cycles until each node is ready, where sums and products take first what is ready first."""
    found: dict[int, int] = {}
    for root in (*work.conditions, *[n for n, _ in work.results]):
        stack = [root]
        while stack:
            n = stack[-1]
            operands = work.operands(n)
            missing = [m for m, _ in operands if m not in found]
            if missing:
                stack += missing
                continue
            stack.pop()
            first, *rest = sorted([found[m] for m, _ in operands]) or (0,)
            op = work.nodes[n].op
            if op in ("add", "mul"):
                for time in rest:
                    first = max(first, time) + 3
                found[n] = first
            else:
                found[n] = (rest or (first,))[-1] + (0 if op in FREE else LATENCY.get(op, 3))
    return found


def critical_path(program: Program) -> int:
    """Cycles from the inputs to the last result, were nothing in the way."""
    times: list[int] = []
    for ins in program.code:
        start = max([times[a] for a in ins.args], default=0)
        times.append(start if ins.op in FREE else start + LATENCY.get(ins.op, 3))
    return max([times[k] for indices in program.results for k in indices], default=0)
