"""The loops that NumPy calls: C around the batch function of a factor, for arrays of any strides.

They know NumPy's calling convention for generalised ufuncs (``PyUFuncGenericFunction`` in NumPy's C API) but
include none of its headers. What NumPy must be told (loops, types, name, text, signature) is static data of
the same shared object, so that it lives as long as the code does.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from liegen.kernel import Kernel
from liegen.program import Port

from .c_batch import batch_name
from .header import closing, doc_lines
from .precision import DOUBLE, SINGLE, Precision
from .target import Options
from .templates import lay_out

#: The number of C's int in NumPy's table of types.
INT = 5


@dataclass(frozen=True)
class Method:
    """What a compiled factor offers as one gufunc: ``status`` gives a bit mask instead of arrays.

    ``function`` is the C function of batches that it calls, without the package's prefix and the precision's
    suffix; ``taken`` are the names of that function's arguments and outputs, in its order. Outputs that the
    method lacks are NULL.
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
    """A type of number: the precision that computes in it, its name in NumPy, NumPy's number for it."""

    precision: Precision
    dtype: str
    code: int

    @property
    def type(self) -> str:
        """Its name in C."""
        return self.precision.type


#: In the order in which NumPy tries them: it takes the first that all inputs can be cast to safely.
NUMBERS = (Number(SINGLE, "float32", 11), Number(DOUBLE, "float64", 12))
#: Numbers in the arrays of a block, and the most elements in it.
ROOM, MOST = 4096, 32


@dataclass(frozen=True)
class Loop:
    """A loop over one type of number, as statements.

    ``whole`` hands the arrays on as they are where they are ``steady``; ``arrays``, ``reads`` and ``writes``
    go through packed copies of a block.
    """

    name: str
    type: str
    block: int
    spacings: tuple[str, ...]
    steady: str
    whole: tuple[str, ...]
    arrays: tuple[str, ...]
    reads: tuple[str, ...]
    call: str
    writes: tuple[str, ...]


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


def loops_source(kernel: Kernel, options: Options, names: Collection[str], number: Number) -> str:
    """The C of the loops of the methods with these names, for arrays of one type of number."""
    return lay_out(
        "runtime/loops.c.j2",
        {
            "header": (f"{kernel.name}: loops for NumPy", "", *closing(options)),
            "factor": kernel.name,
            "methods": [
                _printed(kernel, method, options.package, number)
                for method in methods(kernel)
                if method.name in names
            ],
        },
    )


def _printed(kernel: Kernel, method: Method, package: str, number: Number) -> dict[str, object]:
    width = len(method.inputs)
    status = method.name == "status"
    code = INT if status else number.code
    loop = _status_loop(kernel, method, number, package) if status else _loop(method, number, package)
    return {
        "name": method.name,
        "symbol": symbol(kernel.name, method.name, package),
        "title": method.title,
        "doc": "\n".join(doc_lines(kernel)),
        "signature": method.signature,
        "inputs": width,
        "outputs": len(method.outputs),
        "data": ["NULL"],
        "types": [number.code] * width + [code] * len(method.outputs),
        "loops": [loop],
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


def batch_call(
    method: Method, package: str, count: str, status: str, suffix: str = ""
) -> tuple[tuple[str, ...], str]:
    """A declaration for the outputs that are left out, if any, and the call; operand k is ``v{k}``."""
    names = [port.name for port in (*method.inputs, *method.outputs)]
    passed = [f"v{names.index(name)}" if name in names else "none" for name in method.taken]
    declared = (f"const {package}_out{suffix} none = {{NULL, 0, 0}};",) if "none" in passed else ()
    return declared, f"{package}_{method.function}{suffix}({', '.join([count, *passed, status])});"


def _structure(o: _Operand, package: str, data: str, step: str, spacing: str, suffix: str) -> str:
    kind, index = (f"out{suffix}", "") if o.written else (f"in{suffix}", ", NULL")
    return f"const {package}_{kind} v{o.position} = {{{data}, {step}, {spacing}{index}}};"


def _loop(method: Method, number: Number, package: str) -> Loop:
    operands = _operands(method)
    copied, suffix = _copied(operands, method, number, package), number.precision.suffix
    declared, call = batch_call(method, package, "n", "NULL", suffix)
    given = [
        _structure(
            o, package, f"({'' if o.written else 'const '}{number.type} *)args[{o.position}]",
            f"steps[{o.position}] / size", f"c{o.position} / size", suffix,
        )
        for o in operands
    ]  # fmt: skip
    return replace(
        copied,
        spacings=tuple(
            f"const ptrdiff_t c{o.position} = "
            f"spacing({o.rows}, {o.columns}, {o.row_step}, {o.column_step}, size);"
            for o in operands
        ),
        steady=" && ".join(f"steady(c{o.position}, steps[{o.position}], size)" for o in operands),
        whole=(*given, *declared, call),
    )


def _copied(operands: Sequence[_Operand], method: Method, number: Number, package: str) -> Loop:
    """The loop through packed copies alone."""
    block = max(1, min(MOST, ROOM // sum(o.size for o in operands)))
    suffix = number.precision.suffix
    declared, call = batch_call(method, package, "count", "NULL", suffix)
    local = [
        line
        for o in operands
        for line in (
            f"{number.type} m{o.position}[{o.size * block}];",
            _structure(o, package, f"m{o.position}", str(o.size), "1", suffix),
        )
    ]
    return Loop(
        name=f"{method.name}_{number.type}",
        type=number.type,
        block=block,
        spacings=(),
        steady="",
        whole=(),
        arrays=(*local, *declared),
        reads=tuple(f"read_{number.type}(m{o.position}, {_place(o)});" for o in operands if not o.written),
        call=call,
        writes=tuple(f"write_{number.type}(m{o.position}, {_place(o)});" for o in operands if o.written),
    )


def _place(o: _Operand) -> str:
    first = f"args[{o.position}] + k * steps[{o.position}], count, steps[{o.position}]"
    return f"{first}, {o.rows}, {o.columns}, {o.row_step}, {o.column_step}"


def _status_loop(kernel: Kernel, method: Method, number: Number, package: str) -> Loop:
    """The bits of the requirements that each element violates; the values are computed and dropped."""
    value = replace(method, outputs=kernel.value.outputs)
    copied = _copied(_operands(value), value, number, package)
    _, call = batch_call(value, package, "count", "bits", number.precision.suffix)
    position = len(method.inputs)
    return replace(
        copied,
        name=f"{method.name}_{number.type}",
        arrays=(*copied.arrays, f"uint8_t bits[{copied.block}];"),
        call=call,
        writes=(f"write_status(bits, args[{position}] + k * steps[{position}], count, steps[{position}]);",),
    )
