"""g2o files of the pose-graph example: landmarks, priors, odd information, wrong lines, the command line."""

import re
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import block_diag
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import liegen

sys.path.insert(0, str(Path(__file__).parents[2] / "docs" / "examples"))

import equations
import g2o
import g2o_lines
import pose_graph


def solved(text):
    """(error, {id: numbers in the file's order}) of the command line's output."""
    Path("in.g2o").write_text(text)
    done = CliRunner().invoke(pose_graph.main, ["in.g2o", "--output", "out.g2o", "--no-picture"])
    assert done.exit_code == 0, done.output
    error = float(re.findall(r"^ +\d+ +(\S+)", done.stdout, re.MULTILINE)[-1])
    lines = [line.split() for line in Path("out.g2o").read_text().splitlines() if "VERTEX" in line]
    return error, {int(words[1]): np.array([float(w) for w in words[2:]]) for words in lines}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


# --- the values worked out by others ----------------------------------------------------------------------

CHAIN = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
STEP = "EDGE_SE2 0 1 1 0 0.1 100 0 0 100 0 1000\n"


def test_fixed_poses_do_not_move():
    strong = "1000000 0 0 1000000 0 1000000"
    error, found = solved(
        f"{CHAIN}VERTEX_SE2 2 2.1 0 0\nFIX 0\nFIX 2\n"
        f"EDGE_SE2 0 1 1 0 0 {strong}\nEDGE_SE2 1 2 1 0 0 {strong}\n"
    )
    assert error == pytest.approx(2500, rel=1e-9)
    assert found[0].tolist() == [0, 0, 0]
    assert found[2].tolist() == [2.1, 0, 0]
    np.testing.assert_allclose(found[1], [1.05, 0, 0], atol=1e-12)


def test_landmarks_of_the_plane():
    error, found = solved(
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.1 0 0.1\nVERTEX_XY 2 1 1\n"
        + STEP
        + "EDGE_SE2_XY 0 2 1 1.2 400 0 400\nEDGE_SE2_XY 1 2 0.1 1.1 400 0 400\n"
    )
    assert error == pytest.approx(0.30731988, rel=1e-7)
    np.testing.assert_allclose(found[1], [1.006319218, 0.063669713, 0.099241720], atol=1e-8)
    np.testing.assert_allclose(found[2], [0.998420195, 1.184082571], atol=1e-8)


def test_information_of_a_part():
    error, found = solved(
        f"{CHAIN}VERTEX_SE2 2 2 0.1 0\n{STEP}{STEP.replace('0 1', '1 2', 1)}"
        "EDGE_SE2 0 2 2.05 0.3 0 400 0 0 400 0 0\n"
    )
    assert error == pytest.approx(0.92258309, rel=1e-7)
    np.testing.assert_allclose(found[1], [1.024831868, 0.085365750, 0.108214534], atol=2e-8)
    np.testing.assert_allclose(found[2], [2.043814393, 0.278735431, 0.208211116], atol=2e-8)


def test_units_far_apart():
    error, found = solved(
        "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1.1 0 0.2 0 0 0 1\n"
        "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 400 0 0 0 0 400 400 0 0 0 -400 1e-09 -1e-09 1e-09 0 "
        "100000000 -1e-09 0 100000000 0 100000800\n"
    )
    assert error < 1e-20
    np.testing.assert_allclose(found[1], [1, 0, 0, 0, 0, 0, 1], atol=1e-9)


# --- all edges that there are, against matrices and another solver ----------------------------------------


def pose(numbers):
    """4x4, of x y theta, or of x y z qx qy qz qw."""
    T = np.eye(4)
    if len(numbers) == 3:
        T[:2, 3], turn = numbers[:2], Rotation.from_rotvec([0, 0, numbers[2]])
    else:
        T[:3, 3], turn = numbers[:3], Rotation.from_quat(numbers[3:])
    T[:3, :3] = turn.as_matrix()
    return T


def log(T):
    """(translation part, rotation vector), by a series in the rotation for V^-1."""
    phi = Rotation.from_matrix(T[:3, :3]).as_rotvec()
    W = np.cross(np.eye(3), phi)
    V, term = np.eye(3), np.eye(3)
    for k in range(2, 40):
        term = term @ W / k
        V = V + term
    return np.concatenate([np.linalg.solve(V, T[:3, 3]), phi])


