"""Batches from Python: ``liegen.compile`` beside jaxlie under ``jit(vmap)``, between poses of SE(3)."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.library import between_se3
from liegen.runtime import compile as compiled

from . import draws, jaxlie_vmap
from .timing import in_turn, median_ratio
from .variant import AbsentError, Missing

Array = NDArray[np.float64]
Way = Callable[[Array, Array, Array], Any]
SIZES = (1_000, 10_000)


@dataclass(frozen=True)
class BatchRow:
    """Nanoseconds a factor by the wall clock, as jax uses all cores, and the median ratio to liegen's."""

    n: int
    what: str
    minimum_ns: float
    median_ns: float
    ratio: float
    difference: float


def compare_batches(
    *, rounds: int, seed: int, sizes: Sequence[int] = SIZES
) -> tuple[tuple[BatchRow, ...], tuple[Missing, ...]]:
    """Residuals and both Jacobians of n factors in one call, in turn."""
    kernel = compiled(between_se3)

    def ours(x: Array, y: Array, z: Array) -> Any:
        return kernel.jacobians(x, y, z=z)

    ways: dict[str, Way] = {"liegen: compile": ours}
    missing: tuple[Missing, ...] = ()
    try:
        ways[f"jaxlie {jaxlie_vmap.version()}: jit(vmap)"] = jaxlie_vmap.between_batch()
    except AbsentError as reason:
        missing = (Missing("jaxlie", str(reason)),)
    drawn = draws.rows(draws.samples(between_se3, draws.RANDOM, max(sizes), seed))
    found: list[BatchRow] = []
    for n in sizes:
        x, y, z = (np.ascontiguousarray(drawn[:n, k : k + 7]) for k in (0, 7, 14))
        results = [way(x, y, z) for way in ways.values()]
        ordered = [results[0], *(jaxlie_vmap.in_order(*r) for r in results[1:])]
        times = in_turn([partial(way, x, y, z) for way in ways.values()], n, rounds, time.perf_counter_ns)
        found += [
            BatchRow(
                n, what, min(ns), statistics.median(ns),
                median_ratio(ns, times[0]),
                max(float(np.abs(a - b).max()) for a, b in zip(ordered[0], other, strict=True)),
            )
            for what, ns, other in zip(ways, times, ordered, strict=True)
        ]  # fmt: skip
    return tuple(found), missing
