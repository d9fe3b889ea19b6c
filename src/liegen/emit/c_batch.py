"""Batches in C: one straight-line body on ``lanes``, a vector of as many factors as the machine takes at once.

The body is printed once for each program. The type ``lanes`` is a GCC vector or, for other compilers, a
double; the header of the package (``templates/c/lanes.h.j2``) says which.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from liegen.kernel import Kernel
from liegen.program import Port, Program
from liegen.program.rewrite import Builder, rebuilt

from .header import closing
from .printer import Assignment, Listing, Store, condition_indices, print_program
from .syntax import CHOICE, PREFIX, PRODUCT, SUM, Operator, Syntax, spell
from .target import Options, scalar_names

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
        for name in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "abs", "atan2", "not", "select")
    },
    constant=spell("NAN", "INFINITY"),
    truth={True: "LANES_TRUE", False: "LANES_FALSE"},
    lift="lanes_of({0})",
)  # fmt: skip

_TYPES = {"scalar": "lanes", "condition": "lanes_mask"}


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
    """The function of a batch: names of its own variables, statements of its loop."""

    name: str
    parameters: tuple[str, ...]
    n: str
    k: str
    locals: tuple[str, ...]
    prepare: tuple[str, ...]
    jacobians: str
    calls: tuple[str, ...]
    jacobian_stores: tuple[str, ...]
    stores: tuple[str, ...]
    result: str


def batch_name(kernel: Kernel) -> str:
    """``between_se3_batch``."""
    return f"{kernel.name}_batch"


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
    return f"const {_TYPES[assignment.kind]} {assignment.name} = {assignment.text};"


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


def _call(block: Block, arguments: Sequence[str]) -> str:
    return f"{block.name}({', '.join(arguments)});"


def batch_parameters(kernel: Kernel, options: Options, n: str) -> tuple[str, ...]:
    """The parameters of the batch function."""
    return (
        f"ptrdiff_t {n}",
        *(f"{options.package}_in {a.name}" for a in kernel.arguments),
        *(f"{options.package}_out {port.name}" for port in kernel.jacobians.outputs),
        "uint8_t *status",
    )


def names_of_its_own(kernel: Kernel) -> dict[str, str]:
    """A name for each variable of the batch function that no argument or output has."""
    used = {
        *(a.name for a in kernel.arguments),
        *(p.name for p in kernel.jacobians.outputs),
        *scalar_names(kernel),
    }
    return {name: _fresh(name, used) for name in ("n", "k", "count", "held", "violated", "jacobians")}


def printed_batch(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the batch's template lays out."""
    own = names_of_its_own(kernel)
    n, k, count, held = own["n"], own["k"], own["count"], own["held"]
    package, outputs = options.package, kernel.jacobians.outputs
    values = {o.name for o in kernel.outputs}
    programs = [(kernel.value, "block_value"), (kernel.jacobians, "block_jacobians")]
    blocks = [_block(kernel, p, name, held) for p, name in programs[: 2 if kernel.variables else 1]]
    ports = [*(Port(a.name, a.shape) for a in kernel.arguments), *outputs]
    used = {p.name for p in ports} | set(own.values())
    array = {p.name: _fresh(f"{p.name}_lanes", used) for p in ports}
    requirements = len(kernel.value.requirements)
    arguments = [array[a.name] for a in kernel.arguments]
    extra = [held] if requirements else []

    def store(port: Port) -> list[str]:
        target = array[port.name]
        lines = [f"lanes_blank({target}, {port.size}, {held}, {requirements});"] if requirements else []
        return [*lines, f"{package}_store({port.name}, {port.size}, {k}, {count}, {target});"]

    jacobian_ports = [p for p in outputs if p.name not in values]
    batch = Batch(
        name=f"{package}_{batch_name(kernel)}",
        parameters=batch_parameters(kernel, options, n),
        n=n,
        k=k,
        locals=(
            *(
                [
                    f"const int {own['jacobians']} = {' || '.join(f'{p.name}.data != NULL' for p in jacobian_ports)};"
                ]
                if jacobian_ports
                else []
            ),
            f"int {own['violated']} = 0;",
        ),
        prepare=(
            f"const int {count} = {n} - {k} < LANES ? (int)({n} - {k}) : LANES;",
            *(f"lanes {array[p.name]}[{p.size}];" for p in ports),
            *([f"lanes_mask {held}[{requirements}];"] if requirements else []),
            *(
                f"{package}_load({a.name}, {a.size}, {k}, {count}, {array[a.name]});"
                for a in kernel.arguments
            ),
        ),
        jacobians=own["jacobians"],
        calls=tuple(
            _call(b, [*arguments, *(array[p.name] for p in program.outputs), *extra])
            for b, (program, _) in zip(blocks, programs, strict=False)
        ),
        jacobian_stores=tuple(line for p in jacobian_ports for line in store(p)),
        stores=(
            *(line for p in outputs if p.name in values for line in store(p)),
            (
                f"{own['violated']} |= lanes_status({held}, {requirements}, {k}, {count}, status);"
                if requirements
                else f"lanes_fine({k}, {count}, status);"
            ),
        ),
        result=own["violated"],
    )
    return {
        "blocks": tuple(blocks),
        "batch": batch,
        "batch_header": (f"{kernel.name}: batches", "", *closing(options)),
    }
