"""The order of the instructions: values are computed shortly before they are used."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush

from liegen.program.program import FREE, Instruction, Program, instruction
from liegen.program.rewrite import needed, rebuilt, roots


def schedule(program: Program) -> Program:
    """Reorder for short live ranges: of three orders, the one where the fewest values wait at a time.

    The orders: as they are; depth first from the outputs; greedy backwards. Inputs and constants stand
    right before their first use, requirements come first in the depth-first order. Reorders only, what
    nothing needs is left out; :func:`live_values` never grows. Deterministic, idempotent.
    """
    live = needed(program)
    whole = [k for k, (op, _, _) in enumerate(program.code) if live[k] and op not in FREE]
    orders = (whole, _depth_first(program), _greedy(program, live))
    return _placed(program, min(orders, key=lambda order: _most_waiting(program, order)))


def live_values(program: Program) -> int:
    """Largest number of computed values that wait for a later use; inputs and constants are free."""
    order = [k for k, (op, _, _) in enumerate(program.code) if op not in FREE]
    return _most_waiting(program, order)


def _most_waiting(program: Program, order: Sequence[int]) -> int:
    """:func:`live_values` of the operations in this order."""
    code = program.code
    last = [-1] * len(code)  # the operation that uses a value last; inputs and constants count as used
    for k, (op, _, _) in enumerate(code):
        last[k] = -1 if op in FREE else k
    for k in order:
        for a in code[k].args:
            if last[a] >= 0:
                last[a] = k
    live = most = 0
    for k in order:
        live += 1
        for a in code[k].args:  # a result may take the place of an operand that is used for the last time
            if last[a] == k:
                live -= 1
                last[a] = -1
        if live > most:
            most = live
        if last[k] == k:
            live -= 1
    return most


def _placed(program: Program, order: Sequence[int]) -> Program:
    """The operations in this order, inputs and constants where they are first used."""
    code: list[Instruction] = []
    place = [-1] * len(program.code)

    def put(k: int) -> None:
        op, args, value = program.code[k]
        for a in args:
            if place[a] < 0:
                put(a)  # only inputs and constants are not there yet
        place[k] = len(code)
        code.append(instruction((op, tuple([place[a] for a in args]), value)))

    for k in (*order, *roots(program)):
        if place[k] < 0:
            put(k)
    return rebuilt(program, code, place)


def _depth_first(program: Program) -> list[int]:
    """Requirements, then outputs, in order; first the operand whose subtree needs more registers.

    Sethi and Ullman, The generation of optimal code for arithmetic expressions, J. ACM 17(4), 1970: best for
    trees, a heuristic where values are shared.
    """
    need = _registers(program)
    code = program.code
    order: list[int] = []
    done = [op in FREE for op, _, _ in code]
    for root in (*(r.condition for r in program.requirements), *roots(program)):
        stack = [root]
        while stack:
            k = stack[-1]
            if done[k]:
                stack.pop()
                continue
            open_ = [a for a in code[k].args if not done[a]]
            if not open_:
                stack.pop()
                done[k] = True
                order.append(k)
            elif len(open_) == 2:  # the last one pushed comes first: the highest need, of equals the left one
                a, b = open_
                stack += open_ if need[a] < need[b] else (b, a)
            else:
                open_.reverse()
                open_.sort(key=need.__getitem__)
                stack += open_
    return order


def _registers(program: Program) -> list[int]:
    """Registers that each instruction's operands need, were they a tree (Sethi-Ullman numbers)."""
    need: list[int] = []
    for op, args, _ in program.code:
        operands = sorted([need[a] for a in args], reverse=True)
        need.append(max([op not in FREE, *[n + k for k, n in enumerate(operands)]]))
    return need


def _greedy(program: Program, used: Sequence[int]) -> list[int]:
    """From the last instruction to the first, always one that makes the fewest operands wait for it."""
    code = program.code
    operands = [[a for a in dict.fromkeys(ins.args) if code[a].op not in FREE] for ins in code]
    users: list[list[int]] = [[] for _ in code]
    for k, found in enumerate(operands):
        for a in found if used[k] else ():
            users[a].append(k)
    left = [len(found) for found in users]  # users that are not placed yet
    live = [False] * len(code)
    score = [0] * len(code)
    heap: list[tuple[int, int, int]] = []
    pushed = 0

    def push(k: int) -> None:
        nonlocal pushed
        pushed += 1
        score[k] = sum([not live[a] for a in operands[k]]) - live[k]
        heappush(heap, (score[k], pushed, k))

    for k in dict.fromkeys(roots(program)):
        if left[k] == 0 and code[k].op not in FREE:
            push(k)
    order: list[int] = []
    done = [False] * len(code)
    while heap:
        found, _, k = heappop(heap)
        if done[k] or found != score[k]:
            continue  # pushed again since, with another score
        done[k] = True
        order.append(k)
        fresh = [a for a in operands[k] if not live[a]]
        for a in operands[k]:
            live[a] = True
            left[a] -= 1
            if left[a] == 0:
                push(a)
        for a in fresh:
            for user in users[a]:
                if left[user] == 0 and not done[user]:
                    push(user)
    return order[::-1]
