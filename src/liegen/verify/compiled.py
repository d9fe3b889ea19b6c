"""The generated C: compiled as one shared object, called through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from liegen.emit.c_target import value_name
from liegen.kernel import Kernel
from liegen.native import compile_shared, find_compiler
from liegen.program import Program

from .batches import batch_evaluator

Array = NDArray[np.float64]
Evaluate = Callable[[Mapping[str, Array]], dict[str, Array]]
#: The output that holds the functions' return values.
STATUS = "status"

#: No contraction of a*b+c to one rounding: the values are those of NumPy.
FLAGS = (
    "-std=c99",
    "-O1",
    "-ffp-contract=off",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
)


def compile_c(sources: Path, folder: Path) -> tuple[Path | None, str]:
    """One shared object of all sources, and the compiler's name; None when there is no compiler.

    Raises ToolError with the compiler's own words when it fails.
    """
    command = find_compiler()
    if not command:
        return None, ""
    library = folder / "liegen_verified.so"
    compile_shared(sorted(sources.glob("*.c")), library, FLAGS)
    return library, Path(command[0]).name


def c_backends(kernel: Kernel, library: Path, package: str) -> tuple[tuple[str, bool, Evaluate], ...]:
    """(name, with Jacobians, evaluate) of its functions: of one factor, and of a batch."""
    shared = ctypes.CDLL(str(library))
    programs = [("value", value_name(kernel), kernel.value)]
    programs += [("", kernel.name, kernel.jacobians)] if kernel.variables else []
    found: list[tuple[str, bool, Evaluate]] = []
    for what, name, program in programs:
        single = _evaluator(shared[f"{package}_{name}"], kernel, program)
        batch = batch_evaluator(shared, package, kernel, program, STATUS)
        for label, evaluate in (("C", single), ("C batch", batch)):
            found.append((f"{label}, {what}" if what else label, not what, evaluate))
    return tuple(found)


def _evaluator(function: ctypes._NamedFuncPointer, kernel: Kernel, program: Program) -> Evaluate:  # pyright: ignore[reportPrivateUsage]
    function.restype = ctypes.c_int
    function.argtypes = [ctypes.c_void_p] * (len(kernel.arguments) + len(program.outputs))

    def evaluate(arguments: Mapping[str, Array]) -> dict[str, Array]:
        inputs = [np.ascontiguousarray(arguments[a.name], dtype=np.float64) for a in kernel.arguments]
        count = len(inputs[0])
        outputs = [np.full((count, *port.shape), -7.0) for port in program.outputs]
        status = np.zeros(count)
        for k in range(count):
            status[k] = function(*(a[k].ctypes.data for a in (*inputs, *outputs)))
        named = {port.name: out for port, out in zip(program.outputs, outputs, strict=True)}
        return {**named, STATUS: status}

    return evaluate
