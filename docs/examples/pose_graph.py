"""Solve a pose graph with compiled factors: `python docs/examples/pose_graph.py [FILE.g2o]`.

A pose graph has unknown poses x_1 ... x_N in a world frame, and edges: each is a measurement z of pose j in
the frame of pose i. Its residual is the library's between factor, r = Log(z^-1 x_i^-1 x_j), whitened by the
noise of the edge: `between_se3.whitened(noise="full")` (2D: `between_se2`). The best poses minimise

    error = 1/2 sum |S r|^2,    S^T S = information matrix of the edge.

Edges alone leave the whole graph free to move, so a prior factor of 1 mm and 1 mrad holds the first pose.

What a solver of your own takes from here is short:

1. `linearise`: ONE call of the compiled factor gives the whitened residuals and Jacobians of all edges. It
   reads the poses through the edge list, and writes `res_D_x`, a k x k block in the columns of pose i, and
   `res_D_y`, one in the columns of pose j, to where the sparse matrix has them.
2. `liegen.SparseSolver` solves (J^T J + damping) d = -J^T r; what the pattern decides is done once.
3. `retract`: the Jacobians are those of x Exp(d), so that is how a step d is applied (3D: rotation first).

Without a file it makes a sphere: a robot winds up around it, with noisy odometry, and measures where it is
relative to the ring below.

Needs SciPy, and matplotlib for the picture (`pip install liegen[examples]`). CHOLMOD solves the linear
systems where it is installed (`pip install liegen[cholesky]`), else SciPy's LU, which takes longer. Where
there is no C compiler the factors run as NumPy code.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
from g2o import Floats, G2oError, Graph, read_g2o
from scipy.sparse import bsr_array

import liegen
from liegen import library

PRIOR_SIGMA = 1e-3  # metres and radians
SPHERE_SIGMA = np.array([0.03, 0.03, 0.03, 0.1, 0.1, 0.1])  # radians, metres
FIRST_DAMPING, SMALLEST_DAMPING, LARGEST_DAMPING = 1e-6, 1e-12, 1e6  # relative to the diagonal of J^T J


# --- the groups: storage and tangent order are those of the generated functions ---------------------------


def compose_se3(a: Floats, b: Floats) -> Floats:
    """Poses (..., 7) = (qx, qy, qz, qw, x, y, z); the product's quaternion is made unit again."""
    u, w, v, s = a[..., :3], a[..., 3:4], b[..., :3], b[..., 3:4]
    scalar = w * s - np.sum(u * v, axis=-1, keepdims=True)
    q = np.concatenate([w * v + s * u + np.cross(u, v), scalar], axis=-1)
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    return np.concatenate([q, a[..., 4:] + rotate(a[..., :4], b[..., 4:])], axis=-1)


def inverse_se3(a: Floats) -> Floats:
    q = a[..., :4] * [-1, -1, -1, 1]
    return np.concatenate([q, -rotate(q, a[..., 4:])], axis=-1)


def rotate(q: Floats, p: Floats) -> Floats:
    twice = 2 * np.cross(q[..., :3], p)
    return p + q[..., 3:4] * twice + np.cross(q[..., :3], twice)


def exp_se3(d: Floats) -> Floats:
    """Exp of (rotation vector, translation), full accuracy at every angle, 0 included."""
    phi, rho = d[..., :3], d[..., 3:]
    theta = np.linalg.norm(phi, axis=-1, keepdims=True)
    half = np.sinc(theta / (2 * np.pi)) / 2  # sin(theta/2) / theta
    # (theta - sin theta) / theta^3; digits lost near 0 do not matter, it multiplies a vector of size theta^2.
    c3 = (1 - np.sinc(theta / np.pi)) / np.where(theta**2 > 0, theta**2, 1)
    turn = np.cross(phi, rho)
    translation = rho + 2 * half**2 * turn + c3 * np.cross(phi, turn)
    return np.concatenate([half * phi, np.cos(theta / 2), translation], axis=-1)


def retract_se3(x: Floats, d: Floats) -> Floats:
    return compose_se3(x, exp_se3(d))


def retract_se2(x: Floats, d: Floats) -> Floats:
    """Poses (..., 4) = (cos, sin, x, y), d = (x, y, angle); complex numbers are rotations and points."""
    rotation, position = x[..., 0] + 1j * x[..., 1], x[..., 2] + 1j * x[..., 3]
    move, angle = d[..., 0] + 1j * d[..., 1], d[..., 2]
    chord = np.sinc(angle / (2 * np.pi)) * np.exp(0.5j * angle)  # (e^(i angle) - 1) / (i angle)
    position = position + rotation * chord * move
    rotation = rotation * np.exp(1j * angle)
    rotation /= np.abs(rotation)
    return np.stack([rotation.real, rotation.imag, position.real, position.imag], axis=-1)


