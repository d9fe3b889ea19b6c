"""The NumPy target: a package with one module per factor that imports NumPy only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from liegen.kernel import Argument, Kernel
from liegen.program import Port, Program

from .header import array_text, interface_doc, kernel_header
from .printer import Listing, Load, print_program
from .syntax import COMPARISON, PREFIX, PRODUCT, SUM, Operator, Syntax, spell
from .target import Options, Sheet, Target, scalar_names, words

SYNTAX = Syntax(
    operators={
        "add": Operator("+", SUM, "sum"), "sub": Operator("-", SUM, "sum"),
        "mul": Operator("*", PRODUCT, "product"), "div": Operator("/", PRODUCT, "product"),
        "neg": Operator("-", PREFIX), "not": Operator("~", PREFIX),
        "lt": Operator("<", COMPARISON), "le": Operator("<=", COMPARISON),
        "and": Operator("&", COMPARISON + 2, "and"), "or": Operator("|", COMPARISON + 1, "or"),
    },
    calls={
        "sqrt": "np.sqrt", "sin": "np.sin", "cos": "np.cos", "tan": "np.tan", "asin": "np.arcsin",
        "acos": "np.arccos", "atan": "np.arctan", "exp": "np.exp", "log": "np.log", "abs": "np.abs",
        "atan2": "np.arctan2", "select": "np.where",
    },
    constant=spell("np.nan", "np.inf"),
    truth={True: "np.True_", False: "np.False_"},
)  # fmt: skip

#: Longest line of a signature.
LINE = 100


@dataclass(frozen=True)
class Function:
    """A private function of a module: the statements that fill component-first arrays."""

    signature: str
    outputs: tuple[str, ...]
    loads: tuple[str, ...]
    statements: tuple[str, ...]
    stores: tuple[str, ...]
    invalid: str


@dataclass(frozen=True)
class Interface:
    """A public function of a module."""

    signature: str
    arguments: tuple[str, ...]
    result: str
    record: str
    record_doc: str
    fields: tuple[tuple[str, str], ...]
    doc: tuple[str, ...]


def camel(name: str) -> str:
    """``BetweenSe3`` of ``between_se3``."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def public_names(kernel: Kernel) -> tuple[str, ...]:
    """What the module of a kernel exports."""
    record = camel(kernel.name)
    several = (f"{record}Outputs",) if len(kernel.outputs) > 1 else ()
    jacobians = (f"{record}Jacobians", f"{kernel.name}_jacobians") if kernel.variables else ()
    return (*jacobians, *several, kernel.name)


def _loads(listing: Listing, arguments: Sequence[Argument]) -> tuple[str, ...]:
    lines: list[str] = []
    for argument in arguments:
        mine = [load for load in listing.loads if load.port == argument.name]
        if mine:
            if len(argument.shape) > 1:
                lines += _matrix_loads(mine, argument)
                continue
            rows = [f"{argument.name}[{load.index}]" for load in mine]
            source = argument.name if len(mine) == argument.size > 1 else ", ".join(rows)
            lines.append(f"{', '.join(load.name for load in mine)} = {source}")
    return tuple(lines)


