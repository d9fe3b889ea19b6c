"""Timing variants of one function in turn, so that a change of the machine's speed meets all of them."""

from __future__ import annotations

import ctypes
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Run = Callable[[], None]


@dataclass(frozen=True)
class Row:
    """A variant's nanoseconds a call, and its median ratio to the first variant, round by round."""

    name: str
    minimum_ns: float
    median_ns: float
    ratio: float
    operations: int | None
    error: float


def in_turn(variants: Mapping[str, Run], calls: int, rounds: int) -> dict[str, list[float]]:
    """Nanoseconds a call of each variant in each round; every round runs all of them."""
    for run in variants.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in variants}
    for _ in range(rounds):
        for name, run in variants.items():
            start = time.perf_counter_ns()
            run()
            seconds[name].append((time.perf_counter_ns() - start) / calls)
    return seconds


def summarise(
    times: Mapping[str, Sequence[float]], operations: Mapping[str, int | None], errors: Mapping[str, float]
) -> tuple[Row, ...]:
    """One row a variant; the first is the base of the ratios."""
    base = next(iter(times.values()))
    return tuple(
        Row(
            name,
            min(ns),
            statistics.median(ns),
            statistics.median(a / b for a, b in zip(ns, base, strict=True)),
            operations[name],
            errors[name],
        )
        for name, ns in times.items()
    )


def driver(library: ctypes.CDLL, name: str, inputs: NDArray[np.float64], outputs: NDArray[np.float64]) -> Run:
    """Call ``drive_<name>`` over all inputs, each call into the same output buffer."""
    function = library[f"drive_{name}"]
    function.argtypes = [ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
    function.restype = None
    n, source, target = len(inputs), inputs.ctypes.data, outputs.ctypes.data
    return lambda: function(n, source, target)
