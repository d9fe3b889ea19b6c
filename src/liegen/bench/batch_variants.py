"""Batches of one size: what Jacobians that are left out save, the layouts, single precision."""

from __future__ import annotations

import ctypes
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.emit import render
from liegen.emit.precision import DOUBLE, SINGLE, Precision
from liegen.kernel import Kernel
from liegen.native import compile_shared, load_shared
from liegen.program import Port
from liegen.temporary import working_folder
from liegen.verify.batches import DTYPES, In, Out, batch_function

from . import draws
from .build import Run, aligned
from .ours import PACKAGE
from .timing import in_turn
from .variant import FLAGS, Task, offsets

Array = NDArray[Any]
#: Factors in a call: outputs stay in the cache.
FACTORS = 1000
#: Calls that are timed as one.
CALLS = 20
#: Arrays begin at a line of the cache [bytes].
LINE = 64


@dataclass(frozen=True)
class Case:
    """A call: the outputs that are wanted, how matrices and arrays lie, the type of number."""

    what: str
    wanted: tuple[str, ...]
    precision: Precision = DOUBLE
    column_major: bool = False
    structure_of_arrays: bool = False


@dataclass(frozen=True)
class Timed:
    """Nanoseconds a factor; ``operations`` of the program that are needed for what is wanted."""

    what: str
    operations: int
    minimum: float
    median: float


def cases(kernel: Kernel) -> tuple[Case, ...]:
    """Value, each Jacobian with it, everything; in both precisions, by columns, as a structure of arrays."""
    value = tuple(o.name for o in kernel.outputs)
    everything = tuple(port.name for port in kernel.jacobians.outputs)
    jacobians = [name for name in everything if name not in value]
    found = [Case("value", value), Case("value, single", value, SINGLE)]
    found += [Case(f"value, {name}", (*value, name)) for name in jacobians if len(jacobians) > 1]
    for precision, ending in ((DOUBLE, ""), (SINGLE, ", single")):
        found += [
            Case(f"all{ending}", everything, precision),
            Case(f"all, columns{ending}", everything, precision, column_major=True),
            Case(f"all, structure of arrays{ending}", everything, precision, structure_of_arrays=True),
        ]
    return tuple(found) if kernel.variables else tuple(c for c in found if c.what.startswith("all"))


def batch_variants(task: Task, *, rounds: int, seed: int) -> tuple[Timed, ...]:
    """Time all cases in turn."""
    kernel, flags = task.kernel, FLAGS["plain"]
    inputs = draws.rows(draws.samples(task.function, draws.RANDOM, FACTORS, seed))
    files = render(
        [kernel], ["c"], package=PACKAGE, regenerate="liegen bench", layout="col", scalar=SINGLE.type
    )
    with working_folder("liegen-bench-") as folder:
        for path, text in files.items():
            (folder / Path(path).name).write_text(text, encoding="utf-8")
        compile_shared(sorted(folder.glob("*_batch*.c")), folder / "batches.so", flags)
        library = load_shared(folder / "batches.so")
    called = cases(kernel)
    runs = [run_of(library, task, case, inputs) for case in called]
    times = in_turn(runs, CALLS * len(inputs), rounds)
    return tuple(
        Timed(case.what, operations(kernel, case.wanted), min(ns), statistics.median(ns))
        for case, ns in zip(called, times, strict=True)
    )


def operations(kernel: Kernel, wanted: Sequence[str]) -> int:
    """Of the program that runs, those that some wanted output needs."""
    value = [o.name for o in kernel.outputs]
    program = kernel.jacobians if set(wanted) - set(value) else kernel.value
    return program.operations_of([*value, *wanted])


def run_of(
    library: ctypes.CDLL, task: Task, case: Case, inputs: Array, into: Mapping[str, Array] | None = None
) -> Run:
    """Calls of the batch; ``into`` are flat arrays for the outputs, of the case's type."""
    n, dtype = len(inputs), np.dtype(DTYPES[case.precision.suffix])
    function = batch_function(
        library, PACKAGE, task.kernel, column_major=case.column_major, precision=case.precision
    )

    def steps(port: Port) -> tuple[int, int]:
        return (1, n) if case.structure_of_arrays else (port.size, 1)

    given: list[Array] = []
    for port, start in zip(task.inputs, offsets(task.inputs), strict=True):
        part = inputs[:, start : start + port.size]
        given.append(aligned(part.size, dtype, LINE))
        given[-1][:] = (part.T if case.structure_of_arrays else part).ravel()
    made = into or {port.name: aligned(n * port.size, dtype, LINE) for port in task.outputs}
    ins = [In(a.ctypes.data, *steps(p), None) for p, a in zip(task.inputs, given, strict=True)]
    outs = [
        Out(made[p.name].ctypes.data, *steps(p)) if p.name in case.wanted else Out(None, 0, 0)
        for p in task.outputs
    ]

    def run() -> None:
        assert given, made  # alive as long as they are read and written
        for _ in range(CALLS):
            function(n, *ins, *outs, None)

    return run
