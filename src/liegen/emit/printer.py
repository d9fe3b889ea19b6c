"""From a ``Program`` to statements: one algorithm for every language, a ``Syntax`` says how things are spelt.

Values used once are written into the expression that uses them as long as the line stays short; the rest
become temporaries ``t0, t1, ...`` in order of emission. The operands of every operation stay as they are in
the program, so floating-point results do not depend on how the text is laid out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np

from liegen.algebra import backend
from liegen.program import Program
from liegen.program.program import CONDITIONS

from .syntax import Expression, Syntax

#: Longest expression that is written on one line, in characters.
WIDTH = 70
#: As wide as a temporary's name gets in a usual program.
PLACEHOLDER = Expression("t000")

#: A pair is two scalars that one statement fills.
Kind = Literal["scalar", "condition", "pair"]


@dataclass(frozen=True, slots=True)
class Load:
    """A scalar of an argument that the program reads."""

    name: str
    port: str
    index: int


@dataclass(frozen=True, slots=True)
class Assignment:
    """A temporary and its value; for a pair both names, and the statement that fills them.

    ``only``: the one output that needs it, empty where more than one do.
    """

    name: str
    kind: Kind
    text: str
    only: str = ""


@dataclass(frozen=True, slots=True)
class Store:
    """An entry of an output and its value."""

    port: str
    index: tuple[int, ...]
    text: str


@dataclass(frozen=True)
class Listing:
    """A printed program: loads, what the requirements' ``conditions`` need, the other temporaries, stores.

    ``stores`` holds the entries of every output, row-major. They come last: a C compiler makes the fastest
    code when an output that may be NULL is one block (measured, 6 % against stores between the operations).
    """

    loads: tuple[Load, ...]
    guard: tuple[Assignment, ...]
    conditions: tuple[str, ...]
    body: tuple[Assignment, ...]
    stores: tuple[tuple[Store, ...], ...]


@dataclass(frozen=True)
class _Usage:
    """What is computed at all and how often it is read, what the requirements need, what is constant."""

    counts: Mapping[int, int]
    guard: frozenset[int]
    constants: Mapping[int, Any]


def _constants(program: Program) -> dict[int, Any]:
    """Values of the instructions whose operands are all constants: Python would trip over ``1.0 / 0.0``."""
    functions = backend("numpy").functions
    arithmetic = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "neg": np.negative}
    known: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for k, ins in enumerate(program.code):
            if ins.op == "const":
                known[k] = float(ins.value)
            elif ins.args and ins.args[0] in known and all(a in known for a in ins.args):
                call = arithmetic.get(ins.op) or functions[ins.op]
                value = np.asarray(call(*(np.asarray(known[a])[()] for a in ins.args)))
                known[k] = value.item()
    return known


def _reads(program: Program, roots: Sequence[int], constants: Mapping[int, Any]) -> Mapping[int, int]:
    """How often every instruction that the roots need is read."""
    counts = dict(Counter(roots))
    for k in range(len(program.code) - 1, -1, -1):
        if k in counts and k not in constants:
            for a in program.code[k].args:
                counts[a] = counts.get(a, 0) + 1
    return counts


def _usage(program: Program) -> _Usage:
    constants = _constants(program)
    conditions = [r.condition for r in program.requirements]
    results = [i for indices in program.results for i in indices]
    counts = _reads(program, [*results, *conditions], constants)
    return _Usage(counts, frozenset(_reads(program, conditions, constants)), constants)


def _kinds(program: Program) -> list[Kind]:
    """Whether each instruction is a number or a condition (a select between conditions is one)."""
    kinds: list[Kind] = []
    for op, args, _ in program.code:
        chosen = op == "select" and all(kinds[a] == "condition" for a in args[1:])
        kinds.append("condition" if chosen or op in CONDITIONS else "scalar")
    return kinds


def condition_indices(program: Program) -> frozenset[int]:
    """The selects whose arms are conditions, and every other condition."""
    return frozenset(k for k, kind in enumerate(_kinds(program)) if kind == "condition")


def _leaves(program: Program, syntax: Syntax, scalars: Sequence[str], usage: _Usage) -> dict[int, Expression]:
    """The texts of inputs and constants."""
    inputs = {
        k: Expression(scalars[int(ins.value)]) for k, ins in enumerate(program.code) if ins.op == "input"
    }
    return {**inputs, **{k: syntax.literal(value) for k, value in usage.constants.items()}}


def _temporaries(
    program: Program,
    syntax: Syntax,
    leaves: Mapping[int, Expression],
    usage: _Usage,
    pairs: Mapping[int, tuple[int, int]],
) -> set[int]:
    """The instructions that get a name: read more than once, too long for their line, or paired."""
    chosen = {k for k, count in usage.counts.items() if (count > 1 and k not in leaves) or k in pairs}
    texts = dict(leaves)
    for k in sorted(usage.counts.keys() - leaves.keys()):
        ins = program.code[k]
        own = syntax.express(ins.op, [texts[a] for a in ins.args])
        while len(own.text) > WIDTH:
            inlined = [a for a in ins.args if a not in leaves and a not in chosen]
            if not inlined:
                break
            longest = max(inlined, key=lambda a: len(texts[a].text))
            chosen.add(longest)
            texts[longest] = PLACEHOLDER
            own = syntax.express(ins.op, [texts[a] for a in ins.args])
        texts[k] = PLACEHOLDER if k in chosen else own
    return chosen


def _pairs(program: Program, syntax: Syntax, usage: _Usage) -> dict[int, tuple[int, int]]:
    """(sine, cosine) of one angle, by either of them, where the language has one call for both."""
    if not syntax.sincos:
        return {}
    used = [k for k in usage.counts if k not in usage.constants]
    sines, cosines = (
        {program.code[k].args[0]: k for k in used if program.code[k].op == op} for op in ("sin", "cos")
    )
    pairs = {(sines[a], cosines[a]) for a in sines.keys() & cosines.keys()}
    same = [p for p in pairs if (p[0] in usage.guard) == (p[1] in usage.guard)]
    return {k: pair for pair in same for k in pair}


def _loads(program: Program, scalars: Sequence[str], usage: _Usage) -> tuple[Load, ...]:
    owners = [(port.name, n) for port in program.inputs for n in range(port.size)]
    read = {int(program.code[k].value) for k in usage.counts if program.code[k].op == "input"}
    return tuple(Load(scalars[n], *owners[n]) for n in sorted(read))


def _readers(program: Program) -> list[frozenset[str]]:
    """By instruction, the outputs that need it."""
    found: list[set[str]] = [set() for _ in program.code]
    for port, indices in zip(program.outputs, program.results, strict=True):
        for k in indices:
            found[k].add(port.name)
    for k in range(len(program.code) - 1, -1, -1):
        for a in program.code[k].args:
            found[a] |= found[k]
    return [frozenset(names) for names in found]


def _only(names: Collection[str]) -> str:
    return next(iter(names)) if len(names) == 1 else ""


def print_program(program: Program, syntax: Syntax, scalars: Sequence[str]) -> Listing:
    """The statements of a program. ``scalars`` names its inputs, in the order of the flat list of inputs."""
    usage = _usage(program)
    texts = _leaves(program, syntax, scalars, usage)
    pairs = _pairs(program, syntax, usage)
    named = _temporaries(program, syntax, texts, usage, pairs)
    kinds = _kinds(program)
    readers = _readers(program)
    guard: list[Assignment] = []
    body: list[Assignment] = []
    count = 0
    for k in sorted(usage.counts.keys() - texts.keys(), key=lambda k: (k not in usage.guard, k)):
        ins, block = program.code[k], guard if k in usage.guard else body
        if k in texts:  # the second of a pair
            continue
        if k in pairs:
            names = f"t{count}", f"t{count + 1}"
            call = syntax.sincos.format(syntax.result(texts[ins.args[0]]), *names)
            block.append(
                Assignment(", ".join(names), "pair", call, _only(readers[pairs[k][0]] | readers[pairs[k][1]]))
            )
            texts |= dict(zip(pairs[k], map(Expression, names), strict=True))
            count += 2
            continue
        texts[k] = syntax.express(ins.op, [texts[a] for a in ins.args])
        if k in named:
            block.append(Assignment(f"t{count}", kinds[k], texts[k].text, _only(readers[k])))
            texts[k] = Expression(f"t{count}")
            count += 1
    return Listing(
        loads=_loads(program, scalars, usage),
        guard=tuple(guard),
        conditions=tuple(texts[r.condition].text for r in program.requirements),
        body=tuple(body),
        stores=tuple(
            tuple(
                Store(port.name, place, syntax.result(texts[k]))
                for place, k in zip(product(*map(range, port.shape)), indices, strict=True)
            )
            for port, indices in zip(program.outputs, program.results, strict=True)
        ),
    )
