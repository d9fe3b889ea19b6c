"""liegen's own C."""

from __future__ import annotations

import time

from liegen import __version__
from liegen.derive import derive
from liegen.emit import render
from liegen.kernel import Kernel

from .variant import Task, Variant, offsets

NAME = "liegen"
PACKAGE = "bench"


def sources(kernel: Kernel) -> dict[str, str]:
    """The emitted C of a kernel, by file name."""
    files = render([kernel], ["c"], package=PACKAGE, regenerate="liegen bench")
    return {path.removeprefix("c/"): text for path, text in files.items() if path.startswith("c/")}


def variants(task: Task) -> tuple[Variant, ...]:
    """The function as ``liegen generate`` writes it."""
    function = task.function
    start = time.perf_counter()
    kernel = derive(function.plain, function.weighting, in_place=function.in_place)
    files = sources(kernel)
    seconds = time.perf_counter() - start
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
