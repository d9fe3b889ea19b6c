"""Batches in C: one straight-line body on ``lanes``, as many factors as the machine takes at once.

The body is printed once for each program. The type ``lanes`` is a GCC vector or, for other compilers, a
double; the header of the package (``templates/c/lanes.h.j2``) says which.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap

from liegen.kernel import Kernel
from liegen.program import Program
from liegen.program.rewrite import Builder, rebuilt

from .header import closing
from .precision import DOUBLE, SINGLE, Precision, precisions
from .printer import Assignment, Listing, Store, condition_indices, print_program
from .syntax import CHOICE, PREFIX, PRODUCT, SUM, Operator, Syntax, spell
from .target import Options, scalar_names, words

#: One strength for comparisons, & and |: compilers warn of one bare within another.
_CONDITION = CHOICE + 1
SYNTAX = Syntax(
    operators={
        "add": Operator("+", SUM, "sum"), "sub": Operator("-", SUM, "sum"),
        "mul": Operator("*", PRODUCT, "product"), "div": Operator("/", PRODUCT, "product"),
        "neg": Operator("-", PREFIX), "lt": Operator("<", _CONDITION), "le": Operator("<=", _CONDITION),
        "and": Operator("&", _CONDITION, "and"), "or": Operator("|", _CONDITION, "or"),
    },
    calls={
        name: f"lanes_{name}"
        for name in words("sqrt sin cos tan asin acos atan exp log abs atan2 not select")
    },
    constant=spell("NAN", "INFINITY"),
    truth={True: "LANES_TRUE", False: "LANES_FALSE"},
    lift="lanes_of({0})",
    sincos="lanes_sincos({0}, &{1}, &{2})",
)  # fmt: skip

#: What the source of a batch refers to, beside variables that are named as nothing of the kernel is.
BATCH_NAMES = words("""
    LANES LANES_TRUE LANES_FALSE lanes lanes_mask lanes_of lanes_sincos lanes_blank lanes_status lanes_streams
    lanes_finish lanes_pen lanes_lift LANES_ROOM LANES_SHARED LANES_PARALLEL block_value block_jacobians
    block_value_cm block_jacobians_cm
    ptrdiff_t uint8_t