@dataclass(frozen=True)
class Group:
    dim: int  # of the tangent space
    space: int  # of a position, the last numbers of a pose
    retract: Callable[[Floats, Floats], Floats]
    between: liegen.Function  # of x and y, given z
    prior: liegen.Function  # of x, given z


GROUPS = {
    "SE2": Group(3, 2, retract_se2, library.between_se2, library.prior_se2),
    "SE3": Group(6, 3, retract_se3, library.between_se3, library.prior_se3),
}


# --- the solver -------------------------------------------------------------------------------------------


def linearise(graph: Graph) -> Callable[[Floats], tuple[bsr_array, Floats]]:
    """The function poses -> (J, r) of all edges and priors, whitened. What never changes is prepared once."""
    group = GROUPS[graph.group]
    k, n_edges, n_held = group.dim, len(graph.i), len(graph.held)
    edges = liegen.compile(group.between.whitened(noise="full")).indexed(x=graph.i, y=graph.j)
    priors = liegen.compile(group.prior.whitened(noise="isotropic")).indexed(x=graph.held)
    whiten = np.linalg.cholesky(graph.information).transpose(0, 2, 1)  # L^T: information = L L^T
    held_at = graph.poses[graph.held]
    # J in k x k blocks: the row of an edge has two, in columns i and j, the row of a prior has one.
    columns = np.concatenate([np.stack([graph.i, graph.j], axis=1).ravel(), graph.held])
    row_starts = np.concatenate([np.arange(0, 2 * n_edges, 2), 2 * n_edges + np.arange(n_held + 1)])
    shape = (k * (n_edges + n_held), k * len(graph.poses))

    def at(poses: Floats) -> tuple[bsr_array, Floats]:
        blocks, r = np.empty((len(columns), k, k)), np.empty((n_edges + n_held, k))
        D = blocks[: 2 * n_edges].reshape(n_edges, 2, k, k)
        out = (r[:n_edges], D[:, 0], D[:, 1])
        edges.jacobians(poses, poses, z=graph.measurements, sqrt_info=whiten, out=out)
        out = (r[n_edges:], blocks[2 * n_edges :])
        priors.jacobians(poses, z=held_at, sqrt_info=[1 / PRIOR_SIGMA], out=out)
        return bsr_array((blocks, columns, row_starts), shape=shape), r.ravel()

    return at


@dataclass(frozen=True)
class Iterate:
    """Where the solver stands after one linear system."""

    number: int
    poses: Floats
    error: float
    decrease: float = 0.0  # of the error, relative; negative: the step was refused
    step: float = 0.0  # norm of d
    damping: float = FIRST_DAMPING  # of the next system
    converged: bool = False


def levenberg_marquardt(graph: Graph, tol: float = 1e-9, max_iterations: int = 100) -> Iterator[Iterate]:
    """Gauss-Newton, damped when a step does not decrease the error (Nocedal & Wright 2006, section 10.3).

    Converged: a step changes, or by its linear model would change, the error by a share of at most `tol`, or
    no number in the step is larger than `tol`.
    """
    group, at, solver = GROUPS[graph.group], linearise(graph), liegen.SparseSolver()
    jacobian, r = at(graph.poses)
    now = Iterate(0, graph.poses, half_square(r))
    if not np.isfinite(now.error):
        raise RuntimeError("the error at the start is not a number: check the poses and measurements")
    yield now
    while not now.converged and now.number < max_iterations:
        gradient = jacobian.T @ r
        d = solver(jacobian.T @ jacobian, -gradient, now.damping)
        poses = group.retract(now.poses, d.reshape(-1, group.dim))
        jacobian_new, r_new = at(poses)
        error = half_square(r_new)
        decrease = (now.error - error) / now.error if now.error > 0 else 0.0
        negligible = -(gradient @ d) <= tol * now.error or np.abs(d).max() <= tol
        now = replace(now, number=now.number + 1, decrease=decrease, step=float(np.linalg.norm(d)))
        if error <= now.error:
            jacobian, r = jacobian_new, r_new
            damping = max(now.damping / 10, SMALLEST_DAMPING)
            converged = bool(negligible or decrease <= tol)
            now = replace(now, poses=poses, error=error, damping=damping, converged=converged)
        else:  # also when it is not a number
            now = replace(now, damping=now.damping * 10, converged=bool(negligible))
        if now.damping > LARGEST_DAMPING:
            raise RuntimeError(f"no step decreases the error {now.error:.6g}: is a measurement far off?")
        yield now


def half_square(r: Floats) -> float:
    return 0.5 * float(r @ r)


# --- a graph to solve without a file, a picture, the command line -----------------------------------------


