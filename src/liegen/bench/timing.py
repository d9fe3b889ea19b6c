"""Timing variants of one function in turn, so that a change of the machine's speed meets all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence


def median_ratio(times: Sequence[float], base: Sequence[float]) -> float:
    """The median over the rounds of one variant's time by that of another in the same round."""
    return statistics.median(a / b for a, b in zip(times, base, strict=True))


def in_turn(
    runs: Sequence[Callable[[], object]],
    calls: int,
    rounds: int,
    clock: Callable[[], int] = time.thread_time_ns,
) -> list[list[float]]:
    """Nanoseconds a call of each in each round; every round runs all of them, after one warm-up.

    The clock is this thread's processor time: that of other processes on a busy machine is left out.
    """
    for run in runs:
        run()
    found: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, times in zip(runs, found, strict=True):
            start = clock()
            run()
            times.append((clock() - start) / calls)
    return found
