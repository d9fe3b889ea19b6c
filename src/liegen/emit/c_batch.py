"""Batches in C: functions that load, compute and store one block of factors after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap

from liegen.kernel import Kernel

from .c_block import Block, Names, names_of, printed_blocks, turned_outputs
from .header import closing
from .precision import DOUBLE, SINGLE, Precision, precisions
from .target import Options

#: Longest call, without the indentation of the loop.
_WIDTH = 92


@dataclass(frozen=True)
class Batch:
    """The function of a batch: its variables, the head of its loop over blocks, what is done with a block.

    ``same``: the call of another batch that does the same, and nothing else is needed.
    """

    name: str
    summary: str
    parameters: tuple[str, ...]
    locals: tuple[str, ...]
    loop: str
    body: tuple[str, ...]
    pens: tuple[str, ...]
    stream: str
    violated: str
    same: str = ""


@dataclass(frozen=True)
class Ahead:
    """The function that asks for the arrays of the next block."""

    parameters: tuple[str, ...]
    lines: tuple[str, ...]


@dataclass(frozen=True)
class BatchFile:
    """A source of batches: for each program a function on a block, and the functions that call them.

    Numbers are spelt as doubles.
    """

    header: tuple[str, ...]
    lanes: str
    blocks: tuple[Block, ...]
    ahead: Ahead
    functions: tuple[Batch, ...]


def batch_name(kernel: Kernel, *, column_major: bool = False, precision: Precision = DOUBLE) -> str:
    """``between_se3_batch``, ``between_se3_batch_cm_f32``."""
    return f"{kernel.name}_batch{'_cm' if column_major else ''}{precision.suffix}"


def batch_names(kernel: Kernel) -> tuple[str, ...]:
    """Those of all layouts and precisions."""
    return tuple(
        batch_name(kernel, column_major=columns, precision=precision)
        for precision in (DOUBLE, SINGLE)
        for columns in (False, True)
    )


def _parameters(kernel: Kernel, package: str, precision: Precision, n: str) -> tuple[str, ...]:
    return (
        f"ptrdiff_t {n}",
        *(f"{package}_in{precision.suffix} {a.name}" for a in kernel.arguments),
        *(f"{package}_out{precision.suffix} {port.name}" for port in kernel.jacobians.outputs),
        "uint8_t *status",
    )


def _indented(condition: str, lines: Sequence[str]) -> list[str]:
    return [f"if ({condition}) {{", *(f"    {line}" for line in lines), "}"] if lines else []


def _body(kernel: Kernel, package: str, names: Names, blocks: Sequence[Block]) -> list[str]:
    """What is done with a block: load, compute, blank what is outside of the domain, store.

    ``blocks``: of the value, and with the Jacobians; or the only one that is called.
    """
    sizes = {p.name: p.size for p in kernel.jacobians.outputs}
    bits, place = len(kernel.value.requirements), f"{names.k}, {names.count}"

    def call(block: Block) -> list[str]:
        arrays = [names.arrays[name] for name in (*(a.name for a in kernel.arguments), *block.outputs)]
        passed = [*arrays, *block.flags, *([names.held] if bits else [])]
        return wrap(f"{block.name}({', '.join(passed)});", _WIDTH, subsequent_indent="    ")

    def blank(name: str) -> str:
        wanted = f"if ({names.wanted[name]}) " if name in names.wanted else ""
        return f"{wanted}lanes_blank({names.arrays[name]}, {sizes[name]}, {names.held}, {bits});"

    def store(name: str) -> str:
        pen = f"{names.stream} ? &{names.pens[name]} : NULL"
        wanted = f"if ({names.wanted[name]}) " if name in names.wanted else ""
        passed = f"{names.arrays[name]}, {names.room}, {pen}"
        return f"{wanted}{package}_store({name}, {sizes[name]}, {place}, {passed});"

    lines = [
        f"const int {names.count} = {names.n} - {names.k} < LANES ? (int)({names.n} - {names.k}) : LANES;"
    ]
    lines += [f"lanes {names.arrays[a.name]}[{a.size}];" for a in kernel.arguments]
    lines += [f"lanes {names.arrays[name]}[{size}];" for name, size in sizes.items()]
    lines += [f"lanes {names.room}[LANES_ROOM({max(sizes.values())})];"]
    lines += [f"lanes_mask {names.held}[{bits}];"] if bits else []
    passed = ", ".join([names.n, names.k, *(a.name for a in kernel.arguments), *sizes])
    ahead = wrap(f"block_ahead({passed});", _WIDTH, subsequent_indent="    ")
    lines += _indented(names.stream, ahead)
    lines += [
        f"{package}_load({a.name}, {a.size}, {place}, {names.arrays[a.name]});" for a in kernel.arguments
    ]
    if len(blocks) > 1:
        lines += _indented(names.jacobians, call(blocks[1]))
        lines += _indented(f"!{names.jacobians}", call(blocks[0]))
    else:
        lines += call(blocks[0])
    if bits:
        lines += [f"const int {names.broken} = lanes_status({names.held}, {bits}, {place}, status);"]
        lines += [f"{names.violated} |= {names.broken};"]
        lines += _indented(names.broken, [blank(name) for name in sizes])
    else:
        lines += [f"lanes_status(NULL, 0, {place}, status);"]
    return [*lines, *(store(name) for name in sizes)]


def _ahead(kernel: Kernel, package: str, precision: Precision) -> Ahead:
    names = names_of(kernel)
    n, *rest, _ = _parameters(kernel, package, precision, names.n)
    place = f"{names.n}, {names.k}"
    return Ahead(
        parameters=(n, f"ptrdiff_t {names.k}", *rest),
        lines=(
            *(f"{package}_ahead({a.name}, {a.size}, {place});" for a in kernel.arguments),
            *(f"{package}_ahead_to({p.name}, {p.size}, {place});" for p in kernel.jacobians.outputs),
        ),
    )


def _function(
    kernel: Kernel, package: str, blocks: Sequence[Block], *, column_major: bool, precision: Precision
) -> Batch:
    names = names_of(kernel)
    size = {p.name: p.size for p in kernel.jacobians.outputs}
    total, value = sum(size.values()), sum(size[o.name] for o in kernel.outputs)
    passed = [names.n, *(a.name for a in kernel.arguments), *size, "status"]
    rows = f"{package}_{batch_name(kernel, precision=precision)}({', '.join(passed)})"
    turned = turned_outputs(kernel) if column_major else frozenset[str]()
    # a column-major batch without a matrix among its values leaves them to the row-major one
    split = column_major and bool(names.wanted) and turned.isdisjoint(o.name for o in kernel.outputs)
    return Batch(
        name=f"{package}_{batch_name(kernel, column_major=column_major, precision=precision)}",
        summary=f"n factors ({'column-major' if column_major else 'row-major'})",
        parameters=_parameters(kernel, package, precision, names.n),
        locals=(
            *(f"const int {flag} = {name}.data != NULL;" for name, flag in names.wanted.items()),
            *(
                [f"const int {names.jacobians} = {' || '.join(names.wanted.values())};"]
                if names.wanted
                else []
            ),
            *([f"if (!{names.jacobians}) return {rows};"] if split else []),
            f"const int {names.stream} = lanes_streams({names.n}, "
            + (f"{names.jacobians} ? {total} : {value});" if names.wanted else f"{value});"),
            f"int {names.violated} = 0;",
        ),
        loop=f"ptrdiff_t {names.k} = 0; {names.k} < {names.n}; {names.k} += LANES",
        body=tuple(_body(kernel, package, names, blocks[1:] if split else blocks)),
        pens=tuple(names.pens.values()),
        stream=names.stream,
        violated=names.violated,
        same=rows if column_major and not turned else "",
    )


def printed_batches(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the templates of batches lay out: their declarations, a file for each precision."""
    names = names_of(kernel)
    orders = (False, True) if options.layout == "col" else (False,)
    blocks = {by: printed_blocks(kernel, names, column_major=by) for by in orders}
    files = {
        precision: BatchFile(
            header=(f"{kernel.name}: batches", "", *closing(options)),
            lanes=f"{options.package}_lanes{precision.suffix}.h",
            blocks=tuple({block.name: block for by in orders for block in blocks[by]}.values()),
            ahead=_ahead(kernel, options.package, precision),
            functions=tuple(
                _function(kernel, options.package, blocks[by], column_major=by, precision=precision)
                for by in orders
            ),
        )
        for precision in precisions(options.scalar)
    }
    return {
        "batches": tuple(function for file in files.values() for function in file.functions),
        **{f"batch{precision.suffix}": file for precision, file in files.items()},
    }