def kept(numbers, dims):
    return numbers[[0, 1, 5]] if dims == 2 else numbers


def between(x, y):
    return np.linalg.solve(x, y)


def expected_residual(tag, ends, z, offset, dims):
    """As the format means it, of 4x4 poses and of points of three numbers; z as in the file."""
    if tag in ("EDGE_SE2", "EDGE_SE3:QUAT"):
        return kept(log(between(pose(z), between(*ends))), dims)
    if tag in ("EDGE_PRIOR_SE2", "EDGE_SE3_PRIOR"):
        return kept(log(between(pose(z), ends[0] @ offset)), dims)
    if tag in ("EDGE_SE2_XY", "EDGE_SE3_TRACKXYZ"):
        return between(ends[0] @ offset, np.append(ends[1], 1))[:dims] - z
    if tag == "EDGE_BEARING_SE2_XY":
        seen = between(ends[0], np.append(ends[1], 1))
        return np.array([np.angle(complex(*seen[:2]) * np.exp(-1j * z[0]))])
    if tag in ("EDGE_PRIOR_SE2_XY", "EDGE_SE3_XYZ_PRIOR"):
        return ends[0][:dims, 3] - z
    if tag in ("EDGE_POINTXY", "EDGE_POINTXYZ"):
        return (ends[1] - ends[0])[:dims] - z
    return ends[0][:dims] - z


TAGS = {
    2: [
        "EDGE_SE2", "EDGE_SE2_XY", "EDGE_BEARING_SE2_XY", "EDGE_POINTXY",
        "EDGE_PRIOR_SE2", "EDGE_PRIOR_SE2_XY", "EDGE_PRIOR_XY",
    ],
    3: [
        "EDGE_SE3:QUAT", "EDGE_SE3_TRACKXYZ", "EDGE_POINTXYZ",
        "EDGE_SE3_PRIOR", "EDGE_SE3_XYZ_PRIOR", "EDGE_POINTXYZ_PRIOR",
    ],
}  # fmt: skip
SIZE = {"VERTEX_SE2": 3, "VERTEX_SE3:QUAT": 7, "VERTEX_XY": 2, "VERTEX_TRACKXYZ": 3}


def numbers(rng, size, spread=1.0):
    values = spread * rng.normal(size=size)
    if size == 7:
        values[3:] = Rotation.from_rotvec(values[3:6]).as_quat()
    return values


def stepped(start, d):
    """The file's numbers of a vertex after any step that reaches all of its neighbours."""
    if len(start) == 7:
        turned = Rotation.from_quat(start[3:]) * Rotation.from_rotvec(d[3:])
        return np.append(start[:3] + d[:3], turned.as_quat())
    return start + d


def test_no_tag_is_left_out_of_the_comparison():
    assert sorted(TAGS[2] + TAGS[3]) == sorted(g2o_lines.EDGES)


