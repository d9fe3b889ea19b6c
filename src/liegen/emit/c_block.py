"""The straight-line body of a batch in C: the function of a program on ``lanes``, a block of factors at once.

The type ``lanes`` is a GCC vector or, for other compilers, one number; the header of the package
(``templates/c/lanes.h.j2``) says which.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from liegen.kernel import Kernel
from liegen.program import Program
from liegen.program.rewrite import Builder, rebuilt

from .precision import statement
from .printer import Assignment, Listing, Store, condition_indices, print_program
from .syntax import CHOICE, PREFIX, PRODUCT, SUM, Operator, Syntax, spell
from .target import scalar_names, words

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


@dataclass(frozen=True)
class Block:
    """The function of one program on a block of factors, for some outputs; ``flags`` say which are wanted.

    ``parts``: a condition, and what is done where it holds: what a Jacobian alone needs where it is wanted.
    """

    name: str
    summary: str
    outputs: tuple[str, ...]
    flags: tuple[str, ...]
    parameters: tuple[str, ...]
    unused: tuple[str, ...]
    loads: tuple[str, ...]
    body: tuple[str, ...]
    stores: tuple[str, ...]
    parts: tuple[tuple[str, tuple[str, ...]], ...]


@dataclass(frozen=True)
class Names:
    """The variables of batches, named as nothing of the kernel is.

    ``arrays``: by argument and output its numbers of a block; ``pens``: by output; ``wanted``: by Jacobian.
    """

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
    wanted: Mapping[str, str]


def names_of(kernel: Kernel) -> Names:
    """They do not depend on layout and precision."""
    ports = [*(a.name for a in kernel.arguments), *(p.name for p in kernel.jacobians.outputs)]
    used = {*ports, *scalar_names(kernel)}
    arrays = {name: _fresh(f"{name}_lanes", used) for name in ports}

    def own(name: str) -> str:
        return _fresh(name, used)

    return Names(
        n=own("n"), k=own("k"), count=own("count"), held=own("held"), broken=own("broken"),
        violated=own("violated"), jacobians=own("jacobians"), stream=own("stream"), room=own("room"),
        arrays=arrays, pens={p.name: own(f"{p.name}_pen") for p in kernel.jacobians.outputs},
        wanted={name: own(f"want_{name}") for name in _jacobian_names(kernel)},
    )  # fmt: skip


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
    return statement(assignment, "lanes", "lanes_mask")


def _stores(stores: Sequence[Store], turned: Collection[str]) -> list[str]:
    """``turned``: outputs whose numbers stand by columns."""
    if stores[0].port in turned:
        stores = sorted(stores, key=lambda store: store.index[::-1])
    return [f"{store.port}[{k}] = {store.text};" for k, store in enumerate(stores)]


def _jacobian_names(kernel: Kernel) -> tuple[str, ...]:
    """The outputs that may be left out."""
    values = {o.name for o in kernel.outputs}
    return tuple(port.name for port in kernel.jacobians.outputs if port.name not in values)


def turned_outputs(kernel: Kernel) -> frozenset[str]:
    """The outputs whose numbers have another order by columns."""
    fixed = {o.name for o in kernel.outputs if o.laid_out}
    matrices = (p for p in kernel.jacobians.outputs if len(p.shape) == 2 and min(p.shape) > 1)
    return frozenset(p.name for p in matrices if p.name not in fixed)


def printed_blocks(kernel: Kernel, names: Names, *, column_major: bool) -> tuple[Block, ...]:
    """The functions of a block: of the value, and with the Jacobians where there are any."""
    programs = [(kernel.value, "block_value"), (kernel.jacobians, "block_jacobians")]
    turned = turned_outputs(kernel) if column_major else frozenset[str]()
    return tuple(
        _block(kernel, program, name, names, turned & {port.name for port in program.outputs})
        for program, name in programs[: 2 if kernel.variables else 1]
    )


def _block(kernel: Kernel, program: Program, name: str, names: Names, turned: Collection[str]) -> Block:
    listing: Listing = print_program(without_chosen_conditions(program), SYNTAX, scalar_names(kernel))
    read = {load.port for load in listing.loads}
    wanted = {port.name: names.wanted[port.name] for port in program.outputs if port.name in names.wanted}
    conditions = tuple(f"{names.held}[{k}] = {text};" for k, text in enumerate(listing.conditions))
    stores = {
        port.name: _stores(some, turned) for port, some in zip(program.outputs, listing.stores, strict=True)
    }

    def alone(jacobian: str) -> tuple[str, ...]:
        return (*(_assign(a) for a in listing.body if a.only == jacobian), *stores[jacobian])

    return Block(
        name=f"{name}_cm" if turned else name,
        summary=f"{'Value and Jacobians' if wanted else 'Value'} of a block"
        f"{', column-major' if turned else ''}.",
        outputs=tuple(stores),
        flags=tuple(wanted.values()),
        parameters=(
            *(f"const lanes *{a.name}" for a in kernel.arguments),
            *(f"lanes *{port.name}" for port in program.outputs),
            *(f"int {flag}" for flag in wanted.values()),
            *([f"lanes_mask *{names.held}"] if conditions else []),
        ),
        unused=tuple(a.name for a in kernel.arguments if a.name not in read),
        loads=tuple(f"const lanes {load.name} = {load.port}[{load.index}];" for load in listing.loads),
        body=tuple(_assign(a) for a in (*listing.guard, *listing.body) if a.only not in wanted),
        stores=(*conditions, *(line for port in stores if port not in wanted for line in stores[port])),
        parts=tuple((flag, alone(jacobian)) for jacobian, flag in wanted.items()),
    )
