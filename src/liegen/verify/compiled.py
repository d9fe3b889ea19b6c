"""The generated C: compiled as one shared object, called through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.emit.c_block import turned_outputs
from liegen.emit.c_target import value_name
from liegen.emit.precision import DOUBLE, Precision
from liegen.kernel import Kernel
from liegen.native import compile_shared, find_compiler, load_shared
from liegen.program import Program

from .batches import DTYPES, batch_evaluator, row_major

Array = NDArray[np.float64]
Evaluate = Callable[[Mapping[str, Array]], dict[str, Array]]
#: The output that holds the functions' return values.
STATUS = "status"

#: No contraction of a*b+c to one rounding: the values are those of NumPy. Without inlining, for time.
FLAGS = (
    "-std=c99",
    "-O1",
    "-ffp-contract=off",
    "-DLANES_WHOLE=",
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
    compile_shared(sorted(sources.glob("*.c")), library, FLAGS, what="compiling the C to verify")
    return library, Path(command[0]).name


def c_backends(
    kernel: Kernel, library: Path, package: str, precision: Precision = DOUBLE
) -> tuple[tuple[str, bool, Evaluate], ...]:
    """(name, with Jacobians, evaluate) of its functions: of one factor, of a batch; by rows, by columns."""
    shared = load_shared(library)
    orders = [("value", value_name(kernel), kernel.value, False)]
    orders += [("", kernel.name, kernel.jacobians, False)] if kernel.variables else []
    orders += [("columns", f"{kernel.name}_cm", kernel.jacobians, True)]
    found: list[tuple[str, bool, Evaluate]] = []
    for what, name, program, by_columns in orders:
        function = shared[f"{package}_{name}{precision.suffix}"]
        turned = turned_outputs(kernel) if by_columns else frozenset[str]()
        single = _evaluator(function, kernel, program, turned, DTYPES[precision.suffix])
        batch = batch_evaluator(
            shared, package, kernel, program, STATUS, column_major=by_columns, precision=precision
        )
        for label, evaluate in (("C", single), ("C batch", batch)):
            complete = bool(kernel.variables) and what != "value"
            found.append((f"{label}, {what}" if what else label, complete, evaluate))
    return tuple(found)


def _evaluator(
    function: ctypes._NamedFuncPointer,  # pyright: ignore[reportPrivateUsage]
    kernel: Kernel,
    program: Program,
    turned: Collection[str],
    dtype: type[np.floating[Any]],
) -> Evaluate:
    function.restype = ctypes.c_int
    function.argtypes = [ctypes.c_void_p] * (len(kernel.arguments) + len(program.outputs))

    def evaluate(arguments: Mapping[str, Array]) -> dict[str, Array]:
        inputs = [np.ascontiguousarray(arguments[a.name], dtype=dtype) for a in kernel.arguments]
        count = len(inputs[0])
        outputs = [np.full((count, *port.shape), -7.0, dtype) for port in program.outputs]
        status = np.zeros(count)
        for k in range(count):
            status[k] = function(*(a[k].ctypes.data for a in (*inputs, *outputs)))
        named = {
            port.name: row_major(out, port.name in turned)
            for port, out in zip(program.outputs, outputs, strict=True)
        }
        return {**named, STATUS: status}

    return evaluate
