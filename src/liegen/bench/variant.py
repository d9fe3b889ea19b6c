"""What is timed: a ``Variant`` is one implementation of one function, as source text and how to call it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from liegen.define import Function
from liegen.kernel import Kernel
from liegen.program import Port

AnyFunction = Function[..., Any]
T = TypeVar("T")
#: Code generation is timed this often, once if it takes longer than this [s].
REPEATS, LONG = 3, 0.3
Flags = tuple[str, ...]

#: What every variant is compiled with, by the name that tables show.
FLAGS: Mapping[str, Flags] = {
    "plain": ("-O3", "-march=native"),
    "no errno": ("-O3", "-march=native", "-fno-math-errno"),
    "scalar": ("-O3", "-march=native", "-fno-math-errno", "-fno-tree-slp-vectorize"),
    "fast math": ("-O3", "-march=native", "-ffast-math"),
    "scalar fast math": ("-O3", "-march=native", "-ffast-math", "-fno-tree-slp-vectorize"),
}


class AbsentError(Exception):
    """A peer cannot be used here; the text says why."""


@dataclass(frozen=True)
class Variant:
    """An implementation. It reads all inputs from ``a`` and writes all outputs to ``b``, port after port.

    ``note`` is the formulation in a few words, ``call`` the C statements between ``a`` and ``b``, ``sources``
    its files by name, ``options`` further compiler options. Matrices are row-major unless ``column_major``.
    ``operations`` are those of the program by kind, as its generator knows or writes them; ``seconds`` is the
    time that it took to generate, after import. Both are None where nothing is generated. ``driver`` is the
    template of its loop over inputs, which writes ``rows`` rows of outputs before it begins again.
    ``borrowed``: liegen's mathematics inside this peer, no formulation of its own.
    """

    peer: str
    version: str
    note: str
    prototype: str
    call: tuple[str, ...]
    sources: Mapping[str, str]
    operations: Mapping[str, int] | None = None
    seconds: float | None = None
    column_major: bool = False
    options: tuple[str, ...] = ()
    driver: str = "bench/driver.c.j2"
    rows: int = 1
    borrowed: bool = False

    @property
    def label(self) -> str:
        """``wrenfold: chain rule``."""
        return f"{self.peer}: {self.note}" if self.note else self.peer


@dataclass(frozen=True)
class Missing:
    """A peer that is not in the table, and the reason."""

    peer: str
    reason: str


@dataclass(frozen=True)
class Task:
    """A function to time. ``published`` ones have formulas of the peers under the same name.

    ``terms`` derives its Gauss-Newton terms, which are then timed instead of its Jacobians.
    """

    function: AnyFunction
    published: bool = False
    terms: Callable[[], Kernel] | None = None

    @cached_property
    def kernel(self) -> Kernel:
        """What is timed: value and Jacobians, or the terms."""
        return self.terms() if self.terms else self.function.kernel

    @property
    def name(self) -> str:
        """The kernel's name."""
        return self.kernel.name

    @property
    def inputs(self) -> tuple[Port, ...]:
        """All arguments, in the order of ``a``."""
        return self.kernel.jacobians.inputs

    @property
    def outputs(self) -> tuple[Port, ...]:
        """The outputs, then the Jacobians, or the terms, in the order of ``b``."""
        return self.kernel.jacobians.outputs


#: Generates the variants of one peer; raises AbsentError where that cannot be. Empty: it has no such formula.
Maker = Callable[[Task], tuple[Variant, ...]]


def fastest(generate: Callable[[], T]) -> tuple[T, float]:
    """What it gives, and processor seconds: the least of three times, of one where that is long."""
    seconds: list[float] = []
    while True:
        start = time.process_time()
        result = generate()
        seconds.append(time.process_time() - start)
        if len(seconds) == REPEATS or seconds[0] > LONG:
            return result, min(seconds)


def offsets(ports: tuple[Port, ...]) -> tuple[int, ...]:
    """Where each port begins."""
    ends = [0]
    for port in ports:
        ends.append(ends[-1] + port.size)
    return tuple(ends[:-1])