def _matrix_loads(loads: Sequence[Load], argument: Argument) -> Iterator[str]:
    """A line for each run of entries in a row of a matrix."""
    columns = argument.shape[-1]
    for row in range(argument.shape[0]):
        mine = [load for load in loads if load.index // columns == row]
        if not mine:
            continue
        first, last = mine[0].index, mine[-1].index
        whole = last - first == len(mine) - 1 > 0
        picked = ", ".join(f"{argument.name}[{load.index}]" for load in mine)
        source = f"{argument.name}[{first}:{last + 1}]" if whole else picked
        yield f"{', '.join(load.name for load in mine)} = {source}"


def _function(name: str, kernel: Kernel, program: Program) -> Function:
    listing = print_program(program, SYNTAX, scalar_names(kernel))
    arguments = [a.name for a in kernel.arguments]
    outputs = tuple(port.name for port in program.outputs)
    # Outputs arrive filled with zeros.
    stores = [s for group in listing.stores for s in group if s.text != SYNTAX.constant(0.0)]
    loads = _loads(listing, kernel.arguments)
    return Function(
        signature=_broken(f"def {name}(", [f"{n}: Array" for n in (*arguments, *outputs)], ") -> None:"),
        outputs=outputs,
        loads=loads if loads or stores or listing.conditions else ("pass",),
        statements=tuple(f"{a.name} = {a.text}" for a in (*listing.guard, *listing.body)),
        stores=tuple(f"{s.port}[{', '.join(map(str, s.index))}] = {s.text}" for s in stores),
        invalid=" | ".join(f"~({c})" for c in listing.conditions),
    )


def _broken(opening: str, items: Sequence[str], closing: str, *, comma: bool = False) -> str:
    """A bracket on one line, or with one item a line where that gets too long."""
    tail = "," if comma and len(items) == 1 else ""
    line = f"{opening}{', '.join(items)}{tail}{closing}"
    pad = " " * (len(opening) - len(opening.lstrip()))
    lines = [opening, *(f"{pad}    {item}," for item in items), pad + closing]
    return line if len(line) <= LINE else "\n".join(lines)


def _shape(port: Port) -> str:
    return array_text(port.shape)


def _argument(kernel: Kernel, a: Argument) -> str:
    """What a public function hands to ``evaluate``: name, array and number of components."""
    flat = f'flat("{kernel.name}", "{a.name}", {a.name}, {a.shape})' if len(a.shape) > 1 else a.name
    return f'("{a.name}", {flat}, {a.size})'


def _interface(kernel: Kernel, program: Program, name: str, private: str, record: str) -> Interface:
    typed = [f"{a.name}: npt.ArrayLike" for a in kernel.positional]
    typed += ["*"] if kernel.keywords else []
    typed += [
        f"{a.name}: npt.ArrayLike" + " = " * bool(a.default_text) + a.default_text for a in kernel.keywords
    ]
    shapes = _broken("    shapes = (", [repr(port.shape) for port in program.outputs], ")", comma=True)
    call = f'evaluate({private}, "{name}", values, shapes)'
    return Interface(
        signature=_broken(f"def {name}(", typed, f") -> {record or 'Array'}:"),
        arguments=tuple(_argument(kernel, a) for a in kernel.arguments),
        result=f"{shapes.lstrip()}\n    return {f'{record}(*{call})' if record else f'{call}[0]'}",
        record=record,
        record_doc=f"What :func:`{name}` returns.",
        fields=tuple((port.name, _shape(port)) for port in program.outputs),
        doc=interface_doc(kernel, program),
    )


def printed(kernel: Kernel, options: Options) -> Mapping[str, object]:
    """The names that the templates lay out."""
    several = len(kernel.outputs) > 1
    record, alone = camel(kernel.name), f"{camel(kernel.name)}Outputs" if several else ""
    jacobians = f"{kernel.name}_jacobians"
    functions = [_function("_value", kernel, kernel.value)]
    interfaces = [_interface(kernel, kernel.value, kernel.name, "_value", alone)]
    if kernel.variables:
        functions.append(_function("_jacobians", kernel, kernel.jacobians))
        interfaces.append(_interface(kernel, kernel.jacobians, jacobians, "_jacobians", f"{record}Jacobians"))
    lines = [line for f in functions for line in (*f.statements, *f.stores)]
    return {
        "header": kernel_header(kernel, options),
        "factor": kernel.name,
        "differentiated": bool(kernel.variables),
        "uses_numpy": any("np." in line for line in lines) or any(f.invalid for f in functions),
        "matrices": any(len(a.shape) > 1 for a in kernel.arguments),
        "exports": sorted(public_names(kernel)),
        "functions": tuple(functions),
        "interfaces": tuple(interfaces),
    }


TARGET = Target(
    name="numpy",
    printer=printed,
    public=public_names,
    files=words("support"),
    factor_sheets=(Sheet("numpy/factor.py.j2", "{package}/_{factor}.py"),),
    package_sheets=(
        Sheet("numpy/package.py.j2", "{package}/__init__.py"),
        Sheet("numpy/support.py.j2", "{package}/_support.py"),
        Sheet("numpy/typed.j2", "{package}/py.typed"),
    ),
)
