"""Functions and batches on floats, against the function on doubles at the same arguments.

An error may have 4 units in the last place of a float, relative to the largest entry, the largest argument
or 1, and moreover what rounding to floats makes in the program (:mod:`liegen.verify.rounding`). Where that
rounding decides between two branches, and where a step of the program has no number among floats, nothing is
compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.algebra import backend
from liegen.emit.precision import SINGLE
from liegen.kernel import Kernel
from liegen.program import Program
from liegen.program.program import CONDITIONS, FREE

from .backends import Arrays, Workspace, compiled_backends, programs
from .compiled import STATUS
from .draws import Sample, batch
from .report import Check
from .rounding import rounded_otherwise

Array = NDArray[np.float64]

NAME = "single"
LIMITS = np.finfo(np.float32)
EPS = float(LIMITS.eps)
BOUND = 4 * EPS
UNIT = "of what rounding may do"
#: A larger relative change is another branch, or leaves no digits to compare.
JUMP = 1e-2


@dataclass(frozen=True, eq=False)
class Wanted:
    """What doubles give at arguments that are floats: by output, with what is allowed by sample."""

    value: Arrays
    allowed: Arrays
    status: Array
    decided: NDArray[np.bool_]


def single(
    kernel: Kernel, place: Workspace, inside: Sequence[Sample], outside: Sequence[Sample], name: str = NAME
) -> Check:
    """Compare all functions in single precision; outside of the domain NaN and status."""
    if place.library is None:
        return Check(name, True, 0.0, 1.0, UNIT, "", 0, note="not checked", checked=False)
    samples = (*inside, *outside)
    with np.errstate(over="ignore"):
        arguments = {n: a.astype(np.float32).astype(np.float64) for n, a in batch(samples).items()}
    wanted = _wanted(kernel, place, arguments)
    worst, where = 0.0, ""
    for function in compiled_backends(kernel, place, SINGLE):
        found = function.evaluate(arguments)
        ratios = [np.where(found.pop(STATUS) == wanted.status, 0.0, np.inf)]
        ratios += [_ratio(array, wanted, name) for name, array in found.items()]
        ratio = np.where(wanted.decided, np.max(ratios, axis=0), 0.0)
        if ratio.max(initial=0.0) > worst:
            k = int(ratio.argmax())
            worst, where = float(ratio[k]), f"{function.name}, {samples[k].case}"
    return Check(name, worst <= 1.0, worst, 1.0, UNIT, where, int(wanted.decided.sum()))


def _wanted(kernel: Kernel, place: Workspace, arguments: Arrays) -> Wanted:
    double = next(b for b in compiled_backends(kernel, place) if b.jacobians == bool(kernel.variables))
    value = double.evaluate(arguments)
    status = value.pop(STATUS)
    given = np.max([np.abs(np.where(np.isfinite(a), a, 0.0)).max(axis=1) for a in arguments.values()], axis=0)
    exact = programs(kernel)[0].evaluate(arguments)
    change = {name: np.zeros(len(status)) for name in value}
    with np.errstate(all="ignore"):
        scale = {
            n: np.maximum(np.maximum(1.0, given), np.abs(_flat(a)).max(axis=1)) for n, a in value.items()
        }
        for moved in rounded_otherwise(kernel.jacobians, arguments, EPS):
            for name, array in exact.items():
                change[name] = np.maximum(change[name], np.abs(_flat(moved[name] - array)).max(axis=1))
        steady = [change[name] <= JUMP * scale[name] for name in value]
    allowed = {name: BOUND * scale[name] + change[name] for name in value}
    steady = np.all(steady, axis=0) & _in_range(kernel.jacobians, arguments)
    return Wanted(value, allowed, status, steady | (status != 0))


def _in_range(program: Program, arguments: Arrays) -> NDArray[np.bool_]:
    """Where no step overflows, and what is divided by or taken the root of is normal, or 0."""
    slots: list[Any] = program.run({name: tuple(a.T) for name, a in arguments.items()}, backend("numpy"))
    fits = np.ones(len(next(iter(arguments.values()))), dtype=np.bool_)
    for instruction, slot in zip(program.code, slots, strict=True):
        if instruction.op not in CONDITIONS | FREE:
            fits &= ~(np.isfinite(slot) & (np.abs(slot) > LIMITS.max))
        if instruction.op in ("div", "sqrt"):
            below = np.abs(slots[instruction.args[-1]])
            fits &= (below == 0) | ~(below < LIMITS.tiny)
    return fits


def _ratio(found: Array, wanted: Wanted, name: str) -> Array:
    expected = wanted.value[name]
    with np.errstate(all="ignore"):
        error = np.abs(_flat(found - expected)).max(axis=1) / wanted.allowed[name]
    blank = np.isnan(_flat(found)).all(axis=1)
    return np.where(
        wanted.status != 0, np.where(blank, 0.0, np.inf), np.where(np.isnan(error), np.inf, error)
    )


def _flat(array: Array) -> Array:
    return array.reshape(len(array), -1)
