"""How code generation grows: seconds from a formula to C, and operations, over the size of the formula."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from liegen.define import Function
from liegen.manifolds import R3, SE3
from liegen.manifolds.functions import sin
from liegen.manifolds.vector import stack
from liegen.subprocesses import run
from liegen.trace import Signature

from . import ours
from .variant import AnyFunction, fastest

POSES = (1, 2, 4, 8, 16, 32, 64)
OUTPUTS = (1, 2, 5, 10, 20, 50, 100, 200)


@dataclass(frozen=True)
class Point:
    """One size: seconds from the decorated formula to the text of its C, operations with all Jacobians."""

    size: int
    seconds: float
    operations: int


@dataclass(frozen=True)
class Growth:
    """The points, and the exponents e of seconds ~ size^e and seconds ~ operations^e.

    Fitted to the larger half of the sizes: the smaller ones measure what every function costs.
    """

    what: str
    points: tuple[Point, ...]
    by_size: float
    by_operations: float


@dataclass(frozen=True)
class ColdStart:
    """Processor seconds of a new process that does what ``what`` says; None: not installed."""

    what: str
    seconds: float | None


def chain(n: int) -> AnyFunction:
    """The residual Log(z^-1 x1 x2 ... xn) of n composed poses."""

    def composed(*poses: SE3) -> Any:
        product = poses[0]
        for x in poses[1:-1]:
            product = product.compose(x)
        return poses[-1].local(product)

    xs = [Signature(f"x{k}", SE3, True, True) for k in range(n)]
    return Function(composed, (*xs, Signature("z", SE3, False, True)), f"chain{n}", "", True)


def wide(m: int) -> AnyFunction:
    """A residual of m numbers, each of a point seen from a pose, with constants of its own."""

    def stacked(x: SE3, p: R3) -> Any:
        q = x.transform_to(p)
        return stack(*(sin(q[k % 3] * (1.0 + k)) + q[(k + 1) % 3] * (0.5 * k) for k in range(m)))

    declared = Signature("x", SE3, True, True), Signature("p", R3, True, True)
    return Function(stacked, declared, f"wide{m}", "", True)


def growth(what: str, formula: Callable[[int], AnyFunction], sizes: Sequence[int]) -> Growth:
    """Time the way from tracing to C at every size."""
    points: list[Point] = []
    for size in sizes:
        made, seconds = fastest(lambda size=size: _generated(formula(size)))
        points.append(Point(size, seconds, made.kernel.jacobians.operations))
    return Growth(what, tuple(points), *exponents(points))


def _generated(function: AnyFunction) -> AnyFunction:
    ours.sources(function.kernel, batch=False)
    return function


def exponents(points: Sequence[Point]) -> tuple[float, float]:
    """Slopes of log seconds over log size and over log operations, by least squares; NaN for one point."""
    larger = points[len(points) // 2 :]
    if len(larger) < 2:
        return float("nan"), float("nan")
    seconds = np.log([p.seconds for p in larger])
    slopes = [
        float(np.polyfit(np.log(x), seconds, 1)[0])
        for x in ([float(p.size) for p in larger], [float(p.operations) for p in larger])
    ]
    return slopes[0], slopes[1]


#: What a new process runs, by name; peers without a function: their import alone.
COLD: Mapping[str, str] = {
    "python": "pass",
    "import numpy": "import numpy",
    "import liegen, its library": "import liegen.library",
    "liegen: between_se3 to C": (
        "from liegen.library import between_se3; from liegen.emit import render; "
        "render([between_se3.kernel], ['c'], package='p', regenerate='')"
    ),
    "import wrenfold": "import wrenfold",
    "import SymForce": "import symforce.symbolic, symforce.codegen",
    "import casadi": "import casadi",
}


def cold_starts(rounds: int) -> tuple[ColdStart, ...]:
    """The least processor time of new processes, all in turn."""
    seconds: dict[str, list[float]] = {what: [] for what in COLD}
    for _ in range(rounds):
        for what, code in COLD.items():
            start = _of_children()
            if not run([sys.executable, "-c", code]).failed:
                seconds[what].append(_of_children() - start)
    return tuple(ColdStart(what, min(times) if times else None) for what, times in seconds.items())


def _of_children() -> float:
    times = os.times()
    return times.children_user + times.children_system
