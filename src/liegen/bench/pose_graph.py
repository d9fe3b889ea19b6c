"""A whole pose graph of SE(3) from Python, whitened: GTSAM's ``linearize`` and solver, and liegen's."""

from __future__ import annotations

import importlib
import importlib.metadata
import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.errors import SourceError
from liegen.library import between_se3
from liegen.manifolds import SE3
from liegen.modules import group_functions
from liegen.runtime import NormalEquations, SparseSolver
from liegen.runtime import compile as compiled
from liegen.runtime.sparse_solver import Backend
from liegen.uncertainty import packed

from .timing import median_ratio
from .variant import AbsentError

Array = NDArray[np.float64]
Indices = NDArray[np.int32]
#: Both sides must give the same whitened residuals and Jacobians, relative to the largest entry.
AGREEMENT = 1e-9
#: Gauss-Newton stops where an iteration lowers the error by less than this share (GTSAM's default).
TOLERANCE = 1e-5
MAX_ITERATIONS = 50
#: What is read before a call that is to find the caches without its data [bytes]: more than they hold.
SWEEP = 2**26
#: Whole solves; the fastest counts.
SOLVES = 5


@dataclass(frozen=True, eq=False)
class Edges:
    """A graph: poses (N, 7), pairs (n,), measurements (n, 7), square roots of information (n, 6, 6)."""

    poses: Array
    i: Indices
    j: Indices
    z: Array
    sqrt_info: Array


@dataclass(frozen=True)
class Row:
    """Medians, in nanoseconds an edge (processor time of all threads), and times as fast as GTSAM.

    ``cold_ns`` is a call after other work, which has driven the data out of the caches; ``warm_ns`` the same
    call right after it.
    """

    what: str
    cold_ns: float
    cold_faster: float
    warm_ns: float
    warm_faster: float


@dataclass(frozen=True)
class Solve:
    """A whole solve: processor seconds, those in linear systems if known, iterations, error 1/2 |r|^2.

    Compiling is not in it: that is done once for all graphs.
    """

    what: str
    seconds: float
    systems: float | None
    iterations: int
    error: float


@dataclass(frozen=True)
class GraphReport:
    """What was measured on a file; ``difference`` is that of both linearisations.

    ``threads`` are those that GTSAM's linearisation used, from processor time over wall time.
    """

    edges: int
    poses: int
    gtsam: str
    threads: int
    difference: float
    rows: tuple[Row, ...]
    solves: tuple[Solve, ...]

    @property
    def agrees(self) -> bool:
        """Whether both sides computed the same."""
        return self.difference <= AGREEMENT


def _gtsam() -> Any:
    try:
        return importlib.import_module("gtsam")
    except ImportError as error:
        raise AbsentError(f"GTSAM is not installed ({error})") from None


def read(path: Path) -> tuple[Any, Any, Edges]:
    """GTSAM's graph and values of a g2o file of SE(3), and the same as arrays.

    Raises AbsentError without GTSAM, SourceError for a file without such edges.
    """
    gtsam = _gtsam()
    if not path.is_file():
        raise SourceError(f"{path} is no file; give a pose graph in g2o format")
    graph, values = gtsam.readG2o(str(path), True)
    if not graph.size():
        raise SourceError(f"{path} has no edge between poses of SE(3)")
    keys = list(values.keys())
    place = {key: k for k, key in enumerate(keys)}
    factors = [graph.at(k) for k in range(graph.size())]
    pairs = np.array([[place[key] for key in list(f.keys())] for f in factors], dtype=np.int32)
    poses = np.array([_stored(values.atPose3(key)) for key in keys])
    z = np.array([_stored(f.measured()) for f in factors])
    roots = np.array([f.noiseModel().R() for f in factors])
    edges = Edges(poses, pairs[:, 0].copy(), pairs[:, 1].copy(), z, roots)
    return graph, values, edges


def _stored(pose: Any) -> list[float]:
    q = pose.rotation().toQuaternion()
    return [q.x(), q.y(), q.z(), q.w(), *pose.translation()]


def linearised(edges: Edges, noise: str = "full") -> Callable[..., Any]:
    """The call that linearises all edges at poses: whitened residuals (n, 6), Jacobians (n, 6, 6) twice.

    ``noise`` "packed" reads the upper triangles of the square roots of information, 21 numbers of 36.
    """
    kernel = compiled(between_se3.whitened(noise)).indexed(x=edges.i, y=edges.j)
    roots = packed(edges.sqrt_info) if noise == "packed" else edges.sqrt_info

    def at(poses: Array, out: Any = None) -> Any:
        return kernel.jacobians(poses, poses, z=edges.z, sqrt_info=roots, out=out)

    return at


