"""The pose-graph example: reader, solver and optima, against references that share no code with it."""

import os
import sys
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

import liegen

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "examples"))

import equations  # noqa: E402
import g2o  # noqa: E402
import pose_graph  # noqa: E402

DATA = Path(os.environ.get("LIEGEN_DATA", ROOT.parent / "shared" / "data"))


def solve(graph):
    history = list(pose_graph.levenberg_marquardt(graph))
    assert history[-1].converged
    return history


# --- retraction -------------------------------------------------------------------------------------------


def hat(d):
    """Of (rotation vector, translation) in 3D, of (x, y, angle) in 2D."""
    if len(d) == 3:
        x, y, angle = d
        return np.array([[0, -angle, x], [angle, 0, y], [0, 0, 0]])
    a, b, c, x, y, z = d
    return np.array([[0, -c, b, x], [c, 0, -a, y], [-b, a, 0, z], [0, 0, 0, 0]])


def matrix(pose):
    if len(pose) == 4:
        c, s, x, y = pose
        return np.array([[c, -s, x], [s, c, y], [0, 0, 1]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_quat(pose[:4]).as_matrix(), pose[4:]
    return T


@pytest.mark.parametrize("size", [0.0, 1e-200, 1e-160, 1e-9, 1e-4, 0.3, 1.0, 3.1, 7.0])
@pytest.mark.parametrize("group", ["SE2", "SE3"])
def test_retract_is_the_matrix_exponential_on_the_right(group, size):
    rng = np.random.default_rng(5)
    k, start = {"SE2": (3, [1.0, 0, 0, 0]), "SE3": (6, [0, 0, 0, 1.0, 0, 0, 0])}[group]
    retract = equations.RETRACT[group]
    x = retract(np.tile(start, (20, 1)), rng.normal(size=(20, k)))
    d = rng.normal(size=(20, k))
    rotation = slice(0, 3) if group == "SE3" else slice(2, 3)
    d[:, rotation] *= size / np.linalg.norm(d[:, rotation], axis=1, keepdims=True)
    for before, step, after in zip(x, d, retract(x, d), strict=True):
        np.testing.assert_allclose(matrix(after), matrix(before) @ expm(hat(step)), rtol=0, atol=2e-14)


# --- the optimum, from the file's own numbers and another solver ------------------------------------------


@dataclass(frozen=True)
class Problem:
    """A graph as matrices in 3D, with the text of its file; 2D is 3D in the plane z = 0."""

    text: str
    kept: list[int]  # entries of (x, y, z, rotation vector) that the group has
    start: np.ndarray  # (N, 6) translation, rotation vector
    edges: list[tuple[int, int, np.ndarray, np.ndarray]]  # i, j, measured matrix, information in file order
    held: int


def as_matrix(t_phi):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_rotvec(t_phi[3:]).as_matrix(), t_phi[:3]
    return T


def log(T):
    """(translation, rotation vector) from scipy's rotation and a numerical solve for the translation."""
    phi = Rotation.from_matrix(T[:3, :3]).as_rotvec()
    W, theta = hat([*phi, 0, 0, 0])[:3, :3], np.linalg.norm(phi)
    if theta < 1e-4:
        V = np.eye(3) + W / 2 + W @ W / 6
    else:
        V = np.eye(3) + (1 - np.cos(theta)) / theta**2 * W + (theta - np.sin(theta)) / theta**3 * W @ W
    return np.concatenate([np.linalg.solve(V, T[:3, 3]), phi])


def make_problem(group, held):
    """Six poses in a ring with chords, correlated information, ids 10, 17, 24, ... written out of order."""
    rng = np.random.default_rng(11)
    kept = {"SE2": [0, 1, 5], "SE3": [0, 1, 2, 3, 4, 5]}[group]
    n, k = 6, len(kept)
    true, start = np.zeros((2, n, 6))
    true[:, kept] = 1.2 * rng.normal(size=(n, k))
    start[:, kept] = true[:, kept] + 0.2 * rng.normal(size=(n, k))
    pairs = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (4, 1), (0, 3)]
    edges, lines = [], []
    for i, j in pairs:
        noise = np.zeros(6)
        noise[kept] = 0.15 * rng.normal(size=k)
        z = np.linalg.solve(as_matrix(true[i]), as_matrix(true[j])) @ as_matrix(noise)
        factor = rng.normal(size=(k, k))
        information = 20 * (factor @ factor.T + 0.5 * np.eye(k))
        edges.append((i, j, z, information))
        upper = information[np.triu_indices(k)]
        lines.append(f"{tag('EDGE', group)} {10 + 7 * i} {10 + 7 * j} {numbers(z, group)} {floats(upper)}")
    for i in (0, 3, 1, 5, 4, 2):
        T = as_matrix(start[i])
        lines.append(f"{tag('VERTEX', group)} {10 + 7 * i} {numbers(T, group)}  # pose {i}")
    if held:
        lines.append(f"FIX {10 + 7 * held}")
    return Problem("\n".join(["# a comment", "", *lines]) + "\n", kept, start, edges, held)


def tag(kind, group):
    return f"{kind}_{group}" + (":QUAT" if group == "SE3" else "")


def floats(values):
    return " ".join(f"{v:.17g}" for v in values)


def numbers(T, group):
    rotation = Rotation.from_matrix(T[:3, :3])
    angle = [np.arctan2(T[1, 0], T[0, 0])]
    return floats([*T[:2, 3], *angle] if group == "SE2" else [*T[:3, 3], *rotation.as_quat()])


def residual(problem, poses):
    """Whitened, all edges, of 4x4 poses; the held one is where it starts."""
    poses = [as_matrix(problem.start[problem.held]) if k == problem.held else T for k, T in enumerate(poses)]
    parts = []
    for i, j, z, information in problem.edges:
        r = log(np.linalg.solve(z, np.linalg.solve(poses[i], poses[j])))[problem.kept]
        parts.append(np.linalg.cholesky(information).T @ r)
    return np.concatenate(parts)


@pytest.mark.parametrize(("group", "held"), [("SE2", 0), ("SE3", 0), ("SE3", 4)])
def test_optimum_agrees_with_an_independent_solver(tmp_path, group, held):
    problem = make_problem(group, held)
    file = tmp_path / "ring.g2o"
    file.write_text(problem.text)
    graph = g2o.read_g2o(file)
    ids = graph.vertices[group].ids
    assert ids.tolist() == [10, 31, 17, 45, 38, 24]
    history = solve(graph)

    def error_of(poses):
        by_id = dict(zip(ids, poses, strict=True))
        if group == "SE2":
            by_id = {key: planar(pose) for key, pose in by_id.items()}
        r = residual(problem, [matrix(by_id[10 + 7 * i]) for i in range(6)])
        return 0.5 * r @ r

    first, last = history[0].values[group], history[-1].values[group]
    assert history[0].error == pytest.approx(error_of(first), rel=1e-11)
    assert history[-1].error == pytest.approx(error_of(last), rel=1e-11)

    def residual_of(flat):
        params = np.zeros((6, 6))
        params[:, problem.kept] = flat.reshape(6, -1)
        return residual(problem, [as_matrix(p) for p in params])

    best = least_squares(
        residual_of, problem.start[:, problem.kept].ravel(), xtol=1e-13, ftol=1e-13, gtol=1e-9
    )
    assert history[-1].error == pytest.approx(best.cost, rel=1e-8)
    assert best.cost < 0.5 * history[0].error, "the start is the optimum, so nothing was tested"

    assert np.all(last == first, axis=1).tolist() == (ids == 10 + 7 * held).tolist()


def planar(pose):
    """An SE(2) pose as an SE(3) pose."""
    c, s, x, y = pose
    return np.array([0, 0, *Rotation.from_euler("z", np.arctan2(s, c)).as_quat()[2:], x, y, 0])


# --- the made sphere --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_made_sphere_ends_at_the_error_of_its_noise(seed):
    """Twice the error is chi-squared: 6 residuals an edge, less 6 for each pose that is free."""
    graph = pose_graph.made_sphere(rings=12, per_ring=15, seed=seed)
    history = solve(graph)
    n, e = 12 * 15, (12 * 15 - 1) + 11 * 15
    assert (len(graph.vertices["SE3"].ids), len(graph.edges["EDGE_SE3:QUAT"].ends)) == (n, e)
    assert 1e-4 < chi2(6 * (e - (n - 1))).cdf(2 * history[-1].error) < 1 - 1e-4
    assert history[-1].error < 0.1 * history[0].error

    off = [
        np.linalg.norm(h.values["SE3"][:, 4:], axis=1) - 10 for h in (history[0], history[-1])
    ]  # from the sphere
    assert np.std(off[1]) < 0.5 * np.std(off[0])


def test_made_sphere_is_the_same_every_time():
    assert pose_graph.made_sphere().lines == pose_graph.made_sphere().lines


def test_a_perfect_graph_stays_where_it_is():
    """No noise: the error is zero up to rounding from the start, and the solver has to notice."""
    lines = pose_graph.made_sphere(rings=3, per_ring=5).lines
    chain = [
        line  # dead reckoning, the initial poses, fits the odometry
        for line in lines
        if not line.startswith("EDGE") or int(line.split()[1]) + 1 == int(line.split()[2])
    ]
    exact = g2o.read_lines("chain", chain)
    history = solve(exact)
    assert history[0].error < 1e-24
    np.testing.assert_allclose(history[-1].values["SE3"], exact.vertices["SE3"].values, atol=1e-12)


def moved(graph, group, change):
    """The graph with other initial poses."""
    own = graph.vertices[group]
    return replace(graph, vertices={group: replace(own, values=change(own.values))})


def test_refused_steps_from_a_bad_start_lead_to_the_same_optimum():
    graph = pose_graph.made_sphere()
    noise = 0.5 * np.random.default_rng(0).normal(size=(500, 6))
    noise[0] = 0
    history = solve(moved(graph, "SE3", lambda poses: equations.RETRACT["SE3"](poses, noise)))
    assert any(h.decrease < 0 for h in history)
    assert all(b.error <= a.error for a, b in pairwise(history))
    assert history[-1].error == pytest.approx(solve(graph)[-1].error, rel=1e-9)


def test_the_equations_are_the_same_without_a_compiler(monkeypatch):
    graph = pose_graph.made_sphere(rings=3, per_ring=5)
    compiled = equations.system_of(graph)(equations.start(graph))
    monkeypatch.setattr(equations.liegen, "compile", partial(liegen.compile, backend="numpy"))
    terms = equations.system_of(graph)(equations.start(graph))
    assert terms.cost == pytest.approx(compiled.cost, rel=1e-9)
    np.testing.assert_allclose(terms.g, compiled.g, rtol=1e-9, atol=1e-7)
    np.testing.assert_allclose(terms.H.toarray(), compiled.H.toarray(), rtol=1e-9, atol=1e-7)


def test_a_measurement_that_is_not_a_number_is_an_error():
    graph = pose_graph.made_sphere(rings=3, per_ring=5)
    edges = graph.edges["EDGE_SE3:QUAT"]
    z = edges.measurements.copy()
    z[4, 5] = np.nan
    broken = replace(graph, edges={"EDGE_SE3:QUAT": replace(edges, measurements=z)})
    with pytest.raises(RuntimeError, match="the error at the start is not a number"):
        list(pose_graph.levenberg_marquardt(broken))


# --- public benchmarks ------------------------------------------------------------------------------------

OPTIMA = {  # initial and final error, GTSAM 4.3.0, with a prior of 1 mm on the first pose, which is 0 there
    "sphere2500": (1305657.71, 675.70096),
    "M3500": (1317356.27, 68.957439),
    "intel": (276.99790, 22.502117),
    "smallGrid3D": (83894.3, 517.925),
    "parking-garage": (8363.6019, 0.6341924),
}


@pytest.mark.parametrize("name", OPTIMA)
def test_reference_optimum_to_six_digits(name):
    file = DATA / f"{name}.g2o"
    if not file.exists():
        pytest.skip(f"no {file.name} in ../shared/data or $LIEGEN_DATA")
    history = solve(g2o.read_g2o(file))
    assert [f"{h.error:.6g}" for h in (history[0], history[-1])] == [f"{v:.6g}" for v in OPTIMA[name]]