def made_sphere(rings: int = 20, per_ring: int = 25, seed: int = 1) -> Graph:
    """A sphere of radius 10 m; the initial poses are dead reckoning from the true first pose."""
    n = rings * per_ring
    rng = np.random.default_rng(seed)
    longitude = 2 * np.pi * np.arange(n) / per_ring
    latitude = np.radians(np.linspace(-80, 80, n))
    about_z = exp_se3(longitude[:, None] * [0, 0, 1, 0, 0, 0])
    about_y = exp_se3(latitude[:, None] * [0, -1, 0, 0, 0, 0])
    true = compose_se3(compose_se3(about_z, about_y), exp_se3(np.tile([0.0, 0, 0, 10, 0, 0], (n, 1))))

    i = np.concatenate([np.arange(n - 1), np.arange(n - per_ring)])
    j = np.concatenate([np.arange(1, n), np.arange(per_ring, n)])
    noise = rng.normal(size=(len(i), 6)) * SPHERE_SIGMA
    # Noise is in the frame of the measurement, as the residual is: z = x_i^-1 x_j Exp(noise).
    z = compose_se3(compose_se3(inverse_se3(true[i]), true[j]), exp_se3(noise))

    poses = [true[0]]
    for odometry in z[: n - 1]:
        poses.append(compose_se3(poses[-1], odometry))
    information = np.tile(np.diag(SPHERE_SIGMA**-2.0), (len(i), 1, 1))
    return Graph("SE3", np.array(poses), i, j, z, information, held=np.array([0]), ids=np.arange(n))


def draw(graph: Graph, before: Iterate, after: Iterate, out: Path) -> None:
    """Two panels; edges between neighbours (odometry) in blue, all others (loop closures) in orange."""
    from matplotlib.figure import Figure

    space = GROUPS[graph.group].space
    figure = Figure(figsize=(12, 6), layout="constrained")
    neighbours = np.abs(graph.i - graph.j) == 1
    for panel, (title, state) in enumerate([("before", before), ("after", after)], start=1):
        axes = figure.add_subplot(1, 2, panel, projection="3d" if space == 3 else None)
        ends = state.poses[:, -space:]
        gap = np.full((len(graph.i), space), np.nan)  # lifts the pen between two edges
        lines = np.stack([ends[graph.i], ends[graph.j], gap], axis=1)
        axes.plot(*lines[~neighbours].reshape(-1, space).T, color="tab:orange", linewidth=0.4)
        axes.plot(*lines[neighbours].reshape(-1, space).T, color="tab:blue", linewidth=0.7)
        axes.set_title(f"{title}: error {state.error:.8g}")
        axes.set_aspect("equal")
    figure.savefig(out, dpi=120, bbox_inches="tight")


@click.command(help="Solve the pose graph in FILE (.g2o, 2D or 3D); without FILE, a made sphere.")
@click.argument("file", required=False, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--out", default="pose_graph.png", show_default=True, help="Picture, before and after.")
@click.option("--tol", default=1e-9, show_default=True, help="Relative change of the error to stop at.")
@click.option("--max-iterations", default=100, show_default=True)
def main(file: Path | None, out: str, tol: float, max_iterations: int) -> None:
    try:
        graph = read_g2o(file) if file else made_sphere()
        click.echo(describe(graph, file))
        first, last = run(graph, tol, max_iterations)
        draw(graph, first, last, Path(out))
    except (G2oError, RuntimeError, OSError, np.linalg.LinAlgError) as error:
        raise click.ClickException(str(error)) from error
    click.echo(f"picture: {out}")
    if not last.converged:
        raise click.ClickException(f"not converged in {max_iterations} iterations: raise --max-iterations")


def describe(graph: Graph, file: Path | None) -> str:
    n, e, k = len(graph.poses), len(graph.i), GROUPS[graph.group].dim
    size = f"{graph.group}, {n} poses, {e} edges"
    if file is None:
        # k residuals of unit variance an edge, less the k that each free pose fits.
        return f"no FILE, so a made sphere: {size}; its noise makes about {k * (e - n + 1) / 2:.0f} of error"
    left_out = "".join(f"\nleft out: {count} lines {tag}" for tag, count in graph.left_out.items())
    return f"{file.name}: {size}{left_out}"


def run(graph: Graph, tol: float, max_iterations: int) -> tuple[Iterate, Iterate]:
    """Solve, with a line printed for each iteration; returns the first and the last."""
    start = time.perf_counter()
    click.echo("iteration           error   decrease       step    damping")
    history: list[Iterate] = []
    for now in levenberg_marquardt(graph, tol, max_iterations):
        history.append(now)
        numbers = f"{now.error:15.8g} {now.decrease:10.2e} {now.step:10.2e} {now.damping:10.0e}"
        click.echo(f"{now.number:9d} {numbers}")
    click.echo(f"{history[-1].number} iterations in {time.perf_counter() - start:.2f} s")
    return history[0], history[-1]


if __name__ == "__main__":
    main()
