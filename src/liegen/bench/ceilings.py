"""What the machine can do at most, measured in the same run: multiply-adds, and copied bytes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from liegen.emit.templates import lay_out
from liegen.native import compile_shared, load_shared

from .build import Array
from .timing import in_turn

#: Independent sums in the loop: more than latency times units of today's processors.
CHAINS = 12
#: A loop that is left as it is written.
FLAGS = ("-O2", "-march=native", "-fno-tree-vectorize", "-fno-tree-slp-vectorize")
STEPS = 20_000
Loop = Callable[[], None]
CFunction = Any  # of ctypes


@dataclass(frozen=True)
class Ceilings:
    """Multiply-adds a nanosecond, of numbers and of vectors of ``width`` numbers (as instructions)."""

    scalar: float
    vector: float
    width: int


@dataclass(frozen=True)
class Machine:
    """The loaded loops; they stay loaded as long as the process."""

    library: ctypes.CDLL

    def copy(self, repeats: int, size: int, source: Array, target: Array) -> Loop:
        """Copies of ``size`` bytes: twice as many are moved, half of them read and half written."""
        return whole(self.library["copy"], repeats, size, source, target)

    def _loop(self, name: str, n: int, source: Array, target: Array) -> Loop:
        function = self.library[name]
        function.argtypes = [ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
        function.restype = None
        return lambda: function(n, source.ctypes.data, target.ctypes.data)

    def arithmetic(self, rounds: int) -> Ceilings:
        """Time both loops."""
        source, target = np.full(16, 0.5), np.zeros(16)
        names = ("scalar_multiply_add", "vector_multiply_add")
        times = in_turn([self._loop(name, STEPS, source, target) for name in names], STEPS * CHAINS, rounds)
        return Ceilings(1 / min(times[0]), 1 / min(times[1]), int(self.library["width"]()))


def whole(function: CFunction, repeats: int, n: int, source: Array, target: Array) -> Loop:
    """The call ``function(repeats, n, source, target)`` of C."""
    function.argtypes = [ctypes.c_ssize_t, ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
    function.restype = None
    return lambda: function(repeats, n, source.ctypes.data, target.ctypes.data)


def load_loops(folder: Path) -> Machine:
    """Compile the loops in a folder."""
    source, library = folder / "ceilings.c", folder / "ceilings.so"
    source.write_text(lay_out("bench/ceilings.c.j2", {"chains": CHAINS}), encoding="utf-8")
    compile_shared([source], library, FLAGS)
    return Machine(load_shared(library))
