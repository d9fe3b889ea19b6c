"""The statements of a factor on Python's own floats, much faster than arrays for a single element.

Python raises (ZeroDivisionError, ValueError, OverflowError) where arrays hold inf or NaN; callers then turn
to the arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

from liegen.kernel import Kernel
from liegen.program import Program

from .numpy_target import SYNTAX as ARRAYS
from .printer import print_program
from .syntax import COMPARISON, PREFIX, PRODUCT, SUM, Operator, Syntax, spell
from .target import scalar_names
from .templates import lay_out

SYNTAX = Syntax(
    operators={
        "add": Operator("+", SUM, "sum"), "sub": Operator("-", SUM, "sum"),
        "mul": Operator("*", PRODUCT, "product"), "div": Operator("/", PRODUCT, "product"),
        "neg": Operator("-", PREFIX), "not": Operator("not ", COMPARISON - 1),
        "lt": Operator("<", COMPARISON), "le": Operator("<=", COMPARISON),
        "and": Operator("and", COMPARISON - 2, "and"), "or": Operator("or", COMPARISON - 3, "or"),
    },
    calls={
        "sqrt": "sqrt", "sin": "sin", "cos": "cos", "tan": "tan", "asin": "asin", "acos": "acos",
        "atan": "atan", "exp": "exp", "log": "log", "abs": "fabs", "atan2": "atan2",
    },
    constant=spell("nan", "inf"),
    truth={True: "True", False: "False"},
    choice="{1} if {0} else {2}",
)  # fmt: skip
_IMPORTS = (*sorted(SYNTAX.calls.values()), "inf", "nan")


@dataclass(frozen=True)
class Function:
    """A function of one program: a list of floats for each argument of a call in, for each output out.

    It returns None outside of the domain.
    """

    name: str
    unpacked: str
    guard: tuple[str, ...]
    invalid: str
    body: tuple[str, ...]
    results: tuple[tuple[str, ...], ...]


def unpacked(kernel: Kernel) -> str:
    """What the arguments of a call are assigned to: ``(x_qx, ...,), (z_qx, ...,),``."""
    names = iter(scalar_names(kernel))
    groups = {a.name: [next(names) for _ in range(a.size)] for a in kernel.arguments}
    called = [groups[a.name] for a in (*kernel.positional, *kernel.keywords)]
    return "".join(f"({', '.join(group)},), " for group in called).rstrip()


def _function(name: str, kernel: Kernel, program: Program) -> Function:
    listing = print_program(program, SYNTAX, scalar_names(kernel))
    return Function(
        name=name,
        unpacked=unpacked(kernel),
        guard=tuple(f"{a.name} = {a.text}" for a in listing.guard),
        invalid=" or ".join(f"not ({condition})" for condition in listing.conditions),
        body=tuple(f"{a.name} = {a.text}" for a in listing.body),
        results=tuple(tuple(store.text for store in stores) for stores in listing.stores),
    )


def floats_source(kernel: Kernel) -> str:
    """A Python module with ``value`` and, where there are variables, ``jacobians``."""
    functions = [_function("value", kernel, kernel.value)]
    if kernel.variables:
        functions.append(_function("jacobians", kernel, kernel.jacobians))
    return lay_out("runtime/floats.py.j2", {"imports": _IMPORTS, "functions": functions})


def conditions_source(kernel: Kernel) -> str:
    """A Python module whose ``conditions`` says, on arrays of components, which requirements hold."""
    listing = print_program(kernel.value, ARRAYS, scalar_names(kernel))
    names = {
        "unpacked": unpacked(kernel),
        "guard": [f"{a.name} = {a.text}" for a in listing.guard],
        "conditions": listing.conditions,
    }
    return lay_out("runtime/conditions.py.j2", names)
