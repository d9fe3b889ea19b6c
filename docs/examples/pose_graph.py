"""Solve a pose graph with compiled factors: `python docs/examples/pose_graph.py [FILE.g2o]`.

A pose graph has unknown poses x_1 ... x_N in a world frame, perhaps points, and edges: each is a measurement.
An edge between poses is a measurement z of pose j in the frame of pose i. Its residual is the library's
between factor, r = Log(z^-1 x_i^-1 x_j), whitened by the noise of the edge:
`between_se3.whitened(noise="full")` (2D: `between_se2`). `equations.py` has those of the other edges. The
best poses and points minimise

    error = 1/2 sum |S r|^2,    S^T S = information matrix of the edge.

Edges alone leave the whole graph free to move, so vertices of `FIX` lines are no unknowns; where there is no
such line, and no prior, the first pose is held.

What a solver of your own takes from here is short:

1. `system_of` in `equations.py`: `liegen.NormalEquations` adds up H = J^T J and g = J^T r of all edges, in
   compiled code. It reads the poses through the edge list; a block number of -1 holds a vertex.
2. `liegen.SparseSolver` solves (H + damping diag H) d = -g; what the pattern decides is done once.
3. `retracted`: the Jacobians are those of x Exp(d), so that is how a step d is applied (3D: rotation first).

Without a file it makes a sphere: a robot winds up around it, with noisy odometry, and measures where it is
relative to the ring below.

Needs SciPy, and matplotlib for the picture (`pip install liegen[examples]`). CHOLMOD solves the linear
systems where it is installed (`pip install liegen[cholesky]`), else SciPy's LU, which takes longer. Where
there is no C compiler the factors run as NumPy code.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
import numpy as np
from equations import DIM, Values, retracted, start, system_of
from g2o import Floats, Graph, read_g2o, written
from g2o_lines import G2oError
from picture import draw, require_picture
from sphere import made_sphere

import liegen
from liegen.runtime.normal_equations import Terms

FIRST_DAMPING, SMALLEST_DAMPING, LARGEST_DAMPING = 1e-6, 1e-12, 1e6  # relative to the diagonal of J^T J


# --- the solver -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Iterate:
    """Where the solver stands after one linear system."""

    number: int
    values: Values
    error: float
    decrease: float = 0.0  # of the error, relative; negative: the step was refused
    step: float = 0.0  # norm of d
    damping: float = FIRST_DAMPING  # of the next system
    loose: int | None = None  # a vertex that the edges leave free, known at the end
    converged: bool = False


def levenberg_marquardt(graph: Graph, tol: float = 1e-9, max_iterations: int = 100) -> Iterator[Iterate]:
    """Gauss-Newton, damped when a step does not decrease the error (Nocedal & Wright 2006, section 10.3).

    Converged: a step changes, or by its linear model would change, the error by a share of at most `tol`, or
    no number in the step is larger than `tol`.
    """
    at, solver = system_of(graph), liegen.SparseSolver()
    terms = at(start(graph))
    now = Iterate(0, start(graph), terms.cost)
    if not np.isfinite(now.error):
        raise RuntimeError("the error at the start is not a number: check the poses and measurements")
    require_measured(graph, terms.H)
    if not len(terms.g):
        now = replace(now, converged=True)
    yield now
    while not now.converged and now.number < max_iterations:
        d = damped_step(solver, terms, now.damping)
        values = retracted(graph, now.values, d)
        new = at(values)
        decrease = (now.error - new.cost) / now.error if now.error > 0 else 0.0
        negligible = -(terms.g @ d) <= tol * now.error or np.abs(d).max() <= tol
        now = replace(now, number=now.number + 1, decrease=decrease, step=float(np.linalg.norm(d)))
        if new.cost <= now.error:
            terms = new
            damping = max(now.damping / 10, SMALLEST_DAMPING)
            converged = bool(negligible or decrease <= tol)
            now = replace(now, values=values, error=new.cost, damping=damping, converged=converged)
        else:  # also when it is not a number
            now = replace(now, damping=now.damping * 10, converged=bool(negligible))
        if now.damping > LARGEST_DAMPING:
            raise RuntimeError(f"no step decreases the error {now.error:.6g}: is a measurement far off?")
        yield replace(now, loose=loose_vertex(graph, terms.H)) if now.converged else now


def damped_step(solver: liegen.SparseSolver, terms: Terms, damping: float) -> Floats:
    """The step; where H is singular and the damping too small for its rounding, with more of it."""
    while True:
        try:
            return solver(terms.H, -terms.g, damping)
        except np.linalg.LinAlgError:
            damping *= 10
            if damping > LARGEST_DAMPING:
                raise


def require_measured(graph: Graph, H: Any) -> None:
    """Each number of a step needs an edge that depends on it; raises RuntimeError with the vertex."""
    missing = np.flatnonzero(H.diagonal() == 0)
    if missing.size:
        vertex = owner(graph, missing[0])
        raise RuntimeError(
            f"no edge measures all of vertex {vertex}: the information of its edges is 0 in some direction. "
            f"Add an edge or a prior, or `FIX {vertex}`."
        )


def loose_vertex(graph: Graph, H: Any) -> int | None:
    """The vertex that moves most in a direction that no edge measures, to rounding; None without one.

    Inverse iteration on H, scaled to a diagonal of 1, for its smallest eigenvalue.
    """
    solver, scale = liegen.SparseSolver(), np.sqrt(H.diagonal())
    v = np.random.default_rng(0).normal(size=len(scale))
    growth = 0.0
    for _ in range(3):
        try:
            found = scale * solver(H, scale * v / np.linalg.norm(v), SMALLEST_DAMPING)
        except np.linalg.LinAlgError:
            return None
        growth, v = float(np.linalg.norm(found)), found
    return owner(graph, int(np.argmax(np.abs(v)))) if growth > 0.5 / SMALLEST_DAMPING else None


def owner(graph: Graph, place: int) -> int:
    """The id of the vertex that has this number of a step."""
    ids = [np.repeat(own.ids[~own.held], DIM[name]) for name, own in graph.vertices.items()]
    return int(np.concatenate(ids)[place])


# --- the command line ---------------------------------------------------------------------------------------


def between_0_and_1(_context: click.Context, parameter: click.Parameter, value: float) -> float:
    if not 0 <= value < 1:  # also what is no number
        raise click.BadParameter(f"{value} is not in the range 0<=x<1.", param=parameter)
    return value


@click.command(help="Solve the pose graph in FILE (.g2o, 2D or 3D); without FILE, a made sphere.")
@click.argument("file", required=False, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--output", type=click.Path(dir_okay=False, path_type=Path), help="Solved graph, a .g2o file.")
@click.option("--out", default="pose_graph.png", show_default=True, help="Picture, before and after.")
@click.option("--no-picture", is_flag=True, help="Solve without matplotlib.")
@click.option(
    "--tol",
    default=1e-9,
    show_default=True,
    callback=between_0_and_1,
    help="Relative change of the error to stop at.",
)
@click.option("--max-iterations", default=100, show_default=True, type=click.IntRange(0))
def main(
    file: Path | None, output: Path | None, out: str, no_picture: bool, tol: float, max_iterations: int
) -> None:
    try:
        if not no_picture:
            require_picture(Path(out))
        if output and not output.absolute().parent.is_dir():
            raise G2oError(f"--output {output}: there is no folder {output.parent}; make it first.")
        if output and not os.access(output if output.exists() else output.absolute().parent, os.W_OK):
            raise G2oError(f"--output {output}: it cannot be written; choose another place.")
        graph = read_g2o(file) if file else made_sphere()
        click.echo(describe(graph, file))
        first, last = run(graph, tol, max_iterations)
        if output:
            output.write_text(written(graph, last.values), encoding="utf-8", errors="surrogateescape")
            click.echo(f"solved graph: {output}")
        if not no_picture:
            draw(graph, (first.values, first.error), (last.values, last.error), Path(out))
            click.echo(f"picture: {out}")
    except (G2oError, RuntimeError, OSError, np.linalg.LinAlgError) as error:
        raise click.ClickException(str(error)) from error
    if not last.converged:
        raise click.ClickException(f"not converged in {max_iterations} iterations: raise --max-iterations")


def describe(graph: Graph, file: Path | None) -> str:
    vertices, e = graph.vertices, sum(len(edges.ends) for edges in graph.edges.values())
    poses = vertices[graph.group]
    n, k = len(poses.ids), DIM[graph.group]
    points = "".join(f", {len(v.ids)} points" for name, v in vertices.items() if name != graph.group)
    size = f"{graph.group}, {n} poses{points}, {e} edges"
    if file is None:
        # k residuals of unit variance an edge, less the k that each free pose fits.
        return f"no FILE, so a made sphere: {size}; its noise makes about {k * (e - n + 1) / 2:.0f} of error"
    held = [v for own in vertices.values() for v in own.ids[own.held]]
    more = f" and {len(held) - 5} more" if len(held) > 5 else ""
    return f"{file.name}: {size}\nheld: {', '.join(map(str, held[:5])) or 'none, there are priors'}{more}"


def run(graph: Graph, tol: float, max_iterations: int) -> tuple[Iterate, Iterate]:
    """Solve, with a line printed for each iteration; returns the first and the last."""
    begin = time.perf_counter()
    click.echo("iteration           error   decrease       step    damping")
    history: list[Iterate] = []
    for now in levenberg_marquardt(graph, tol, max_iterations):
        history.append(now)
        columns = f"{now.error:15.8g} {now.decrease:10.2e} {now.step:10.2e} {now.damping:10.0e}"
        click.echo(f"{now.number:9d} {columns}")
    click.echo(f"{history[-1].number} iterations in {time.perf_counter() - begin:.2f} s")
    if history[-1].loose is not None:
        click.echo(
            f"note: the edges leave vertex {history[-1].loose} free in some direction: "
            "other values fit as well",
            err=True,
        )
    return history[0], history[-1]


if __name__ == "__main__":
    main()
