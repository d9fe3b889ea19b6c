"""The pose-graph example: reader, solver and optima, against references that share no code with it."""

import os
import sys
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import expm
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

import liegen

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "examples"))

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
    retract = pose_graph.GROUPS[group].retract
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
    """Whitened, all edges and the prior, of 4x4 poses."""
    parts = [log(np.linalg.solve(as_matrix(problem.start[problem.held]), poses[problem.held])) / 1e-3]
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
    assert graph.ids.tolist() == [10, 31, 17, 45, 38, 24]
    history = solve(graph)

    def error_of(poses):
        by_id = dict(zip(graph.ids, poses, strict=True))
        if group == "SE2":
            by_id = {key: planar(pose) for key, pose in by_id.items()}
        r = residual(problem, [matrix(by_id[10 + 7 * i]) for i in range(6)])
        return 0.5 * r @ r

    assert history[0].error == pytest.approx(error_of(graph.poses), rel=1e-11)
    assert history[-1].error == pytest.approx(error_of(history[-1].poses), rel=1e-11)

    def residual_of(flat):
        params = np.zeros((6, 6))
        params[:, problem.kept] = flat.reshape(6, -1)
        return residual(problem, [as_matrix(p) for p in params])

    best = least_squares(
        residual_of, problem.start[:, problem.kept].ravel(), xtol=1e-13, ftol=1e-13, gtol=1e-9
    )
    assert history[-1].error == pytest.approx(best.cost, rel=1e-8)
    assert best.cost < 0.5 * history[0].error, "the start is the optimum, so nothing was tested"

    moved = np.abs(history[-1].poses - graph.poses).max(axis=1)
    assert (moved < 1e-6).tolist() == (graph.ids == 10 + 7 * held).tolist()


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
    assert (len(graph.poses), len(graph.i)) == (n, e)
    assert 1e-4 < chi2(6 * (e - (n - 1))).cdf(2 * history[-1].error) < 1 - 1e-4
    assert history[-1].error < 0.1 * history[0].error

    off = [np.linalg.norm(h.poses[:, 4:], axis=1) - 10 for h in (history[0], history[-1])]  # from the sphere
    assert np.std(off[1]) < 0.5 * np.std(off[0])


def test_made_sphere_is_the_same_every_time():
    first, second = pose_graph.made_sphere(), pose_graph.made_sphere()
    np.testing.assert_array_equal(first.measurements, second.measurements)
    np.testing.assert_array_equal(first.poses, second.poses)


def test_a_perfect_graph_stays_where_it_is():
    """No noise: the error is zero up to rounding from the start, and the solver has to notice."""
    graph = pose_graph.made_sphere(rings=3, per_ring=5)
    chain = graph.i + 1 == graph.j  # dead reckoning, the initial poses, fits the odometry
    exact = replace(
        graph,
        i=graph.i[chain],
        j=graph.j[chain],
        measurements=graph.measurements[chain],
        information=graph.information[chain],
    )
    history = solve(exact)
    assert history[0].error < 1e-24
    np.testing.assert_allclose(history[-1].poses, exact.poses, atol=1e-12)


def test_refused_steps_from_a_bad_start_lead_to_the_same_optimum():
    graph = pose_graph.made_sphere()
    noise = 0.5 * np.random.default_rng(0).normal(size=(len(graph.poses), 6))
    noise[0] = 0
    history = solve(replace(graph, poses=pose_graph.retract_se3(graph.poses, noise)))
    assert any(h.decrease < 0 for h in history)
    assert all(b.error <= a.error for a, b in pairwise(history))
    assert history[-1].error == pytest.approx(solve(graph)[-1].error, rel=1e-9)