def compare_graph(path: Path, *, rounds: int, solve: bool = True) -> GraphReport:
    """Linearise all edges in turn with GTSAM and with liegen, check that both agree, then solve with both."""
    graph, values, edges = read(path)
    ours, short = linearised(edges), linearised(edges, "packed")
    kept = ours(edges.poses)
    runs: dict[str, Callable[[], Any]] = {
        "GTSAM: graph.linearize": lambda: graph.linearize(values),
        "liegen: one call": lambda: ours(edges.poses),
        "liegen: one call into given arrays": lambda: ours(edges.poses, out=tuple(kept)),
        "liegen: the same, sqrt_info packed": lambda: short(edges.poses, out=tuple(kept)),
    }
    moved = sum(array[0].nbytes for array in (edges.poses, edges.poses, edges.z, edges.sqrt_info, *kept))
    half = np.ones(len(edges.i) * moved // 16)
    room = np.ones_like(half)
    runs["ceiling: a copy of the same bytes"] = lambda: np.copyto(room, half)
    times = measured(list(runs.values()), len(edges.i), rounds)
    rows = tuple(
        Row(
            what,
            statistics.median(cold),
            median_ratio(times[0][0], cold),
            statistics.median(warm),
            median_ratio(times[0][1], warm),
        )
        for what, (cold, warm) in zip(runs, times, strict=True)
    )
    return GraphReport(
        edges=len(edges.i),
        poses=len(edges.poses),
        gtsam=importlib.metadata.version("gtsam"),
        threads=_threads(runs["GTSAM: graph.linearize"], rounds),
        difference=max(_difference(graph.linearize(values), at(edges.poses)) for at in (ours, short)),
        rows=rows,
        solves=_solves(graph, values, edges) if solve else (),
    )


def measured(
    runs: Sequence[Callable[[], Any]], calls: int, rounds: int
) -> list[tuple[list[float], list[float]]]:
    """Nanoseconds a call of each, with cold and with warm caches, in each round; all in turn."""
    other = np.ones(SWEEP // 8)
    found: list[tuple[list[float], list[float]]] = [([], []) for _ in runs]
    for k in range(rounds + 1):
        for run, times in zip(runs, found, strict=True):
            other.sum()
            for kept in times:
                start = time.process_time_ns()
                run()
                if k:  # the first round warms up
                    kept.append((time.process_time_ns() - start) / calls)
    return found


def _solves(graph: Any, values: Any, edges: Edges) -> tuple[Solve, ...]:
    """With GTSAM, and with liegen on each factorisation that is installed."""
    ways: list[Callable[[], Solve]] = [lambda: _solved_by_gtsam(graph, values)]
    if SparseSolver().backend == "cholmod":
        ways.append(lambda: solved(edges, "cholmod"))
    ways.append(lambda: solved(edges, "superlu"))
    found = [[way() for way in ways] for _ in range(SOLVES)]
    return tuple(min(column, key=lambda s: s.seconds) for column in zip(*found, strict=True))


def _threads(run: Callable[[], Any], rounds: int) -> int:
    """At least so many threads worked; on a busy machine they may have been more."""
    wall, used = time.perf_counter(), time.process_time()
    for _ in range(rounds):
        run()
    return max(1, math.ceil((time.process_time() - used) / (time.perf_counter() - wall) - 0.1))


def _difference(linear: Any, ours: Sequence[Array]) -> float:
    """Largest difference of whitened residuals and Jacobians, relative to the largest entry."""
    res, D_x, D_y = ours
    both = np.concatenate([D_x, D_y, -res[..., None]], axis=2)
    theirs = np.array([np.column_stack(linear.at(k).jacobian()) for k in range(len(res))])
    return float(np.abs(both - theirs).max() / np.abs(theirs).max())


def _solved_by_gtsam(graph: Any, values: Any) -> Solve:
    gtsam = _gtsam()
    parameters = gtsam.GaussNewtonParams()
    parameters.setRelativeErrorTol(TOLERANCE)
    parameters.setMaxIterations(MAX_ITERATIONS)
    start = time.process_time()
    held = graph.clone() if hasattr(graph, "clone") else gtsam.NonlinearFactorGraph(graph)
    first = values.keys()[0]
    held.add(gtsam.PriorFactorPose3(first, values.atPose3(first), gtsam.noiseModel.Isotropic.Sigma(6, 1e-3)))
    optimizer = gtsam.GaussNewtonOptimizer(held, values, parameters)
    result = optimizer.optimize()
    seconds = time.process_time() - start
    return Solve("GTSAM: Gauss-Newton", seconds, None, optimizer.iterations(), graph.error(result))


def solved(edges: Edges, backend: Backend | None = None) -> Solve:
    """Gauss-Newton with liegen's normal equations; the first pose stays where it is."""
    kernel = compiled(between_se3.whitened("full")).indexed(x=edges.i, y=edges.j)
    retract = compiled(next(f for f in group_functions(SE3) if f.name == "se3_retract"))
    solver = SparseSolver(backend)
    assert kernel.gauss_newton  # compiled here
    start = time.process_time()
    blocks = {name: index.astype(np.int64) - 1 for name, index in (("x", edges.i), ("y", edges.j))}
    system, poses = NormalEquations([kernel], [blocks]), edges.poses
    iterations, error, systems = 0, float("inf"), 0.0
    while iterations < MAX_ITERATIONS:
        terms = system({"x": poses, "y": poses, "z": edges.z, "sqrt_info": edges.sqrt_info})
        if error - terms.cost < TOLERANCE * error and iterations:
            break
        error = terms.cost
        began = time.process_time()
        step = solver(terms.H, -terms.g)
        systems += time.process_time() - began
        poses = np.concatenate([poses[:1], retract(poses[1:], step.reshape(-1, 6))])
        iterations += 1
    seconds = time.process_time() - start
    name = {"cholmod": "CHOLMOD", "superlu": "SciPy's sparse LU"}[solver.backend]
    return Solve(f"liegen and {name}: Gauss-Newton", seconds, systems, iterations, error)
