"""The loops that NumPy calls for factors with index arrays: C around the batch function, which gathers."""

from __future__ import annotations

from liegen.kernel import Kernel
from liegen.program import Port

from .header import closing
from .loops import Method, batch_call, methods
from .target import Options
from .templates import lay_out


def gathers_symbol(kernel_name: str, method: str, package: str) -> str:
    """The name of the loop in the shared object."""
    return f"{package}_{kernel_name}_{method}_gathers"


def gathered_methods(kernel: Kernel) -> tuple[Method, ...]:
    """Those whose results are arrays of numbers."""
    return tuple(m for m in methods(kernel) if m.name != "status")


def gathers_source(kernel: Kernel, options: Options) -> str:
    """The C of the loops of a factor: one a method, whichever arguments are gathered."""
    package = options.package
    return lay_out(
        "runtime/gathers.c.j2",
        {
            "header": (f"{kernel.name}: loops for NumPy that gather", "", *closing(options)),
            "factor": kernel.name,
            "package": package,
            "arguments": len(kernel.arguments),
            "methods": [
                {"symbol": gathers_symbol(kernel.name, m.name, package), "lines": _lines(m, package)}
                for m in gathered_methods(kernel)
            ],
        },
    )


def _lines(method: Method, package: str) -> tuple[str, ...]:
    first = len(method.inputs)
    declared, call = batch_call(method, package, "dims[0]", "NULL")
    return (
        *(
            f"const {package}_in v{k} = taken(&o, {k}, {len(port.shape)});"
            for k, port in enumerate(method.inputs)
        ),
        *(
            f"const {package}_out v{first + k} = made(&o, {k}, {len(port.shape)}, {_column(port)});"
            for k, port in enumerate(method.outputs)
        ),
        *declared,
        call,
    )


def _column(port: Port) -> int:
    """The dimension along which neighbouring numbers of an element lie."""
    return max((k for k, extent in enumerate(port.shape) if extent > 1), default=0)
