"""Programs with one mistake each, to prove that the suite sees mistakes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from liegen.program import Instruction, Program
from liegen.program.rewrite import Builder, rebuilt

#: (description, program).
Mutant = tuple[str, Program]
#: Relative changes of constants.
CHANGES = (1e-3, 1e-6)

_REPLACED: dict[str, tuple[tuple[str, Callable[[Instruction], Instruction]], ...]] = {
    "add": (
        ("sign flipped", lambda i: i._replace(op="sub")),
        ("first term dropped", lambda i: _identity_of(i, 1)),
        ("second term dropped", lambda i: _identity_of(i, 0)),
    ),
    "sub": (
        ("sign flipped", lambda i: i._replace(op="add")),
        ("operands swapped", lambda i: i._replace(args=i.args[::-1])),
        ("second term dropped", lambda i: _identity_of(i, 0)),
    ),
    "div": (("operands swapped", lambda i: i._replace(args=i.args[::-1])),),
    "atan2": (("operands swapped", lambda i: i._replace(args=i.args[::-1])),),
    "mul": (("first factor dropped", lambda i: _identity_of(i, 1)),),
    "neg": (("sign dropped", lambda i: _identity_of(i, 0)),),
    "select": (("arms swapped", lambda i: i._replace(args=(i.args[0], i.args[2], i.args[1]))),),
    "lt": (("operands swapped", lambda i: i._replace(args=i.args[::-1])),),
    "le": (("operands swapped", lambda i: i._replace(args=i.args[::-1])),),
    "sin": (("cosine instead", lambda i: i._replace(op="cos")),),
    "cos": (("sine instead", lambda i: i._replace(op="sin")),),
}


def _identity_of(instruction: Instruction, operand: int) -> Instruction:
    """An instruction that stands for one operand; ``_resolved`` takes it out."""
    return Instruction("same", (instruction.args[operand],))


def mutants(program: Program, seed: int) -> Iterator[Mutant]:
    """Every mutation of every instruction, and swapped entries of every output, in a random order."""
    ways = [*_instruction_mutants(program), *_sign_mutants(program), *_output_mutants(program)]
    order: list[int] = np.random.default_rng(seed).permutation(len(ways)).tolist()
    for k in order:
        description, make = ways[k]
        yield description, make().validate()


Way = tuple[str, Callable[[], Program]]


def _instruction_mutants(program: Program) -> Iterator[Way]:
    for k, instruction in enumerate(program.code):
        for what, change in _REPLACED.get(instruction.op, ()):
            yield f"t{k} {instruction.op}: {what}", _replacing(program, k, change(instruction))
        if instruction.op == "const":
            for by in CHANGES:
                value = instruction.value * (1 + by) if instruction.value else by
                changed = instruction._replace(value=value)
                yield f"t{k} constant {instruction.value!r} changed by {by}", _replacing(program, k, changed)


def _replacing(program: Program, k: int, instruction: Instruction) -> Callable[[], Program]:
    return lambda: _resolved(program, [*program.code[:k], instruction, *program.code[k + 1 :]])


def _resolved(program: Program, code: Sequence[Instruction]) -> Program:
    """The program on ``code``, with every ``same`` replaced by what it stands for."""
    place: list[int] = []
    kept: list[Instruction] = []
    for instruction in code:
        args = tuple(place[a] for a in instruction.args)
        if instruction.op == "same":
            place.append(args[0])
            continue
        place.append(len(kept))
        kept.append(instruction._replace(args=args))
    return rebuilt(program, kept, place)


def _sign_mutants(program: Program) -> Iterator[Way]:
    """One entry of an output with the other sign."""
    for output, (port, indices) in enumerate(zip(program.outputs, program.results, strict=True)):
        for entry in range(len(indices)):
            yield f"{port.name}[{entry}]: sign flipped", _negating(program, output, entry)


def _negating(program: Program, output: int, entry: int) -> Callable[[], Program]:
    def make() -> Program:
        builder = Builder()
        builder.code.extend(program.code)
        indices = list(program.results[output])
        indices[entry] = builder.emit("neg", (indices[entry],))
        return replace(program, code=tuple(builder.code), results=_with(program, output, indices))

    return make


def _output_mutants(program: Program) -> Iterator[Way]:
    """Neighbouring entries of an output swapped, and a matrix transposed."""
    for output, (port, indices) in enumerate(zip(program.outputs, program.results, strict=True)):
        for k in range(len(indices) - 1):
            swapped = [*indices[:k], indices[k + 1], indices[k], *indices[k + 2 :]]
            yield f"{port.name}[{k}], [{k + 1}]: swapped", _reordered(program, output, swapped)
        if len(port.shape) == 2 and port.shape[0] == port.shape[1] > 1:
            order = np.arange(port.size).reshape(port.shape).T.ravel()
            transposed = [indices[i] for i in order]
            yield f"{port.name}: transposed", _reordered(program, output, transposed)


def _reordered(program: Program, output: int, indices: Sequence[int]) -> Callable[[], Program]:
    return lambda: replace(program, results=_with(program, output, indices))


def _with(program: Program, output: int, indices: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    return (*program.results[:output], tuple(indices), *program.results[output + 1 :])
