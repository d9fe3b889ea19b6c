"""Hits that say something: doubles neither overflow nor underflow there, and no require ends there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.algebra import backend
from liegen.algebra.casadi_backend import ca
from liegen.program import Program
from liegen.program.program import CONDITIONS, FREE
from liegen.trace import topological

from .solve import Arguments

Array = NDArray[np.float64]

#: Below this a square, or what is divided by one, has lost digits, unless it is 0.
SMALL = 1e-290
#: A condition whose sides are nearer than this ends here.
EDGE = 1e-9


def in_range(program: Program, arguments: Mapping[str, Array]) -> NDArray[np.bool_]:
    """By sample, whether no step of the program underflows."""
    count = len(next(iter(arguments.values())))
    slots: list[Any] = program.run({name: tuple(a.T) for name, a in arguments.items()}, backend("numpy"))
    fits = np.ones(count, dtype=np.bool_)
    for instruction, slot in zip(program.code, slots, strict=True):
        if instruction.op in CONDITIONS | FREE:
            continue
        size = np.abs(slot)
        fits &= ~((size > 0) & (size < SMALL))
        if instruction.op in ("mul", "div"):
            first = np.abs(slots[instruction.args[0]])
            other = np.abs(slots[instruction.args[1]])
            fits &= ~((size == 0) & (first > 0) & (other > 0) & np.isfinite(other))
    return fits


def edges(space: Arguments, rows: Sequence[Array]) -> NDArray[np.bool_]:
    """By row, whether a condition of a ``require`` has equal sides there."""
    nodes = topological([d.condition for d in space.graph.domain])
    sides = [n.operands for n in nodes if n.operation.name in ("lt", "le")]
    if not sides or not rows:
        return np.zeros(len(rows), dtype=np.bool_)
    pairs = [[space.scalars[id(n)][0] for n in operands] for operands in sides]
    gaps = ca.Function("edges", [space.stored], [ca.vertcat(*(ca.SX(a) - b for a, b in pairs))])
    return np.array([bool((np.abs(np.array(gaps(row))) <= EDGE).any()) for row in rows])
