"""The C target: C99 that C++ takes too, one header and one source per factor, and an umbrella header."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from liegen.errors import DefinitionError
from liegen.kernel import Kernel
from liegen.program import Port, Program

from .c_batch import batch_names, printed_batches
from .header import argument_text, jacobian_texts, kernel_header, storage_text
from .lanes_text import DOUBLES, SINGLES
from .precision import DOUBLE, SINGLE, Precision, precisions, statement
from .printer import Listing, Store, print_program
from .scalar_text import scalar_text
from .syntax import CHOICE, COMPARISON, PREFIX, PRODUCT, SUM, Operator, Syntax
from .target import Options, Sheet, Target, scalar_names, words

SYNTAX = Syntax(
    operators={
        "add": Operator("+", SUM, "sum"), "sub": Operator("-", SUM, "sum"),
        "mul": Operator("*", PRODUCT, "product"), "div": Operator("/", PRODUCT, "product"),
        "neg": Operator("-", PREFIX), "not": Operator("!", PREFIX),
        "lt": Operator("<", COMPARISON), "le": Operator("<=", COMPARISON),
        # One strength for both: && within || is legal bare, but compilers warn.
        "and": Operator("&&", CHOICE + 1, "and"), "or": Operator("||", CHOICE + 1, "or"),
    },
    calls={
        "sqrt": "sqrt", "sin": "sin", "cos": "cos", "tan": "tan", "asin": "asin", "acos": "acos",
        "atan": "atan", "exp": "exp", "log": "log", "abs": "fabs", "atan2": "atan2",
    },
    constant=DOUBLE.constant,
    truth={True: "1", False: "0"},
    choice="{0} ? {1} : {2}",
)  # fmt: skip


def _syntax(precision: Precision, package: str) -> Syntax:
    """In double, the functions of angles are the package's own."""
    calls = {op: f"{name}{precision.libm}" for op, name in SYNTAX.calls.items()}
    if precision is not DOUBLE:
        return replace(SYNTAX, calls=calls, constant=precision.constant)
    return replace(
        SYNTAX,
        calls={**calls, "atan2": f"{package}_atan2"},
        sincos=f"{package}_sincos({{0}}, &{{1}}, &{{2}})",
    )


#: Operations that are calls of the package's own functions, the sine where the cosine is wanted too.
_OWN = words("atan2 sin")
_STATUS = "The result is 0, or the bits of the requirements that do not hold."
#: Requirements that the status of a batch, a byte for each factor, has bits for.
_BITS = 8


@dataclass(frozen=True)
class Output:
    """An output array and the statements that fill it."""

    name: str
    size: int
    optional: bool
    stores: tuple[str, ...]


@dataclass(frozen=True)
class Function:
    """A C function; ``jacobians`` are the outputs that may be NULL."""

    name: str
    summary: str
    parameters: tuple[str, ...]
    fallback: str
    unused: tuple[str, ...]
    loads: tuple[str, ...]
    guard: tuple[str, ...]
    status: str
    body: tuple[str, ...]
    outputs: tuple[Output, ...]
    jacobians: tuple[str, ...]
    fill: str


def value_name(kernel: Kernel) -> str:
    """``between_se3_res``; ``..._value`` for a function whose outputs are named otherwise.

    Without Jacobians there is one function, named like the kernel.
    """
    if not kernel.variables:
        return kernel.name
    return f"{kernel.name}_res" if [o.name for o in kernel.outputs] == ["res"] else f"{kernel.name}_value"


def symbols(kernel: Kernel) -> tuple[str, ...]:
    """What the sources of a kernel define, without the package's prefix, in any layout and precision."""
    single = [f"{name}{SINGLE.suffix}" for name in _names(kernel)]
    return (*_names(kernel), *single, *batch_names(kernel))


def _names(kernel: Kernel) -> tuple[str, ...]:
    return (kernel.name, value_name(kernel), f"{kernel.name}_cm")


def _stores(port: Port, stores: Sequence[Store], column_major: bool) -> tuple[str, ...]:
    if column_major:
        stores = sorted(stores, key=lambda store: store.index[::-1])
    return tuple(f"{store.port}[{k}] = {store.text};" for k, store in enumerate(stores))


def _status(listing: Listing) -> str:
    return " | ".join(f"(({c}) ? 0 : {1 << k})" for k, c in enumerate(listing.conditions))


