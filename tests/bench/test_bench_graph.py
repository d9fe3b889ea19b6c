"""A pose graph from Python: both sides linearise the same."""

import numpy as np
import pytest

from compiler_tools import needs_compiler
from liegen import SE3
from liegen.bench.pose_graph import AGREEMENT, Edges, compare_graph, measured, read, solved
from liegen.bench.python_batches import compare_batches

pytestmark = needs_compiler


def square(noise: float) -> tuple[np.ndarray, Edges]:
    """True poses, and a graph of five edges that starts near them."""
    pytest.importorskip("scipy")
    generator = np.random.default_rng(1)
    true = [SE3.exp(generator.normal(size=6)) for _ in range(4)]
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)]
    start = [true[0], *(x.retract(generator.normal(size=6) * noise) for x in true[1:])]

    def stored(x):
        return [float(c) for c in x.coords]

    z = np.array([stored(true[i].between(true[j])) for i, j in pairs])
    i, j = (np.array(side, dtype=np.int32) for side in zip(*pairs, strict=True))
    roots = np.array([np.triu(generator.normal(size=(6, 6))) + 4 * np.eye(6) for _ in pairs])
    return np.array([stored(x) for x in true]), Edges(np.array([stored(x) for x in start]), i, j, z, roots)


@pytest.mark.parametrize("backend", ["cholmod", "superlu"])
def test_gauss_newton_finds_the_poses(backend):
    _, edges = square(0.05)
    if backend == "cholmod":
        pytest.importorskip("cvxopt.cholmod")
    found = solved(edges, backend)
    assert found.error < 1e-12
    assert 1 < found.iterations < 10


def write_g2o(path, edges: Edges) -> None:
    def numbers(values):
        return " ".join(repr(float(v)) for v in values)

    def pose(x):
        return numbers([*x[4:], *x[:4]])

    lines = [f"VERTEX_SE3:QUAT {k} {pose(x)}" for k, x in enumerate(edges.poses)]
    for i, j, z, root in zip(edges.i, edges.j, edges.z, edges.sqrt_info, strict=True):
        information = (root.T @ root)[[*range(3, 6), *range(3)]][:, [*range(3, 6), *range(3)]]
        lines.append(f"EDGE_SE3:QUAT {i} {j} {pose(z)} {numbers(information[np.triu_indices(6)])}")
    path.write_text("\n".join(lines) + "\n")


def test_gtsam_linearises_the_same(tmp_path):
    pytest.importorskip("gtsam")
    _, edges = square(0.3)
    write_g2o(tmp_path / "square.g2o", edges)
    _, _, found = read(tmp_path / "square.g2o")
    np.testing.assert_allclose(found.sqrt_info, edges.sqrt_info, atol=1e-12)
    report = compare_graph(tmp_path / "square.g2o", rounds=2)
    assert report.difference <= AGREEMENT
    assert report.agrees
    assert len(report.solves) >= 2
    assert all(s.error < 1e-9 for s in report.solves)


def test_calls_are_timed_with_cold_and_with_warm_caches():
    calls = []
    (a, b) = measured([lambda: calls.append("a"), lambda: calls.append("b")], 1, 2)
    assert calls == ["a", "a", "b", "b"] * 3  # the first round is dropped
    assert [len(times) for times in (*a, *b)] == [2] * 4


def test_jaxlie_computes_the_same():
    rows, missing = compare_batches(rounds=1, seed=0, sizes=(20,))
    assert rows[0].what == "liegen: compile"
    if missing:
        assert "jaxlie is not installed" in missing[0].reason
        pytest.skip(missing[0].reason)
    assert rows[1].difference < 1e-10
