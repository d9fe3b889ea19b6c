"""The generated batches, called through ctypes on packed arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from liegen.emit.c_batch import batch_name
from liegen.emit.c_block import turned_outputs
from liegen.emit.precision import DOUBLE, SINGLE, Precision
from liegen.kernel import Kernel
from liegen.program import Program

Array = NDArray[np.float64]
#: NumPy's type by the suffix of a precision.
DTYPES: Mapping[str, type[np.floating[Any]]] = {DOUBLE.suffix: np.float64, SINGLE.suffix: np.float32}
Evaluate = Callable[[Mapping[str, Array]], dict[str, Array]]


def row_major(array: NDArray[Any], is_turned: bool) -> Array:
    """Matrices (n, rows, columns) that were filled by columns, or were not, as doubles."""
    if is_turned:
        array = array.reshape(len(array), *array.shape[:0:-1]).swapaxes(1, 2)
    return array.astype(np.float64)


class In(ctypes.Structure):
    """The argument of a batch: ``PACKAGE_in`` of C."""

    _fields_: ClassVar = [
        ("data", ctypes.c_void_p),
        ("stride", ctypes.c_ssize_t),
        ("comp", ctypes.c_ssize_t),
        ("index", ctypes.c_void_p),
    ]


class Out(ctypes.Structure):
    """The output of a batch: ``PACKAGE_out`` of C."""

    _fields_: ClassVar = [("data", ctypes.c_void_p), ("stride", ctypes.c_ssize_t), ("comp", ctypes.c_ssize_t)]


def batch_function(
    library: ctypes.CDLL,
    package: str,
    kernel: Kernel,
    *,
    column_major: bool = False,
    precision: Precision = DOUBLE,
) -> Callable[..., int]:
    """``PACKAGE_NAME_batch`` with its types: n, an ``In`` by argument, an ``Out`` by output, status."""
    function = library[f"{package}_{batch_name(kernel, column_major=column_major, precision=precision)}"]
    outputs = len(kernel.jacobians.outputs)
    function.restype = ctypes.c_int
    function.argtypes = [ctypes.c_ssize_t, *[In] * len(kernel.arguments), *[Out] * outputs, ctypes.c_void_p]
    return function


def batch_evaluator(
    library: ctypes.CDLL,
    package: str,
    kernel: Kernel,
    program: Program,
    status: str,
    *,
    column_major: bool = False,
    precision: Precision = DOUBLE,
) -> Evaluate:
    """The outputs of ``program``, a program of the kernel, row-major; the others are not asked for.

    The key ``status`` holds what the batch says of each sample, or all bits where its return value is not
    their union.
    """
    function = batch_function(library, package, kernel, column_major=column_major, precision=precision)
    wanted, dtype = {port.name for port in program.outputs}, DTYPES[precision.suffix]
    turned = turned_outputs(kernel) if column_major else frozenset[str]()

    def evaluate(arguments: Mapping[str, Array]) -> dict[str, Array]:
        inputs = {a.name: np.ascontiguousarray(arguments[a.name], dtype=dtype) for a in kernel.arguments}
        count = len(next(iter(inputs.values())))
        outputs = {
            p.name: np.full((count, *p.shape), -7.0, dtype)
            for p in kernel.jacobians.outputs
            if p.name in wanted
        }
        bits = np.zeros(count, dtype=np.uint8)
        union = function(
            count,
            *(In(inputs[a.name].ctypes.data, a.size, 1, None) for a in kernel.arguments),
            *(
                Out(outputs[p.name].ctypes.data, p.size, 1) if p.name in outputs else Out(None, 0, 0)
                for p in kernel.jacobians.outputs
            ),
            bits.ctypes.data,
        )
        right = union == np.bitwise_or.reduce(bits, initial=0)
        rows = {name: row_major(array, name in turned) for name, array in outputs.items()}
        return {**rows, status: bits.astype(np.float64) if right else np.full(count, 255.0)}

    return evaluate
