"""How much rounding can change what a program computes, by running it with other roundings.

Every intermediate result is moved by two units in the last place, up or down at random: stochastic arithmetic
(Vignes 1993). A formula that cancels, such as 1 - cos(x), shows how many digits it loses by itself; a wrong
sign or a missing term changes the values and not this spread.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from liegen.program import Program
from liegen.program.program import CONDITIONS, FREE
from liegen.program.rewrite import Builder, rebuilt

from .backends import program_evaluator

Array = NDArray[np.float64]

EPS = float(np.finfo(np.float64).eps)
RUNS, ULPS, TIMES = 6, 2, 4.0
#: A larger relative change is no rounding but the other branch of a logarithm at a half turn.
JUMP = 1e-3


def rounding(program: Program, arguments: Mapping[str, Array]) -> dict[str, Array]:
    """By output, the error to allow at each sample: four times the largest change by other roundings."""
    exact = program_evaluator(program)(arguments)
    largest = {name: np.zeros(len(array)) for name, array in exact.items()}
    for moved in rounded_otherwise(program, arguments, EPS):
        for name, array in exact.items():
            with np.errstate(all="ignore"):
                flat, other = array.reshape(len(array), -1), moved[name].reshape(len(array), -1)
                change = np.abs(flat - other).max(axis=1)
                small = change <= JUMP * np.maximum(1.0, np.abs(flat).max(axis=1))
            largest[name] = np.maximum(largest[name], np.where(small, change, 0.0))
    return {name: TIMES * change for name, change in largest.items()}


def rounded_otherwise(
    program: Program, arguments: Mapping[str, Array], eps: float
) -> Iterator[Mapping[str, Array]]:
    """What the program computes where rounding is by ``eps``, several times."""
    for run in range(RUNS):
        yield program_evaluator(_moved(program, run, eps))(arguments)


def _moved(program: Program, seed: int, eps: float) -> Program:
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], len(program.code))
    builder = Builder()
    place: list[int] = []
    for instruction, sign in zip(program.code, signs, strict=True):
        new = builder.emit(instruction.op, tuple(place[a] for a in instruction.args), instruction.value)
        if instruction.op not in CONDITIONS | FREE:
            new = builder.emit("mul", (new, builder.const(1.0 + sign * ULPS * eps)))
        place.append(new)
    return rebuilt(program, builder.code, place)
