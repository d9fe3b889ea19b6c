"""liegen's own C: a function call a factor, and its batches."""

from __future__ import annotations

from liegen import __version__
from liegen.derive import derive
from liegen.emit import render
from liegen.kernel import Kernel

from .variant import Task, Variant, fastest, offsets

NAME = "liegen"
PACKAGE = "bench"
#: Factors in a call of a batch whose outputs stay in the cache.
ROWS = 256


def sources(kernel: Kernel, *, batch: bool) -> dict[str, str]:
    """The emitted C of a kernel by file name: headers, and the source of single calls or of batches."""
    files = render([kernel], ["c"], package=PACKAGE, regenerate="liegen bench")
    unwanted = f"{kernel.name}.c" if batch else f"{kernel.name}_batch.c"
    named = {path.removeprefix("c/"): text for path, text in files.items() if path.startswith("c/")}
    return {name: text for name, text in named.items() if name != unwanted}


def generated(task: Task) -> tuple[dict[str, str], float]:
    """The sources as ``liegen generate`` writes them, and the seconds from the traced function to text."""
    function, terms = task.function, task.terms
    if terms:
        return fastest(lambda: sources(terms(), batch=False))
    return fastest(
        lambda: sources(derive(function.plain, function.weighting, in_place=function.in_place), batch=False)
    )


def variants(task: Task) -> tuple[Variant, ...]:
    """One call a factor."""
    files, seconds = generated(task)
    kernel = task.kernel
    name = f"{PACKAGE}_{kernel.name}"
    inputs = [f"a + {k}" for k in offsets(task.inputs)]
    outputs = [f"b + {k}" for k in offsets(task.outputs)]
    kinds = ["const double *"] * len(inputs) + ["double *"] * len(outputs)
    return (
        Variant(
            NAME, __version__, "",
            f"int {name}({', '.join(kinds)});", (f"{name}({', '.join([*inputs, *outputs])});",),
            files, kernel.jacobians.op_counts(), seconds,
        ),
    )  # fmt: skip


def batches(task: Task) -> tuple[Variant, ...]:
    """One call for ``ROWS`` factors: inputs in rows of all arguments, each output an array of its own."""
    kernel = task.kernel
    name = f"{PACKAGE}_{kernel.name}_batch"
    total = sum(port.size for port in task.inputs)
    structs = [
        f"{PACKAGE}_in x{k} = {{a + {start}, {total}, 1, NULL}};"
        for k, start in enumerate(offsets(task.inputs))
    ]
    structs += [
        f"{PACKAGE}_out y{k} = {{b + {start} * m, {port.size}, 1}};"
        for k, (port, start) in enumerate(zip(task.outputs, offsets(task.outputs), strict=True))
    ]
    arguments = [f"x{k}" for k in range(len(task.inputs))] + [f"y{k}" for k in range(len(task.outputs))]
    call = (*structs, f"{name}(m, {', '.join(arguments)}, NULL);")
    return (
        Variant(
            NAME, __version__, f"batches of {ROWS}", f'#include "{kernel.name}.h"', call,
            sources(kernel, batch=True), kernel.jacobians.op_counts(), None,
            driver="bench/batch_driver.c.j2", rows=ROWS,
        ),
    )  # fmt: skip
