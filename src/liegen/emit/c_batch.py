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
    parameters: tuple[str, ...]
    locals: tuple[str, ...]
    loop: str
    body: tuple[str, ...]
    pens: tuple[str, ...]
    stream: str
    violated: str


def batch_name(kernel: Kernel) -> str:
    """``between_se3_batch``."""
    return f"{kernel.name}_batch"


def without_chosen_conditions(program: Program) -> Program:
    """Selects between conditions become and, or, not: a select of lanes has numbers as arms."""
    conditions = condition_indices(program)
    if not any(ins.op == "select" and ins.args[1] in conditions for ins in program.code):
        return program
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
    return rebuilt(program, builder.code, place)


def _fresh(name: str, used: Collection[str]) -> str:
    while name in used:
        name += "_"
    return name


def _assign(assignment: Assignment) -> str:
    return _FORMATS[assignment.kind].format(assignment.name, assignment.text)


def _stores(stores: Sequence[Store]) -> list[str]:
    return [f"{store.port}[{k}] = {store.text};" for k, store in enumerate(stores)]


def _block(kernel: Kernel, program: Program, name: str, held: str) -> Block:
    listing: Listing = print_program(without_chosen_conditions(program), SYNTAX, scalar_names(kernel))
    read = {load.port for load in listing.loads}
    given = [f"const lanes *{a.name}" for a in kernel.arguments]
    made = [f"lanes *{port.name}" for port in program.outputs]
    conditions = [f"{held}[{k}] = {text};" for k, text in enumerate(listing.conditions)]
    jacobians = len(program.outputs) > len(kernel.outputs)
    return Block(
        name=name,
        summary="Value and Jacobians of a block." if jacobians else "Value of a block.",
        parameters=(*given, *made, *([f"lanes_mask *{held}"] if conditions else [])),
        unused=tuple(a.name for a in kernel.arguments if a.name not in read),
        loads=tuple(f"const lanes {load.name} = {load.port}[{load.index}];" for load in listing.loads),
        body=tuple(map(_assign, (*listing.guard, *listing.body))),
        stores=(*conditions, *(line for stores in listing.stores for line in _stores(stores))),
    )


def batch_parameters(kernel: Kernel, options: Options, n: str) -> tuple[str, ...]:
    """The parameters of the batch function."""
    return (
        f"ptrdiff_t {n}",
        *(f"{options.package}_in {a.name}" for a in kernel.arguments),
        *(f"{options.package}_out {port.name}" for port in kernel.jacobians.outputs),
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


def printed_batch(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the batch's template lays out."""
    names = _names(kernel)
    programs = [(kernel.value, "block_value"), (kernel.jacobians, "block_jacobians")]
    blocks = [_block(kernel, p, name, names.held) for p, name in programs[: 2 if kernel.variables else 1]]
    size = {name: sum(p.size for p in program.outputs) for program, name in programs}
    values = {o.name for o in kernel.outputs}
    wanted = " || ".join(f"{p.name}.data != NULL" for p in kernel.jacobians.outputs if p.name not in values)
    total = (
        f"{names.jacobians} ? {size['block_jacobians']} : {size['block_value']}"
        if wanted
        else str(size["block_value"])
    )
    batch = Batch(
        name=f"{options.package}_{batch_name(kernel)}",
        parameters=batch_parameters(kernel, options, names.n),
        locals=(
            *([f"const int {names.jacobians} = {wanted};"] if wanted else []),
            f"const int {names.stream} = lanes_streams({names.n}, {total});",
            f"int {names.violated} = 0;",
        ),
        loop=f"ptrdiff_t {names.k} = 0; {names.k} < {names.n}; {names.k} += LANES",
        body=tuple(_body(kernel, options.package, names, blocks)),
        pens=tuple(names.pens.values()),
        stream=names.stream,
        violated=names.violated,
    )
    return {
        "blocks": tuple(blocks),
        "batch": batch,
        "batch_header": (f"{kernel.name}: batches", "", *closing(options)),
    }