@pytest.mark.parametrize("dims", [2, 3])
def test_every_edge_against_matrices_and_another_solver(dims, monkeypatch):
    monkeypatch.setattr(equations.liegen, "compile", partial(liegen.compile, backend="numpy"))
    rng = np.random.default_rng(dims)
    vertex = ["VERTEX_SE2", "VERTEX_XY"] if dims == 2 else ["VERTEX_SE3:QUAT", "VERTEX_TRACKXYZ"]
    start = {k: numbers(rng, SIZE[vertex[k > 2]], 0.3) for k in range(5)}  # poses 0 to 2, points 3 and 4
    for point in (3, 4):
        start[point] += 6  # far away, where a bearing does not jump
    ids = {"pose": [(0, 1), (1, 2)], "point": [(0, 3), (1, 4), (2, 3)], "points": [(3, 4)]}
    offset = numbers(rng, 7) if dims == 3 else np.array([0, 0, 0, 0, 0, 0, 1.0])

    def as_end(k, values):
        return pose(values) if k <= 2 else np.append(values, [0.0] * (3 - dims))

    edges = []
    for tag in TAGS[dims]:
        kind = g2o_lines.EDGES[tag]
        of_pose = kind.ends[0] == vertex[0]
        if len(kind.ends) == 1:
            pairs = [(1,)] if of_pose else [(3,)]
        else:
            pairs = ids["points"] if not of_pose else ids["pose" if kind.ends[1] == vertex[0] else "point"]
        for pair in pairs:
            z = numbers(rng, kind.measured.width, 0.3)
            if tag in ("EDGE_SE2_XY", "EDGE_SE3_TRACKXYZ", "EDGE_PRIOR_XY", "EDGE_POINTXYZ_PRIOR"):
                z += 6
            if tag == "EDGE_BEARING_SE2_XY":
                z += np.pi / 4
            m = len(kind.measured.tangent)
            root = rng.normal(size=(m, m)) + 2 * np.eye(m)
            edges.append((tag, pair, z, root.T @ root))
    lines = [f"PARAMS_SE3OFFSET 9 {words(offset)}"] if dims == 3 else []
    lines += [f"{vertex[k > 2]} {k} {words(v)}" for k, v in start.items()]
    for tag, pair, z, information in edges:
        sensor = "9 " if g2o_lines.EDGES[tag].offset else ""
        upper = words(information[np.triu_indices(len(information))])
        lines.append(f"{tag} {words(pair)} {sensor}{words(z)} {upper}")

    def residual(values):
        parts = []
        for tag, pair, z, information in edges:
            ends = [as_end(k, values[k]) for k in pair]
            parts.append(
                np.linalg.cholesky(information).T @ expected_residual(tag, ends, z, pose(offset), dims)
            )
        return np.concatenate(parts)

    error, found = solved("\n".join(lines))
    assert 0.5 * np.sum(residual(found) ** 2) == pytest.approx(error, rel=1e-6)

    sizes = [6 if len(v) == 7 else len(v) for v in start.values()]

    def moved(d):
        return residual(
            {k: stepped(found[k], p) for k, p in zip(found, np.split(d, np.cumsum(sizes)[:-1]), strict=True)}
        )

    best = least_squares(moved, np.zeros(sum(sizes)), xtol=1e-14, ftol=1e-14, gtol=1e-12)
    assert error == pytest.approx(best.cost, rel=1e-7)
    assert error < 0.5 * np.sum(residual(start) ** 2) / 2, "the start is the optimum: nothing was tested"


def words(values):
    return " ".join(repr(v) if isinstance(v, int) else f"{float(v):.17g}" for v in values)


# --- information matrices ---------------------------------------------------------------------------------


def test_roots_of_singular_and_of_badly_scaled_matrices():
    rng = np.random.default_rng(3)
    for _ in range(200):
        k, rank = 6, rng.integers(1, 7)
        factor = rng.normal(size=(rank, k)) * 10.0 ** rng.uniform(-6, 6, size=k)
        information = factor.T @ factor
        root = g2o.roots(information[None])[0]
        s = np.sqrt(np.diag(information))
        np.testing.assert_allclose(root.T @ root / np.outer(s, s), information / np.outer(s, s), atol=1e-13)
        assert np.all(np.tril(root, -1) == 0)
        assert g2o.semidefinite(information[None])[0]