def test_linearising_is_the_same_without_a_compiler(monkeypatch):
    graph = pose_graph.made_sphere(rings=3, per_ring=5)
    compiled_jacobian, compiled_residual = pose_graph.linearise(graph)(graph.poses)
    monkeypatch.setattr(pose_graph.liegen, "compile", partial(liegen.compile, backend="numpy"))
    jacobian, residual = pose_graph.linearise(graph)(graph.poses)
    np.testing.assert_allclose(residual, compiled_residual, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(jacobian.toarray(), compiled_jacobian.toarray(), rtol=1e-9, atol=1e-9)


def test_a_measurement_that_is_not_a_number_is_an_error():
    graph = pose_graph.made_sphere(rings=3, per_ring=5)
    measurements = graph.measurements.copy()
    measurements[4, 5] = np.nan
    with pytest.raises(RuntimeError, match="the error at the start is not a number"):
        list(pose_graph.levenberg_marquardt(replace(graph, measurements=measurements)))


# --- public benchmarks ------------------------------------------------------------------------------------

OPTIMA = {  # initial and final error, GTSAM 4.3.0, the same prior
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


# --- wrong files and the command line ---------------------------------------------------------------------

POSES = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
EDGE = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
QUAT = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            POSES + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n",
            r"bad.g2o:3: EDGE_SE2 needs 11 numbers \(i j x y theta and I11",
        ),
        ("\n# note\nVERTEX_SE2 0 0 0\n", r"bad.g2o:3: VERTEX_SE2 needs 4 numbers \(id x y theta\) but has 3"),
        (POSES + EDGE.replace(" 1 0 0 1 ", " 1 0 zero 1 ", 1), "bad.g2o:3: EDGE_SE2 needs numbers .*'zero'"),
        ("VERTEX_SE2 0.5 0 0 0\n", "bad.g2o:1: VERTEX_SE2 needs numbers .*ids whole.*'0.5'"),
        ("VERTEX_SE2 0 0 nan 0\n", "bad.g2o:1: VERTEX_SE2 has a number that is not finite"),
        (f"{QUAT} 0.5\n", "bad.g2o:1: the quaternion of VERTEX_SE3:QUAT has length 0.5, not 1"),
        (POSES + "EDGE_SE2 0 7 1 0 0 1 0 0 1 0 1\n", "bad.g2o:3: EDGE_SE2 names pose 7, which has no vertex"),
        (POSES + EDGE + "FIX 5\n", "bad.g2o:4: FIX names pose 5"),
        (POSES + EDGE + "FIX\n", "bad.g2o:4: FIX needs 1 numbers"),
        (POSES + "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n", "bad.g2o:3: EDGE_SE2 joins pose 1 to itself"),
        (POSES + "VERTEX_SE2 1 2 0 0\n" + EDGE, "bad.g2o:3: pose 1 is there twice"),
        (
            POSES + EDGE + EDGE.replace("1 0 0 1 0 1\n", "1 2 0 1 0 1\n"),
            "bad.g2o:4: the information matrix is not",
        ),
        (f"{QUAT} 1\n" + EDGE, r"bad.g2o: mixes 2D and 3D"),
        (POSES, "bad.g2o: has 2 poses and 0 edges"),
        ("VERTEX_XY 0 1 2\n", "bad.g2o: has 0 poses and 0 edges.*Unknown tags: VERTEX_XY"),
        (POSES + "VERTEX_SE2 8 0 0 0\n" + EDGE, "bad.g2o: 1 poses, the first with id 8, .*FIX 0 8"),
    ],
)
def test_a_wrong_file_is_refused_with_line_and_cure(tmp_path, text, message):
    file = tmp_path / "bad.g2o"
    file.write_text(text)
    with pytest.raises(g2o.G2oError, match=message):
        g2o.read_g2o(file)
    result = CliRunner().invoke(pose_graph.main, [str(file)])
    assert result.exit_code == 1
    assert result.output.startswith("Error: bad.g2o:")


def test_few_digits_of_a_quaternion_are_made_unit(tmp_path):
    file = tmp_path / "few.g2o"
    file.write_text(
        f"{QUAT} 1\nVERTEX_SE3:QUAT 1 1 0 0 0.707 0 0 0.707\n"
        "EDGE_SE3:QUAT 0 1 1 0 0 0.707 0 0 0.707 " + "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
    )
    graph = g2o.read_g2o(file)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(graph.poses[1], [half, 0, 0, half, 1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(graph.measurements[0], [half, 0, 0, half, 1, 0, 0], atol=1e-15)


def test_command_line_on_a_file(tmp_path):
    file, out = tmp_path / "ring.g2o", tmp_path / "picture.png"
    file.write_text(make_problem("SE2", 0).text + "VERTEX_XY 99 1 2\nEDGE_SE2_XY 10 99 1 2 1 0 1\n")
    result = CliRunner().invoke(pose_graph.main, [str(file), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "SE2, 6 poses, 8 edges" in result.output
    assert "left out: 1 lines VERTEX_XY" in result.output
    assert out.read_bytes().startswith(b"\x89PNG")

    result = CliRunner().invoke(pose_graph.main, [str(file), "--out", str(out), "--max-iterations", "1"])
    assert result.exit_code == 1
    assert "not converged in 1 iterations" in result.output


def test_command_line_without_a_file_says_what_it_solves(tmp_path):
    result = CliRunner().invoke(pose_graph.main, ["--out", str(tmp_path / "sphere.png")])
    assert result.exit_code == 0, result.output
    assert "no FILE, so a made sphere: SE3, 500 poses, 974 edges" in result.output