def _function(
    kernel: Kernel,
    program: Program,
    options: Options,
    suffix: str,
    column_major: bool,
    precision: Precision = DOUBLE,
) -> Function:
    listing = print_program(program, _syntax(precision, options.package), scalar_names(kernel))
    scalar = precision.type
    prefix = f"{options.package}_"
    pointer = "*" if kernel.in_place else f"*{options.package.upper()}_RESTRICT "
    values = {o.name for o in kernel.outputs}
    jacobians = tuple(port.name for port in program.outputs if port.name not in values)
    passed = [*(a.name for a in kernel.arguments), *(o.name for o in kernel.outputs)]
    order = "column-major" if column_major else "row-major"
    read = {load.port for load in listing.loads}
    fixed = {o.name for o in kernel.outputs if o.laid_out}
    return Function(
        name=f"{prefix}{suffix}{precision.suffix}",
        summary=_summary(kernel, program, order, precision),
        parameters=(
            *(f"const {scalar} {pointer}{a.name}" for a in kernel.arguments),
            *(f"{scalar} {pointer}{port.name}" for port in program.outputs),
        ),
        fallback=f"{prefix}{value_name(kernel)}{precision.suffix}({', '.join(passed)})",
        unused=tuple(a.name for a in kernel.arguments if a.name not in read),
        loads=tuple(f"const {scalar} {load.name} = {load.port}[{load.index}];" for load in listing.loads),
        guard=tuple(statement(a, scalar, "int") for a in listing.guard),
        status=_status(listing),
        outputs=tuple(
            Output(
                port.name,
                port.size,
                port.name not in values,
                _stores(port, stores, column_major and port.name not in fixed),
            )
            for port, stores in zip(program.outputs, listing.stores, strict=True)
        ),
        jacobians=jacobians,
        body=tuple(statement(a, scalar, "int") for a in listing.body),
        fill=f"{options.package}_{kernel.name}_fill{precision.suffix}",
    )


def _summary(kernel: Kernel, program: Program, order: str, precision: Precision) -> str:
    single = ", in single precision" if precision is SINGLE else ""
    if not kernel.variables:
        return f"Value ({order}){single}."
    jacobians = len(program.outputs) > len(kernel.outputs)
    if jacobians:
        return f"Value and Jacobians ({order}){single}; any Jacobian may be NULL."
    return f"Value only{single}."


def _functions(kernel: Kernel, options: Options, precision: Precision) -> list[Function]:
    """Value, Jacobians by rows, Jacobians by columns, as far as they are asked for."""
    rows = [(kernel.value, value_name(kernel), False)]
    rows += [(kernel.jacobians, kernel.name, False)] if kernel.variables else []
    rows += [(kernel.jacobians, f"{kernel.name}_cm", True)] if options.layout == "col" else []
    return [_function(kernel, program, options, name, by, precision) for program, name, by in rows]


def _overlap(kernel: Kernel) -> tuple[str, ...]:
    if kernel.in_place:
        return "An output may be the array of an argument; outputs must not overlap each other.", _STATUS
    return (f"Arrays must not overlap. {_STATUS}",)


def printed(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the templates lay out."""
    if len(kernel.value.requirements) > _BITS:
        raise DefinitionError(
            f"{kernel.name} ({kernel.site}): {len(kernel.value.requirements)} requirements, but the status "
            f"of a factor has {_BITS} bits in C; join some conditions"
        )
    name = kernel.name
    chosen = precisions(options.scalar)
    functions = [f for precision in chosen for f in _functions(kernel, options, precision)]
    shapes = [f"{a.name}[{' * '.join(map(str, a.shape))}]: {argument_text(a)}" for a in kernel.arguments]
    shapes += [f"{o.name}[{' * '.join(map(str, o.shape))}]: {storage_text(o)}" for o in kernel.outputs]
    shapes += [f"{j}[{m} * {n}]: {m} x {n}, {meaning}" for j, (m, n), meaning in jacobian_texts(kernel)]
    return {
        "header": kernel_header(kernel, options),
        "factor": name,
        "guard_macro": f"{options.package}_{name}_H".upper(),
        "restrict": f"{options.package.upper()}_RESTRICT",
        "restricted": not kernel.in_place,
        "functions": tuple(functions),
        "shapes": (*_overlap(kernel), *shapes),
        "checked": bool(kernel.value.requirements),
        "own_math": any(ins.op in _OWN for ins in kernel.jacobians.code),
        "fills": tuple((f"{options.package}_{name}_fill{p.suffix}", p.type) for p in chosen),
        **printed_batches(kernel, options),
    }


HEADERS = words("""
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
    stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype
""")

TARGET = Target(
    name="c",
    printer=printed,
    public=symbols,
    files=HEADERS,
    factor_sheets=(
        Sheet("c/factor.h.j2", "c/{factor}.h"),
        Sheet("c/factor.c.j2", "c/{factor}.c"),
        Sheet("c/batch.c.j2", "c/{factor}_batch.c"),
        Sheet("c/batch_f32.c.j2", "c/{factor}_batch_f32.c", SINGLE.type),
    ),
    package_sheets=(
        Sheet("c/package.h.j2", "c/{package}.h"),
        Sheet("c/batch.h.j2", "c/{package}_batch.h"),
        Sheet("c/lanes.h.j2", "c/{package}_lanes.h"),
        Sheet("c/math.h.j2", "c/{package}_math.h"),
        Sheet("c/lanes_f32.h.j2", "c/{package}_lanes_f32.h", SINGLE.type),
    ),
    package_names={"lanes": DOUBLES, "singles": SINGLES, "polynomials": scalar_text()},
)