def test_good_matrices_of_any_units_are_taken():
    """Weights from 1e-9 to 1e8, moved by a lever arm: definite, whatever rounding makes of eigenvalues."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        weights = 10.0 ** rng.uniform(-9, 8, size=6)
        arm = block_diag(np.eye(3), np.eye(3))
        arm[:3, 3:] = np.cross(np.eye(3), rng.normal(size=3))
        information = arm.T @ np.diag(weights) @ arm
        assert g2o.semidefinite(information[None])[0]


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_indefinite_matrices_are_refused_at_any_scale(scale):
    for matrix in ([[1, 2], [2, 1]], [[1, 0], [0, -1e-3]], [[0, 1e-9], [1e-9, 1]], [[-1, 0], [0, -1]]):
        assert not g2o.semidefinite(scale * np.array([matrix], dtype=float))[0]


# --- wrong files ------------------------------------------------------------------------------------------

POSES = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
EDGE = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
QUAT = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0"
SPACE = f"{QUAT} 1\nVERTEX_TRACKXYZ 1 1 0 0\n"
WRONG = {
    "a number missing": (
        POSES + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n",
        r"bad.g2o:3: EDGE_SE2 needs 11 numbers \(i j x y theta I11 I12 I13 I22 I23 I33\) but has 10",
    ),
    "a short vertex": (
        "\n# note\nVERTEX_SE2 0 0 0\n",
        r"bad.g2o:3: VERTEX_SE2 needs 4 numbers \(id x y theta\) but has 3",
    ),
    "text": (POSES + EDGE.replace(" 1 0 0 1 ", " 1 0 zero 1 ", 1), "bad.g2o:3: EDGE_SE2 needs .*'zero'"),
    "id": ("VERTEX_SE2 0.5 0 0 0\n", "bad.g2o:1: VERTEX_SE2 needs numbers .*ids whole.*'0.5'"),
    "underscore": (POSES + "VERTEX_SE2 2 1_0 0 0\n" + EDGE, "bad.g2o:3: VERTEX_SE2 needs numbers .*'1_0'"),
    "underscore in an id": (POSES + "VERTEX_SE2 1_0 1 0 0\n", "bad.g2o:3: VERTEX_SE2 needs numbers .*'1_0'"),
    "digits of another script": ("VERTEX_SE2 0 \u0661 0 0\n", "bad.g2o:1: VERTEX_SE2 needs numbers"),
    "an id too long": (f"VERTEX_SE2 {10**30} 0 0 0\n", "bad.g2o:1: .*at most 18 digits"),
    "NaN": ("VERTEX_SE2 0 0 nan 0\n", "bad.g2o:1: VERTEX_SE2 has a number that is not finite"),
    "too large": ("VERTEX_SE2 0 0 1e999 0\n", "bad.g2o:1: VERTEX_SE2 has a number that is not finite"),
    "quaternion": (f"{QUAT} 0.5\n", "bad.g2o:1: the quaternion of VERTEX_SE3:QUAT has length 0.5, not 1"),
    "quaternion of an edge": (
        SPACE + "EDGE_SE3_PRIOR 0 0 0 0 0 0 0 0 2" + " 1" * 21,
        "bad.g2o:3: the quaternion of EDGE_SE3_PRIOR has length 2, not 1",
    ),
    "no vertex": (
        POSES + "EDGE_SE2 0 7 1 0 0 1 0 0 1 0 1\n",
        "bad.g2o:3: EDGE_SE2 names vertex 7, which",
    ),
    "FIX of none": (POSES + EDGE + "FIX 5\n", "bad.g2o:4: FIX names vertex 5"),
    "empty FIX": (POSES + EDGE + "FIX\n", "bad.g2o:4: FIX needs 1 numbers"),
    "itself": (POSES + "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n", "bad.g2o:3: EDGE_SE2 joins vertex 1 to itself"),
    "twice": (POSES + "VERTEX_SE2 1 2 0 0\n" + EDGE, "bad.g2o:3: vertex 1 is there twice"),
    "a point with a pose's id": (POSES + "VERTEX_XY 1 2 0\n" + EDGE, "bad.g2o:3: vertex 1 is there twice"),
    "another kind of vertex": (
        POSES + "EDGE_SE2_XY 0 1 1 0 1 0 1\n",
        "bad.g2o:3: EDGE_SE2_XY names vertex 1, a VERTEX_SE2, where it needs a VERTEX_XY",
    ),
    "indefinite": (
        POSES + EDGE + EDGE.replace("1 0 0 1 0 1\n", "1 2 0 1 0 1\n"),
        "bad.g2o:4: the information matrix is not positive semidefinite",
    ),
    "2D and 3D": (f"{QUAT} 1\n" + EDGE, r"bad.g2o:2: mixes 2D and 3D"),
    "a point of space in the plane": (
        POSES + "VERTEX_TRACKXYZ 9 1 2 3\n" + EDGE,
        r"bad.g2o:3: mixes 2D and 3D: VERTEX_TRACKXYZ",
    ),
    "no edges": (POSES, "bad.g2o: has 2 poses and 0 edges"),
    "no poses": ("VERTEX_XY 0 1 2\n", "bad.g2o: has 0 poses and 0 edges"),
    "empty": ("", "bad.g2o: has 0 poses and 0 edges"),
    "loose pose": (
        POSES + "VERTEX_SE2 8 0 0 0\n" + EDGE,
        "bad.g2o:3: 1 vertices, the first with id 8, .*FIX 0 8",
    ),
    "loose point": (POSES + EDGE + "VERTEX_XY 8 0 0\n", "bad.g2o:4: 1 vertices, the first with id 8"),
    "all fixed": (
        POSES + EDGE + "FIX 0\nFIX 1\n",
        "bad.g2o:5: every vertex is fixed, so there is nothing to",
    ),
    "unknown tag": (POSES + EDGE + "EDGE_SE2_LOTSOFXY 0 1\n", "bad.g2o:4: no factor for 'EDGE_SE2_LOTSOFXY'"),
    "unknown offset": (
        SPACE + "EDGE_SE3_TRACKXYZ 0 1 3 1 0 0 1 0 0 1 0 1\n",
        "bad.g2o:3: EDGE_SE3_TRACKXYZ names offset 3, which has no line.*`PARAMS_SE3OFFSET 3 0 0 0 0 0 0 1`",
    ),
    "offset twice": (
        SPACE + "PARAMS_SE3OFFSET 3 0 0 0 0 0 0 1\n" * 2 + "EDGE_SE3_TRACKXYZ 0 1 3 1 0 0 1 0 0 1 0 1\n",
        "bad.g2o:4: PARAMS_SE3OFFSET 3 is there twice",
    ),
    "another encoding": ("\0V\0E\0R\0T\0E\0X", r"bad.g2o:1: no factor for '\\x00V"),
    "nothing measures the angle": (
        POSES + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 0\n",
        "no edge measures all of vertex 1.*`FIX 1`",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_refused_with_line_and_cure(folder, name):
    text, message = WRONG[name]
    (folder / "bad.g2o").write_text(text, encoding="utf-8")
    done = CliRunner().invoke(pose_graph.main, ["bad.g2o", "--no-picture", "--output", "out.g2o"])
    assert done.exit_code == 1
    assert re.match(f"Error: {message}", done.stderr), done.stderr
    assert "Traceback" not in done.output
    assert not (folder / "out.g2o").exists()


def test_all_wrong_lines_are_told(folder):
    (folder / "bad.g2o").write_text(POSES + "NOSUCH 1\n" + EDGE + "VERTEX_SE2 1\n" + "NOSUCH\n" * 5)
    with pytest.raises(g2o_lines.G2oError) as error:
        g2o.read_g2o(folder / "bad.g2o")
    told = str(error.value).splitlines()
    assert [line.split(":")[1] for line in told[:5]] == ["3", "5", "6", "7", "8"]
    assert told[5] == "and 2 more wrong lines"


# --- what is taken ----------------------------------------------------------------------------------------


def test_few_digits_of_a_quaternion_are_made_unit():
    graph = g2o.read_lines(
        "few",
        [
            f"{QUAT} 1",
            "VERTEX_SE3:QUAT 1 1 0 0 0.707 0 0 0.707",
            "EDGE_SE3:QUAT 0 1 1 0 0 0.707 0 0 0.707 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1",
        ],
    )
    half = np.sqrt(0.5)
    np.testing.assert_allclose(graph.vertices["SE3"].values[1], [half, 0, 0, half, 1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(
        graph.edges["EDGE_SE3:QUAT"].measurements[0], [half, 0, 0, half, 1, 0, 0], atol=1e-15
    )


def test_a_comment_in_another_encoding_stays(folder):
    (folder / "in.g2o").write_bytes(b"# caf\xe9\n" + (POSES + EDGE).encode())
    done = CliRunner().invoke(pose_graph.main, ["in.g2o", "--no-picture", "--output", "out.g2o"])
    assert done.exit_code == 0, done.output
    assert (folder / "out.g2o").read_bytes().startswith(b"# caf\xe9\nVERTEX_SE2 0 ")


def test_a_byte_order_mark_and_lines_of_other_systems(folder):
    (folder / "mark.g2o").write_bytes(b"\xef\xbb\xbf" + (POSES + EDGE).replace("\n", "\r\n").encode())
    assert g2o.read_g2o(folder / "mark.g2o").vertices["SE2"].ids.tolist() == [0, 1]


def test_what_the_edges_leave_free_is_noted(folder):
    (folder / "in.g2o").write_text(POSES + EDGE + "VERTEX_XY 5 1 2\nEDGE_BEARING_SE2_XY 0 5 1.0 100\n")
    done = CliRunner().invoke(pose_graph.main, ["in.g2o", "--no-picture"])
    assert done.exit_code == 0
    assert "the edges leave vertex 5 free" in done.stderr
    (folder / "in.g2o").write_text(POSES + EDGE)
    assert CliRunner().invoke(pose_graph.main, ["in.g2o", "--no-picture"]).stderr == ""


def test_all_other_lines_stay_in_the_solved_file(folder):
    text = (
        "# made by hand\n"
        + POSES
        + "VERTEX_XY 5 1 2  # a tree\n"
        + EDGE
        + "EDGE_SE2_XY 0 5 1 1 1 0 1\nFIX 0\n"
    )
    solved(text)
    out = (folder / "out.g2o").read_text().splitlines()
    assert out[0] == "# made by hand"
    assert out[4:] == text.splitlines()[4:]
    assert out[3].startswith("VERTEX_XY 5 1.0")
    error, again = solved((folder / "out.g2o").read_text())
    assert error < 1e-12
    assert again[5].tolist() == [1, 1]


# --- the command line -------------------------------------------------------------------------------------


def test_a_picture_and_too_few_iterations(folder):
    (folder / "in.g2o").write_text(
        POSES + "VERTEX_XY 5 1 2\n" + EDGE + "EDGE_SE2_XY 0 5 1 1 1 0 1\nEDGE_SE2_XY 1 5 1 2 1 0 1\n"
    )
    done = CliRunner().invoke(pose_graph.main, ["in.g2o", "--out", "picture.png"])
    assert done.exit_code == 0, done.output
    assert "SE2, 2 poses, 1 points, 3 edges" in done.output
    assert "held: 0" in done.output
    assert (folder / "picture.png").read_bytes().startswith(b"\x89PNG")

    done = CliRunner().invoke(pose_graph.main, ["in.g2o", "--no-picture", "--max-iterations", "1"])
    assert done.exit_code == 1
    assert "not converged in 1 iterations" in done.output


def test_without_a_file_it_says_what_it_solves():
    done = CliRunner().invoke(pose_graph.main, ["--no-picture", "--output", "sphere.g2o"])
    assert done.exit_code == 0, done.output
    assert "no FILE, so a made sphere: SE3, 500 poses, 974 edges" in done.output
    assert len(g2o.read_g2o(Path("sphere.g2o")).edges["EDGE_SE3:QUAT"].ends) == 974


@pytest.mark.parametrize(
    ("options", "code", "says"),
    [
        (["--out", "picture.xyz"], 1, "end the name of the picture with one of"),
        (["--out", "nodir/picture.png"], 1, "give a file in a folder that exists"),
        (["--output", "nodir/out.g2o"], 1, "there is no folder nodir"),
        (["--output", "."], 2, "is a directory"),
        (["--tol", "nan"], 2, "nan is not in the range"),
        (["--tol", "-1"], 2, "-1.0 is not in the range"),
        (["--max-iterations", "-1"], 2, "-1 is not in the range"),
    ],
)
def test_wrong_options_are_refused_before_the_solve(options, code, says):
    done = CliRunner().invoke(pose_graph.main, options)
    assert done.exit_code == code
    assert says in done.stderr
    assert done.stdout == ""


def test_an_output_that_cannot_be_written_is_refused_before_the_solve(monkeypatch):
    monkeypatch.setattr(pose_graph.os, "access", lambda path, mode: False)
    done = CliRunner().invoke(pose_graph.main, ["--no-picture", "--output", "out.g2o"])
    assert done.exit_code == 1
    assert "--output out.g2o: it cannot be written" in done.stderr
    assert done.stdout == ""


def test_without_matplotlib_nothing_is_solved(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    done = CliRunner().invoke(pose_graph.main, [])
    assert done.exit_code == 1
    assert "pip install liegen[examples]" in done.stderr
    assert done.stdout == ""
