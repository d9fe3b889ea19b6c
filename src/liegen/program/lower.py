"""From CasADi SX expressions to a :class:`Program`."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

from liegen.errors import DefinitionError

from .operations import Operations
from .passes.dead_code import dead
from .program import Port, Program, Requirement

ca: Any = importlib.import_module("casadi")  # ships no type information

_NAMES: Mapping[int, str] = {
    getattr(ca, name): name.removeprefix("OP_").lower() for name in dir(ca) if name.startswith("OP_")
}
#: CasADi's operations that are methods of Operations, under their own or another name.
_METHODS: Mapping[str, str] = {
    **{op: op for op in ("add", "sub", "mul", "div", "neg", "sq", "twice", "inv", "hypot", "atan2", "sign")},
    **{op: op for op in ("fmin", "fmax", "if_else_zero", "lt", "le", "eq", "ne")},
    **{"pow": "power", "constpow": "power", "not": "negation", "and": "conjunction", "or": "disjunction"},
}
#: The name of the output that is beside a program.
BESIDE = ""
#: CasADi's functions of one number -> the program's.
_FUNCTIONS: Mapping[str, str] = {
    "fabs": "abs",
    **{op: op for op in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log")},
}


def lower(
    name: str,
    inputs: Sequence[tuple[Port, Sequence[Any]]],
    outputs: Sequence[tuple[Port, Sequence[Any]]],
    requirements: Sequence[tuple[Any, str]] = (),
    beside: Sequence[Any] = (),
) -> Program:
    """Lower SX expressions to a program that computes the same numbers.

    ``inputs`` pairs each port with its SX symbols, ``outputs`` each port with its entries, flat and
    row-major: SX scalars, or Python numbers for what is known (0, 1, -1). ``requirements`` pairs an SX
    condition with its message. What is ``beside`` becomes a last output :data:`BESIDE`, without which the
    program is what it would be (:func:`alone`). At a tie (``fmin(x, x)``, ``fabs(0)``) derivatives are
    CasADi's: 1/2 each, 0.

    Raises DefinitionError for an operation that has no counterpart in generated code, for an expression
    that depends on a symbol that is no input, and for a port whose size is not its number of entries.
    """
    for port, entries in (*inputs, *outputs):
        if port.size != len(entries):
            raise DefinitionError(
                f"{name}: {port.name} has {len(entries)} entries; its shape {port.shape} needs {port.size}"
            )
    conditions = [condition for condition, _ in requirements]
    wanted = [*[x for _, entries in outputs for x in entries], *conditions, *beside]
    function = _function(name, [x for _, symbols in inputs for x in symbols], wanted)
    builder = Operations()
    found = iter(_walk(name, function, builder, sum([port.size for port, _ in inputs])))
    results = [tuple([builder.number(i) for i in islice(found, port.size)]) for port, _ in outputs]
    required = [Requirement(builder.condition(next(found)), message) for _, message in requirements]
    ports = [port for port, _ in outputs]
    if beside:
        ports.append(Port(BESIDE, (len(beside),)))
        results.append(tuple([builder.number(i) for i in found]))
    lowered = Program(
        name,
        tuple([port for port, _ in inputs]),
        tuple(ports),
        tuple(builder.code),
        tuple(results),
        tuple(required),
    )
    return dead(lowered).validate()  # CasADi's half selects, merged into whole ones, are left over


def alone(program: Program) -> Program:
    """A lowered program without what is beside it."""
    if program.outputs[-1].name != BESIDE:
        return program
    return dead(replace(program, outputs=program.outputs[:-1], results=program.results[:-1]))


def _function(name: str, symbols: list[Any], wanted: list[Any]) -> Any:
    """One CasADi function from the column of all symbols to the column of everything that is wanted."""
    column = ca.densify(ca.vertcat(*wanted)) if wanted else ca.SX(0, 1)
    options = {"allow_free": True}
    function = ca.Function("f", [ca.vertcat(*symbols) if symbols else ca.SX(0, 1)], [ca.SX(column)], options)
    if function.has_free():
        free = ", ".join(function.get_free())
        raise DefinitionError(f"{name}: the result depends on {free}, which is no argument; add it as one")
    return function


def _walk(name: str, function: Any, builder: Operations, total: int) -> list[int]:
    """Translate every instruction; CasADi's work vector is reused, so a slot only holds its latest value."""
    inputs = [builder.emit("input", (), float(k)) for k in range(total)]
    methods = _methods(builder)
    work: dict[int, int] = {}
    found = [0] * function.nnz_out(0)
    identity, taken, given = function.instruction_id, function.instruction_input, function.instruction_output
    for k in range(function.n_instructions()):
        op, args, out = _NAMES[identity(k)], taken(k), given(k)
        if op in methods:
            try:
                work[out[0]] = methods[op](*[work[a] for a in args])
            except LookupError as problem:
                raise _refused(name, problem.args[0]) from problem
        elif op == "input":
            work[out[0]] = inputs[args[1]]
        elif op == "const":
            work[out[0]] = builder.const(float(function.instruction_constant(k)))
        elif op == "output":
            found[out[1]] = work[args[0]]
        elif op in ("assign", "lift"):
            work[out[0]] = work[args[0]]
        else:
            raise _refused(name, f"the operation {op!r}")
    return found


def _methods(build: Operations) -> dict[str, Callable[..., int]]:
    """What makes instructions of each of CasADi's operations; their operands are numbers or conditions."""
    unary = {op: partial(build.unary, own) for op, own in _FUNCTIONS.items()}
    return {**unary, **{op: getattr(build, own) for op, own in _METHODS.items()}}


def _refused(name: str, what: str) -> DefinitionError:
    return DefinitionError(
        f"{name}: {what} cannot be generated; write it with + - * /, sqrt, sin, cos, tan, asin, acos, atan, "
        "atan2, exp, log, fabs, fmin, fmax and if_else"
    )
