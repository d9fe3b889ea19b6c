"""``Program``: straight-line code over scalars in static single assignment, a frozen value.

An instruction refers to earlier instructions by their index. Inputs and constants are instructions too
(they cost nothing), so that a program is one tuple and every pass is one loop over it.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any, NamedTuple, cast

import numpy as np

from liegen.algebra import Algebra, Scalar, backend

UNARY = frozenset({"neg", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "abs"})
BINARY = frozenset({"add", "sub", "mul", "div", "atan2"})
COMMUTATIVE = frozenset({"add", "mul", "and", "or"})
CONDITIONS = frozenset({"lt", "le", "and", "or", "not"})
ARITY: Mapping[str, int] = {
    "input": 0,
    "const": 0,
    **dict.fromkeys(UNARY, 1),
    **dict.fromkeys(BINARY, 2),
    "lt": 2, "le": 2, "and": 2, "or": 2, "not": 1,
    "select": 3,
}  # fmt: skip
#: Kinds that are no arithmetic instruction.
FREE = frozenset({"input", "const"})


class Instruction(NamedTuple):
    """One operation. ``value`` is a constant's number, or an input's position in the flat list of inputs."""

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0


#: An instruction of all its fields, in two thirds of the time: passes make tens of thousands.
instruction: Callable[[tuple[str, tuple[int, ...], float]], Instruction] = partial(
    cast(Any, tuple).__new__, Instruction
)


@dataclass(frozen=True, slots=True)
class Port:
    """A named array of scalars, row-major: an input (one dimension) or an output (one or two)."""

    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of scalars."""
        return prod(self.shape)


@dataclass(frozen=True, slots=True)
class Requirement:
    """A condition that must hold: the index of its instruction, and what to say when it does not."""

    condition: int
    message: str


@dataclass(frozen=True)
class Program:
    """Named inputs, code, named outputs; ``results[k]`` are, row-major, the instructions of output ``k``."""

    name: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    code: tuple[Instruction, ...]
    results: tuple[tuple[int, ...], ...]
    requirements: tuple[Requirement, ...] = ()

    def validate(self) -> Program:
        """Return self. Raises ValueError for a reference forward, a wrong arity or a wrong size."""
        total = sum(port.size for port in self.inputs)
        for k, (op, args, value) in enumerate(self.code):
            if len(args) != ARITY.get(op, -1):
                raise ValueError(f"{self.name}: instruction {k} is no valid {op!r}")
            for a in args:
                if not 0 <= a < k:
                    raise ValueError(f"{self.name}: instruction {k} refers to a later one")
            if op == "input" and not 0 <= value < total:
                raise ValueError(f"{self.name}: instruction {k} reads input {value} of {total}")
        for port, indices in zip(self.outputs, self.results, strict=True):
            if len(indices) != port.size:
                raise ValueError(f"{self.name}: output {port.name} needs {port.size} results")
        used = [*(i for indices in self.results for i in indices), *(r.condition for r in self.requirements)]
        if not all(0 <= i < len(self.code) for i in used):
            raise ValueError(f"{self.name}: a result refers to no instruction")
        return self

    def evaluate(
        self, values: Mapping[str, Sequence[Scalar]], algebra: Algebra | None = None
    ) -> dict[str, list[Scalar]]:
        """Run the program on scalars of ``algebra`` (NumPy's by default: floats, or arrays for a batch).

        Outputs are NaN where a requirement does not hold. Returns flat lists by output name; the key
        ``"status"`` holds one list of conditions, in the order of ``requirements``.
        """
        algebra = algebra or backend("numpy")
        slots = self.run(values, algebra)
        conditions = [slots[r.condition] for r in self.requirements]
        select, conjunction, nan = (
            algebra.functions["select"],
            algebra.functions["and"],
            algebra.constant(np.nan),
        )
        out = {
            port.name: [slots[i] for i in indices]
            for port, indices in zip(self.outputs, self.results, strict=True)
        }
        if conditions:
            valid = conditions[0]
            for condition in conditions[1:]:
                valid = conjunction(valid, condition)
            out = {name: [select(valid, v, nan) for v in flat] for name, flat in out.items()}
        return {**out, "status": conditions}

    def run(self, values: Mapping[str, Sequence[Scalar]], algebra: Algebra) -> list[Scalar]:
        """The value of every instruction, in order."""
        flat = [x for port in self.inputs for x in values[port.name]]
        functions = algebra.functions
        nan = algebra.constant(np.nan)
        slots: list[Scalar] = []
        with np.errstate(all="ignore"):
            for ins in self.code:
                a = [slots[i] for i in ins.args]
                match ins.op:
                    case "input":
                        slots.append(_lifted(flat[int(ins.value)], algebra))
                    case "const":
                        slots.append(algebra.constant(ins.value))
                    case "add":
                        slots.append(a[0] + a[1])
                    case "sub":
                        slots.append(a[0] - a[1])
                    case "mul":
                        slots.append(a[0] * a[1])
                    case "div":
                        try:
                            slots.append(a[0] / a[1])
                        except ZeroDivisionError:  # mpmath raises where floats are inf or NaN
                            slots.append(nan)
                    case "neg":
                        slots.append(-a[0])
                    case op:
                        slots.append(functions[op](*a))
        return slots

    def op_counts(self) -> dict[str, int]:
        """Number of instructions by kind, inputs and constants left out, in alphabetical order."""
        counts = Counter([ins.op for ins in self.code])
        return {op: count for op, count in sorted(counts.items()) if op not in FREE}

    @property
    def operations(self) -> int:
        """Number of arithmetic instructions: selects, negations, comparisons and calls included."""
        return len(self.code) - [ins.op in FREE for ins in self.code].count(True)

    def operations_of(self, names: Collection[str]) -> int:
        """Number of arithmetic instructions that the outputs with these names need."""
        needed = bytearray(len(self.code))
        for port, indices in zip(self.outputs, self.results, strict=True):
            if port.name in names:
                for i in indices:
                    needed[i] = 1
        count = 0
        for k in range(needed.rfind(1), -1, -1):
            if needed[k]:
                op, args, _ = self.code[k]
                count += op not in FREE
                for a in args:
                    needed[a] = 1
        return count

    def digest(self) -> str:
        """SHA-256 of the program's text, equal on every machine."""
        return hashlib.sha256(str(self).encode()).hexdigest()

    def __str__(self) -> str:
        lines = [f"program {self.name}({', '.join(f'{p.name}{list(p.shape)}' for p in self.inputs)})"]
        for k, ins in enumerate(self.code):
            detail = float(ins.value).hex() if ins.op == "const" else str(int(ins.value))
            operands = [detail] if ins.op in FREE else [f"t{a}" for a in ins.args]
            lines.append(f"  t{k} = {ins.op} {' '.join(operands)}")
        lines += [f"  require t{r.condition} {r.message!r}" for r in self.requirements]
        for port, indices in zip(self.outputs, self.results, strict=True):
            lines.append(f"  {port.name}{list(port.shape)} = {' '.join(f't{i}' for i in indices)}")
        return "\n".join(lines) + "\n"


def _lifted(x: Scalar, algebra: Algebra) -> Scalar:
    """Plain Python numbers become scalars of the algebra: they raise where the algebra's are inf or NaN."""
    return algebra.constant(x) if isinstance(x, (int, float)) else x
