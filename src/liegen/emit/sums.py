"""C that adds the outputs of many factors into arrays that they share: the blocks of a sparse matrix."""

from __future__ import annotations

from dataclasses import dataclass

from liegen.kernel import Kernel

from .c_batch import batch_name
from .header import closing
from .target import Options
from .templates import lay_out

#: Numbers that one chunk of factors leaves between the two loops: they stay in the nearest cache.
NUMBERS_OF_A_CHUNK = 4096
#: Factors that a batch takes at once, at most.
LANES = 8


@dataclass(frozen=True)
class Summed:
    """An output: the name of its buffer, and its shape as a matrix."""

    name: str
    rows: int
    columns: int


def sums_symbol(kernel_name: str, package: str) -> str:
    """The name of the function in the shared object."""
    return f"{package}_{kernel_name}_sums"


def sums_source(kernel: Kernel, options: Options) -> str:
    """The C of a kernel without variables, each of whose outputs is one number, a vector or a matrix."""
    outputs = [Summed(f"v{k}", *(*port.shape, 1, 1)[:2]) for k, port in enumerate(kernel.value.outputs)]
    total = sum(o.rows * o.columns for o in outputs)
    chunk = max(LANES, NUMBERS_OF_A_CHUNK // total // LANES * LANES)
    inputs = [f"from(in[{k}], start)" for k in range(len(kernel.arguments))]
    buffers = [f"({options.package}_out){{{o.name}, {o.rows * o.columns}, 1}}" for o in outputs]
    return lay_out(
        "runtime/sums.c.j2",
        {
            "header": (f"{kernel.name}: sums over factors", "", *closing(options)),
            "package": options.package,
            "factor": kernel.name,
            "function": batch_name(kernel),
            "outputs": outputs,
            "chunk": chunk,
            "passed": ", ".join(["m", *inputs, *buffers, "NULL"]),
        },
    )
