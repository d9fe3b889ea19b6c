"""The loops that NumPy calls: C around the batch function of a factor, for arrays of any strides.

They know NumPy's calling convention for generalised ufuncs (``PyUFuncGenericFunction`` in NumPy's C API) but
include none of its headers. What NumPy must be told (loops, types, name, text, signature) is static data of
the same shared object, so that it lives as long as the code does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from liegen.kernel import Kernel
from liegen.program import Port

from .c_batch import batch_name
from .header import closing, doc_lines
from .target import Options
from .templates import lay_out

#: The number of C's int in NumPy's table of types.
INT = 5


@dataclass(frozen=True)
class Method:
    """What a compiled factor offers as one gufunc: ``status`` gives a bit mask instead of arrays.

    ``function`` is the C function of batches that it calls, without the package's prefix; ``taken`` are the
    names of that function's arguments and outputs, in its order. Outputs that the method lacks are NULL.
    """

    name: str
    title: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    function: str
    taken: tuple[str, ...]

    @property
    def signature(self) -> str:
        """``(7),(7),(7)->(6),(6,6),(6,6)``."""
        left, right = (
            ",".join(f"({','.join(map(str, port.shape))})" for port in ports)
            for ports in (self.inputs, self.outputs)
        )
        return f"{left}->{right}"


@dataclass(frozen=True)
class Number:
    """A type of number: its names in C and NumPy, NumPy's number for it, the suffix of its functions."""

    type: str
    dtype: str
    code: int
    suffix: str


#: In the order in which NumPy tries them: it takes the first that all inputs can be cast to safely.
NUMBERS = (Number("double", "float64", 12, ""),)


@dataclass(frozen=True)
class Loop:
    """A loop over one type of number, as statements."""

    name: str
    type: str
    spacings: tuple[str, ...]
    steady: str
    whole: tuple[str, ...]
    single: tuple[str, ...]


@dataclass(frozen=True)
class _Operand:
    """An array of a gufunc: its place among the arguments and where its steps are."""

    position: int
    rows: int
    columns: int
    row_step: str
    column_step: str
    written: bool

    @property
    def size(self) -> int:
        return self.rows * self.columns


def methods(kernel: Kernel) -> tuple[Method, ...]:
    """``value``, ``jacobians`` where there are variables, and ``status``; inputs in the order of a call."""
    inputs = tuple(Port(a.name, a.shape) for a in (*kernel.positional, *kernel.keywords))
    taken = (*(a.name for a in kernel.arguments), *(port.name for port in kernel.jacobians.outputs))

    def method(name: str, title: str, outputs: tuple[Port, ...]) -> Method:
        return Method(name, title, inputs, outputs, batch_name(kernel), taken)

    offered = [method("value", kernel.name, kernel.value.outputs)]
    if kernel.variables:
        offered.append(method("jacobians", f"{kernel.name}_jacobians", kernel.jacobians.outputs))
    return (*offered, method("status", f"{kernel.name}_status", (Port("status", ()),)))


def symbol(kernel_name: str, method: str, package: str) -> str:
    """The name of the ``gufunc`` structure in the shared object."""
    return f"{package}_{kernel_name}_{method}_gufunc"


def loops_source(kernel: Kernel, options: Options) -> str:
    """The C of all loops of a factor."""
    return lay_out(
        "runtime/loops.c.j2",
        {
            "header": (f"{kernel.name}: loops for NumPy", "", *closing(options)),
            "factor": kernel.name,
            "methods": [_printed(kernel, method, options.package) for method in methods(kernel)],
        },
    )


def _printed(kernel: Kernel, method: Method, package: str) -> dict[str, object]:
    width = len(method.inputs)
    status = method.name == "status"
    codes = [[n.code] * width + [INT if status else n.code] * len(method.outputs) for n in NUMBERS]
    loops = [
        _status_loop(kernel, method, n, package) if status else _loop(method, n, package) for n in NUMBERS
    ]
    return {
        "name": method.name,
        "symbol": symbol(kernel.name, method.name, package),
        "title": method.title,
        "doc": "\n".join(doc_lines(kernel)),
        "signature": method.signature,
        "inputs": width,
        "outputs": len(method.outputs),
        "data": ["NULL"] * len(NUMBERS),
        "types": [code for row in codes for code in row],
        "loops": loops,
    }