""").union(SYNTAX.calls.values())
#: Longest call, without the indentation of the loop.
_WIDTH = 92
_FORMATS = {
    "scalar": "const lanes {0} = {1};",
    "condition": "const lanes_mask {0} = {1};",
    "pair": "lanes {0}; {1};",
}


@dataclass(frozen=True)
class Block:
    """The function of one program on a block of factors."""

    name: str
    summary: str
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    loads: tuple[str, ...]
    body: tuple[str, ...]
    stores: tuple[str, ...]


@dataclass(frozen=True)
class Batch:
    """The function of a batch: its variables, the head of its loop over blocks, what is done with a block."""

    name: str
    summary: str
    parameters: tuple[str, ...]
    locals: tuple[str, ...]
    loop: str
    body: tuple[str, ...]
    pens: tuple[str, ...]
    stream: str
    violated: str


@dataclass(frozen=True)
class BatchFile:
    """A source of batches: for each program a function on a block, and the functions that call them.

    Numbers are spelt as doubles.
    """

    header: tuple[str, ...]
    lanes: str
    blocks: tuple[Block, ...]
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


def without_chosen_conditions(program: Program) -> Program:
    """Selects between conditions become and, or, not: a select of lanes has numbers as arms."""
    conditions = condition_indices(program)
    builder = Builder()
    place: list[int] = []
    for ins in program.code:
        args = tuple(place[a] for a in ins.args)
        if ins.op == "select" and ins.args[1] in conditions:
            c, yes, no = args
            other = builder.emit("and", (builder.emit("not", (c,)), no))
            place.append(builder.emit("or", (builder.emit("and", (c, yes)), other)))
        else:
            place.append(builder.emit(ins.op, args, ins.value))
    return rebuilt(program, builder.code, place) if conditions else program


def _fresh(name: str, used: Collection[str]) -> str:
    while name in used:
        name += "_"
    return name


def _assign(assignment: Assignment) -> str:
    return _FORMATS[assignment.kind].format(assignment.name, assignment.text)


def _stores(stores: Sequence[Store], turned: Collection[str]) -> list[str]:
    """``turned``: outputs whose numbers stand by columns."""
    if stores[0].port in turned:
        stores = sorted(stores, key=lambda store: store.index[::-1])
    return [f"{store.port}[{k}] = {store.text};" for k, store in enumerate(stores)]


def _turned(kernel: Kernel) -> frozenset[str]:
    """The outputs whose numbers have another order by columns."""
    fixed = {o.name for o in kernel.outputs if o.laid_out}
    matrices = (p for p in kernel.jacobians.outputs if len(p.shape) == 2 and min(p.shape) > 1)
    return frozenset(p.name for p in matrices if p.name not in fixed)


def _blocks(kernel: Kernel, held: str, *, column_major: bool) -> tuple[Block, ...]:
    """The functions of a block: of the value, and with the Jacobians where there are any."""
    programs = [(kernel.value, "block_value"), (kernel.jacobians, "block_jacobians")]
    turned = _turned(kernel) if column_major else frozenset[str]()
    return tuple(
        _block(kernel, program, name, held, turned & {port.name for port in program.outputs})
        for program, name in programs[: 2 if kernel.variables else 1]
    )


def _block(kernel: Kernel, program: Program, name: str, held: str, turned: Collection[str]) -> Block:
    listing: Listing = print_program(without_chosen_conditions(program), SYNTAX, scalar_names(kernel))
    read = {load.port for load in listing.loads}
    given = [f"const lanes *{a.name}" for a in kernel.arguments]
    made = [f"lanes *{port.name}" for port in program.outputs]
    conditions = [f"{held}[{k}] = {text};" for k, text in enumerate(listing.conditions)]
    what = "Value and Jacobians" if len(program.outputs) > len(kernel.outputs) else "Value"
    return Block(
        name=f"{name}_cm" if turned else name,
        summary=f"{what} of a block{', column-major' if turned else ''}.",
        parameters=(*given, *made, *([f"lanes_mask *{held}"] if conditions else [])),
        unused=tuple(a.name for a in kernel.arguments if a.name not in read),
        loads=tuple(f"const lanes {load.name} = {load.port}[{load.index}];" for load in listing.loads),
        body=tuple(map(_assign, (*listing.guard, *listing.body))),
        stores=(*conditions, *(line for stores in listing.stores for line in _stores(stores, turned))),
    )


def _parameters(kernel: Kernel, package: str, precision: Precision, n: str) -> tuple[str, ...]:
    return (
        f"ptrdiff_t {n}",
        *(f"{package}_in{precision.suffix} {a.name}" for a in kernel.arguments),
        *(f"{package}_out{precision.suffix} {port.name}" for port in kernel.jacobians.outputs),
        "uint8_t *status",
    )


@dataclass(frozen=True)
class _Names:
    """The variables of a batch function, named as nothing of the kernel is."""

    n: str
    k: str
    count: str
    held: str
    broken: str
    violated: str
    jacobians: str
    stream: str
    room: str
    arrays: Mapping[str, str]
    pens: Mapping[str, str]


def _names(kernel: Kernel) -> _Names:
    ports = [*(a.name for a in kernel.arguments), *(p.name for p in kernel.jacobians.outputs)]
    used = {*ports, *scalar_names(kernel)}
    arrays = {name: _fresh(f"{name}_lanes", used) for name in ports}

    def own(name: str) -> str:
        return _fresh(name, used)

    return _Names(
        n=own("n"), k=own("k"), count=own("count"), held=own("held"), broken=own("broken"),
        violated=own("violated"), jacobians=own("jacobians"), stream=own("stream"), room=own("room"),
        arrays=arrays, pens={p.name: own(f"{p.name}_pen") for p in kernel.jacobians.outputs},
    )  # fmt: skip


def _indented(condition: str, lines: Sequence[str]) -> list[str]:
    return [f"if ({condition}) {{", *(f"    {line}" for line in lines), "}"] if lines else []


def _body(kernel: Kernel, package: str, names: _Names, blocks: Sequence[Block]) -> list[str]:
    """What is done with a block: load, compute, blank what is outside of the domain, store."""
    values = [o.name for o in kernel.outputs]
    sizes = {p.name: p.size for p in kernel.jacobians.outputs}
    added = [name for name in sizes if name not in values]
    bits, place = len(kernel.value.requirements), f"{names.k}, {names.count}"
    extra = [names.held] if bits else []

    def call(block: Block, outputs: Sequence[str]) -> list[str]:
        arguments = [names.arrays[name] for name in (*(a.name for a in kernel.arguments), *outputs)]
        return wrap(f"{block.name}({', '.join([*arguments, *extra])});", _WIDTH, subsequent_indent="    ")

    def blank(name: str) -> str:
        return f"lanes_blank({names.arrays[name]}, {sizes[name]}, {names.held}, {bits});"

    def store(name: str) -> str:
        pen = f"{names.stream} ? &{names.pens[name]} : NULL"
        passed = f"{names.arrays[name]}, {names.room}, {pen}"
        return f"{package}_store({name}, {sizes[name]}, {place}, {passed});"

    lines = [
        f"const int {names.count} = {names.n} - {names.k} < LANES ? (int)({names.n} - {names.k}) : LANES;"
    ]
    lines += [f"lanes {names.arrays[a.name]}[{a.size}];" for a in kernel.arguments]
    lines += [f"lanes {names.arrays[name]}[{size}];" for name, size in sizes.items()]
    lines += [f"lanes {names.room}[LANES_ROOM({max(sizes.values())})];"]
    lines += [f"lanes_mask {names.held}[{bits}];"] if bits else []
    lines += [
        f"{package}_load({a.name}, {a.size}, {place}, {names.arrays[a.name]});" for a in kernel.arguments
    ]
    if added:
        lines += _indented(names.jacobians, call(blocks[1], [*sizes]))
        lines += _indented(f"!{names.jacobians}", call(blocks[0], values))
    else:
        lines += call(blocks[0], values)
    if bits:
        lines += [f"const int {names.broken} = lanes_status({names.held}, {bits}, {place}, status);"]
        lines += [f"{names.violated} |= {names.broken};"]
        lines += _indented(names.broken, [blank(name) for name in values])
        lines += _indented(f"{names.broken} && {names.jacobians}", [blank(name) for name in added])
    else:
        lines += [f"lanes_status(NULL, 0, {place}, status);"]
    lines += [store(name) for name in values]
    return [*lines, *_indented(names.jacobians, [store(name) for name in added])]


def _function(
    kernel: Kernel, package: str, blocks: Sequence[Block], *, column_major: bool, precision: Precision
) -> Batch:
    names = _names(kernel)
    values = [o.name for o in kernel.outputs]
    size = {p.name: p.size for p in kernel.jacobians.outputs}
    wanted = " || ".join(f"{name}.data != NULL" for name in size if name not in values)
    value, total = sum(size[name] for name in values), sum(size.values())
    moved = f"{names.jacobians} ? {total} : {value}" if wanted else str(value)
    return Batch(
        name=f"{package}_{batch_name(kernel, column_major=column_major, precision=precision)}",
        summary=f"n factors ({'column-major' if column_major else 'row-major'})",
        parameters=_parameters(kernel, package, precision, names.n),
        locals=(
            *([f"const int {names.jacobians} = {wanted};"] if wanted else []),
            f"const int {names.stream} = lanes_streams({names.n}, {moved});",
            f"int {names.violated} = 0;",
        ),
        loop=f"ptrdiff_t {names.k} = 0; {names.k} < {names.n}; {names.k} += LANES",
        body=tuple(_body(kernel, package, names, blocks)),
        pens=tuple(names.pens.values()),
        stream=names.stream,
        violated=names.violated,
    )


def printed_batches(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the templates of batches lay out: their declarations, a file for each precision."""
    held = _names(kernel).held
    orders = (False, True) if options.layout == "col" else (False,)
    blocks = {by: _blocks(kernel, held, column_major=by) for by in orders}
    files = {
        precision: BatchFile(
            header=(f"{kernel.name}: batches", "", *closing(options)),
            lanes=f"{options.package}_lanes{precision.suffix}.h",
            blocks=tuple({block.name: block for by in orders for block in blocks[by]}.values()),
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
