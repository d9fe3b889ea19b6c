"""C functions whose output may be written over an argument: the same bits as with an array of its own."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from liegen.emit.c_target import value_name
from liegen.kernel import Kernel
from liegen.native import load_shared
from liegen.program import Program

from .backends import PACKAGE, Workspace
from .report import Check

Array = NDArray[np.float64]


def in_place(kernel: Kernel, place: Workspace, arguments: Mapping[str, Array]) -> Check:
    """Write every output over every argument of its size, at all samples. ``worst`` counts differences."""
    if place.library is None:
        return Check("in place", True, 0.0, 0.0, "results", "", 0, note="not checked", checked=False)
    shared = load_shared(place.library)
    functions = [(value_name(kernel), kernel.value)]
    functions += [(kernel.name, kernel.jacobians)] if kernel.variables else []
    wrong, where, count = 0, "", len(next(iter(arguments.values())))
    for name, program in functions:
        function = shared[f"{PACKAGE}_{name}"]
        for k in range(count):
            values = {a.name: arguments[a.name][k].copy() for a in kernel.arguments}
            plain = _called(function, program, kernel, values, "", "")
            for output in kernel.outputs:
                for a in kernel.arguments:
                    if a.size == output.size:
                        over = _called(function, program, kernel, values, output.name, a.name)
                        bad = any(x.tobytes() != y.tobytes() for x, y in zip(plain, over, strict=True))
                        wrong += bad
                        where = f"{name}, {output.name} over {a.name}" if bad else where
    return Check("in place", wrong == 0, float(wrong), 0.0, "results that differ", where, count)


def _called(
    function: ctypes._NamedFuncPointer,  # pyright: ignore[reportPrivateUsage]
    program: Program,
    kernel: Kernel,
    values: Mapping[str, Array],
    output: str,
    argument: str,
) -> Sequence[Array]:
    """All outputs, with ``output`` written over ``argument`` (none for an empty name)."""
    inputs = {name: value.copy() for name, value in values.items()}
    outputs = [
        inputs[argument] if port.name == output else np.full(port.size, -7.0) for port in program.outputs
    ]
    function(*(ctypes.c_void_p(a.ctypes.data) for a in (*inputs.values(), *outputs)))
    return outputs