def _operands(method: Method) -> tuple[_Operand, ...]:
    ports = [*method.inputs, *method.outputs]
    at = len(ports)
    made: list[_Operand] = []
    for position, port in enumerate(ports):
        rows, columns = (*port.shape, 1, 1)[:2]
        steps = [f"steps[{at + k}]" for k in range(len(port.shape))]
        row, column = (*steps, "0", "0")[:2]
        made.append(_Operand(position, rows, columns, row, column, position >= len(method.inputs)))
        at += len(port.shape)
    return tuple(made)


def _array(o: _Operand, number: Number, package: str, data: str, step: str, spacing: str) -> str:
    kind, index = ("out", "") if o.written else ("in", ", NULL")
    return f"const {package}_{kind}{number.suffix} v{o.position} = {{{data}, {step}, {spacing}{index}}};"


def _call(method: Method, number: Number, package: str, count: str) -> tuple[list[str], str]:
    """A declaration for the outputs that are left out, if any, and the call."""
    names = [port.name for port in (*method.inputs, *method.outputs)]
    passed = [f"v{names.index(name)}" if name in names else "none" for name in method.taken]
    declared = [f"const {package}_out{number.suffix} none = {{NULL, 0, 0}};"] if "none" in passed else []
    function = f"{package}_{method.function}{number.suffix}"
    return declared, f"{function}({', '.join([count, *passed, 'NULL'])});"


def _loop(method: Method, number: Number, package: str) -> Loop:
    operands = _operands(method)
    declared, whole_call = _call(method, number, package, "n")
    _, single_call = _call(method, number, package, "1")
    whole = [
        _array(
            o, number, package,
            f"({'' if o.written else 'const '}{number.type} *)args[{o.position}]",
            f"steps[{o.position}] / size", f"c{o.position} / size",
        )
        for o in operands
    ]  # fmt: skip
    return Loop(
        name=f"{method.name}_{number.type}",
        type=number.type,
        spacings=tuple(
            f"const ptrdiff_t c{o.position} = "
            f"spacing({o.rows}, {o.columns}, {o.row_step}, {o.column_step}, size);"
            for o in operands
        ),
        steady=" && ".join(f"steady(c{o.position}, steps[{o.position}], size)" for o in operands),
        whole=(*whole, *declared, whole_call),
        single=(
            *_local(operands, number, package),
            *declared,
            single_call,
            *(_copy(o, written=True) for o in operands if o.written),
        ),
    )


def _status_loop(kernel: Kernel, method: Method, number: Number, package: str) -> Loop:
    """The bits of the requirements that an element violates: what the batch function returns for it alone."""
    value = replace(method, outputs=kernel.value.outputs)
    inputs = len(method.inputs)
    declared, call = _call(value, number, package, "1")
    target = f"args[{inputs}] + k * steps[{inputs}]"
    return Loop(
        name=f"{method.name}_{number.type}",
        type=number.type,
        spacings=(),
        steady="",
        whole=(),
        single=(
            *_local(_operands(value), number, package),
            *declared,
            f"const int status = {call}",
            f"memcpy({target}, &status, sizeof status);",
        ),
    )


def _local(operands: Sequence[_Operand], number: Number, package: str) -> list[str]:
    """Local packed arrays of one element; those of inputs are filled."""
    lines: list[str] = []
    for o in operands:
        lines.append(f"{number.type} m{o.position}[{o.size}];")
        lines.append(_array(o, number, package, f"m{o.position}", str(o.size), "1"))
    return [*lines, *(_copy(o, written=False) for o in operands if not o.written)]


def _copy(o: _Operand, *, written: bool) -> str:
    local = f"(char *)m{o.position}, {o.columns} * size, size"
    array = f"args[{o.position}] + k * steps[{o.position}], {o.row_step}, {o.column_step}"
    to, source = (array, local) if written else (local, array)
    return f"move({to}, {source}, {o.rows}, {o.columns}, size);"
