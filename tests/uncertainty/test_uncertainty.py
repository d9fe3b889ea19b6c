"""The public functions on all groups, batches, and what they refuse."""

from pathlib import Path

import numpy as np
import pytest
import uncertainty_reference as ref
from scipy.linalg import block_diag, expm
from uncertainty_reference import close, spd

from liegen import uncertainty
from liegen.errors import LiegenError, UncertaintyError
from liegen.manifolds import R3, S2, SE2, SE3, SO2, SO3

groups = pytest.mark.parametrize("G", ref.GROUPS, ids=lambda G: G.__name__)


def rng():
    return np.random.default_rng(11)


def test_the_reference_is_what_it_says():
    """Its fast series is SciPy's expm, its logarithm inverts it, its misfit sees a wrong covariance."""
    for G in ref.GROUPS:
        d = rng().normal(size=(30, len(ref.BASIS[G]))) * 0.8
        close(ref.series(ref.hat(G, d)), expm(ref.hat(G, d)), 2e-14)
        close(ref.log(G, expm(ref.hat(G, d))), d, 1e-13)
    S = spd(4, rng())
    close(S, S.T, 0)
    assert np.linalg.eigvalsh(S)[0] > 0
    x = ref.draw(S, rng(), 20_000)
    assert ref.misfit(x, S) < ref.bound(20_000)
    assert ref.misfit(x, 1.2 * S) > ref.bound(20_000)


@groups
def test_transport_against_the_definition_of_the_adjoint(G):
    n = G.form.dim
    T, S1, S12 = G.exp(rng().normal(size=n)), spd(n, rng()), spd(n, np.random.default_rng(4))
    M = T.matrix()
    A, B = ref.adjoint(G, M), ref.adjoint(G, np.linalg.inv(M))
    C = 0.1 * rng().normal(size=(n, n))
    whole = np.block([[S1, C], [C.T, S12]])
    for got, want in (
        (uncertainty.body_to_world(T, S1), A @ S1 @ A.T),
        (uncertainty.world_to_body(T, S1), B @ S1 @ B.T),
        (uncertainty.of_inverse(T, S1), A @ S1 @ A.T),
        (uncertainty.of_compose(T, S1, S12), B @ S1 @ B.T + S12),
        (uncertainty.of_compose(T, S1, S12, C), B @ S1 @ B.T + S12 + B @ C + C.T @ B.T),
        (uncertainty.of_between(T, whole), B @ S1 @ B.T + S12 - B @ C - C.T @ B.T),
        (uncertainty.propagate(A[:1], S1), A[:1] @ S1 @ A[:1].T),
    ):
        close(got, want, 1e-14)
        assert np.array_equal(got, got.T)


@groups
def test_there_and_back(G):
    n = G.form.dim
    T, S = G.exp(rng().normal(size=n)), spd(n, rng())
    close(uncertainty.world_to_body(T, uncertainty.body_to_world(T, S)), S, 1e-13)
    close(uncertainty.of_inverse(T.inverse(), uncertainty.of_inverse(T, S)), S, 1e-13)


@groups
def test_composition_is_associative(G):
    """Covariances of (T1 T2) T3 and of T1 (T2 T3)."""
    n = G.form.dim
    T2, T3 = (G.exp(d) for d in rng().normal(size=(2, n)))
    S1, S2, S3 = (spd(n, np.random.default_rng(k)) for k in range(3))
    left = uncertainty.of_compose(T3, uncertainty.of_compose(T2, S1, S2), S3)
    right = uncertainty.of_compose(T2.compose(T3), S1, uncertainty.of_compose(T3, S2, S3))
    close(left, right, 1e-13)


@groups
def test_batches_are_their_elements(G):
    n = G.form.dim
    r = rng()
    d = r.normal(size=(3, n))
    singles = [G.exp(row) for row in d]
    T = G.from_storage(np.stack([np.asarray(t) for t in singles]))
    S = np.stack([spd(n, r) for _ in range(3)])
    two = np.stack([spd(2 * n, r) for _ in range(3)])
    for f in (uncertainty.body_to_world, uncertainty.world_to_body, uncertainty.of_inverse):
        close(f(T, S), np.stack([f(t, s) for t, s in zip(singles, S, strict=True)]), 1e-15)
        close(f(T, S[0])[2], f(singles[2], S[0]), 1e-15)
        assert f(T, S[:, None]).shape == (3, 3, n, n)
    between = np.stack([uncertainty.of_between(t, s) for t, s in zip(singles, two, strict=True)])
    close(uncertainty.of_between(T, two), between, 1e-15)
    close(uncertainty.of_compose(T, S, S[0])[1], uncertainty.of_compose(singles[1], S[1], S[0]), 1e-15)
    close(uncertainty.sqrt_info(S)[1], uncertainty.sqrt_info(S[1]), 1e-15)
    close(uncertainty.posterior(two[..., :n], two)[2], uncertainty.posterior(two[2, :, :n], two[2]), 1e-12)
    assert np.asarray(uncertainty.sample(T, S, r)).shape == (3, G.form.size)
    assert np.asarray(uncertainty.sample(T, S[0], r, 5)).shape == (5, 3, G.form.size)
    assert np.asarray(uncertainty.sample(singles[0], S, r, (2, 5))).shape == (2, 5, 3, G.form.size)
    twists = r.normal(size=(4, 3, n))
    tracks = uncertainty.dead_reckoning(T, twists, 0.1, start=S, noise=S[0])
    one = uncertainty.dead_reckoning(singles[1], twists[:, 1], 0.1, start=S[1], noise=S[0])
    close(np.asarray(tracks.poses)[:, 1], np.asarray(one.poses), 1e-15)
    close(tracks.covariances[:, 1], one.covariances, 1e-15)


def test_samples_repeat_with_their_seed():
    z, S = SE3.exp([0.1, 0.2, 0.3, 1, 2, 3]), spd(6, rng())
    a, b = (np.asarray(uncertainty.sample(z, S, np.random.default_rng(5), 4)) for _ in range(2))
    assert np.array_equal(a, b)
    assert len(np.unique(a[:, 0])) == 4
    with pytest.raises(
        UncertaintyError, match=r"rng must be a generator, np.random.default_rng\(seed\), got a int"
    ):
        uncertainty.sample(z, S, 5)


def test_packed_is_the_upper_triangle_row_by_row():
    R = np.arange(18.0).reshape(2, 3, 3)
    found = uncertainty.packed(R)
    np.testing.assert_array_equal(found[1], [9, 10, 11, 13, 14, 17])
    assert found.flags.c_contiguous


@pytest.mark.parametrize("n", [1, 2, 3, 6, 9])
def test_sqrt_info_is_upper_triangular(n):
    S = spd(n, rng(), np.geomspace(1e-4, 1e3, n))
    R = uncertainty.sqrt_info(S)
    assert np.array_equal(R, np.triu(R))
    assert np.all(np.diag(R) > 0)
    scale = np.sqrt(np.diag(S))
    close((R @ S @ R.T), np.eye(n), 1e-13)
    close(R.T @ R * np.outer(scale, scale), np.linalg.inv(S / np.outer(scale, scale)), 1e-12)
    # unique: the transposed Cholesky factor of S^-1
    close(R * scale, np.linalg.cholesky(np.linalg.inv(S / np.outer(scale, scale))).T, 1e-12)


def test_blocks():
    A, B, C = spd(2, rng()), spd(3, rng()), 0.1 * rng().normal(size=(2, 3))
    close(uncertainty.block_diagonal(A, B, A), block_diag(A, B, A), 0)
    close(uncertainty.joint(A, B), block_diag(A, B), 0)
    close(uncertainty.joint(A, B, C), np.block([[A, C], [C.T, B]]), 0)


def test_asymmetry_of_rounding_is_averaged_away():
    S = spd(6, rng(), [1e-4, 1, 1e3, 1, 1, 1])
    noisy = S * (1 + 1e-12 * rng().normal(size=(6, 6)))
    moved = uncertainty.of_inverse(SE3.identity(), noisy)
    assert np.array_equal(moved, moved.T)
    close(moved, S, 1e-11)


T3, S6 = SE3.identity(), np.eye(6)
INDEFINITE = np.array([[1.0, 2.0], [2.0, 1.0]])
BAD = {
    "size": (
        lambda: uncertainty.of_inverse(T3, np.eye(3)),
        r"S must have the shape \(\.\.\., 6, 6\).*\(3, 3\).*dimension 6",
    ),
    "flat": (
        lambda: uncertainty.from_ros(T3, np.ones(36)),
        r"\(36,\); reshape it: np.reshape\(S, \(6, 6\)\)",
    ),
    "sigmas": (lambda: uncertainty.sample(T3, np.ones(6), rng()), r"np.diag\(sigmas\*\*2\)"),
    "packed, not square": (lambda: uncertainty.packed(np.ones((3, 2))), r"\(\.\.\., n, n\), got \(3, 2\)"),
    "not square": (lambda: uncertainty.sqrt_info(np.ones((2, 3))), r"\(\.\.\., n, n\).*\(2, 3\)"),
    "joint size": (
        lambda: uncertainty.of_between(T3, S6),
        r"joint covariance S of both poses.*\(\.\.\., 12, 12\)",
    ),
    "cross size": (
        lambda: uncertainty.joint(np.eye(2), np.eye(3), np.ones((3, 2))),
        r"cross.*\(\.\.\., 2, 3\)",
    ),
    "not symmetric": (
        lambda: uncertainty.sqrt_info([[1, 0.5], [0.4, 1]]),
        r"not symmetric: entry \[0, 1\] is 0.5, entry \[1, 0\] is 0.4.*\(S \+ S.T\) / 2",
    ),
    "variance": (
        lambda: uncertainty.sqrt_info(np.diag([1.0, 0.0])),
        r"not positive definite: variance 1 .*is 0; give a direction",
    ),
    "eigenvalue": (
        lambda: uncertainty.sqrt_info(INDEFINITE),
        r"not positive definite: eigenvalue 0 of 2 .*is -1, along \(-?0.71, -?0.71\)"
        r".*off its diagonal",
    ),
    "singular": (
        lambda: uncertainty.sqrt_info(np.ones((2, 2))),
        r"not positive definite: eigenvalue 0 of 2.*small variance",
    ),
    "batch": (
        lambda: uncertainty.sqrt_info([np.eye(2), INDEFINITE]),
        r"S\[1\] is not positive definite",
    ),
    "cross": (
        lambda: uncertainty.of_compose(T3, S6, S6, 1.5 * S6),
        r"joint covariance.*not positive semidefinite: eigenvalue 0 of 12",
    ),
    "nan": (lambda: uncertainty.whiten([0.0, 1.0], [[1, np.nan], [0, 1]]), r"S\[0, 1\] is nan"),
    "text": (lambda: uncertainty.sqrt_info("one"), r"S must be an array of numbers, got a str"),
    "no group": (
        lambda: uncertainty.of_inverse(S2.direction([1.0, 0, 0]), np.eye(2)),
        r"Lie group.*got a S2",
    ),
    "order": (
        lambda: uncertainty.to_order(SE3, S6, "xyz"),
        r"unknown order 'xyz'; one of rotation-first, translation-first",
    ),
    "order of": (
        lambda: uncertainty.to_order(SO3, np.eye(3), "rotation-first"),
        r"SO3 has no rotation and translation",
    ),
    "ros": (lambda: uncertainty.to_ros(SE2.identity(), np.eye(3)), r"must be SE3, got a SE2"),
    "rank": (
        lambda: uncertainty.posterior([[1.0, 1.0], [2.0, 2.0]], np.eye(2)),
        r"leave 1 of 2 directions free, among them \((-1, 1|1, -1)\); add a prior",
    ),
    "few rows": (
        lambda: uncertainty.posterior(np.eye(6)[:4], np.eye(4)),
        r"leave 2 of 6 directions free",
    ),
    "both": (lambda: uncertainty.posterior(np.eye(2)), r"give one of both"),
    "A": (
        lambda: uncertainty.posterior([1.0, 2.0], np.eye(2)),
        r"A must have the shape \(\.\.\., m, n\)",
    ),
    "sqrt_info": (
        lambda: uncertainty.posterior(np.eye(3), sqrt_info=np.eye(2)),
        r"sqrt_info must have the shape \(\.\.\., 3, 3\)",
    ),
    "J": (
        lambda: uncertainty.propagate([1.0, 2.0], np.eye(2)),
        r"J must have the shape \(\.\.\., m, n\)",
    ),
    "h": (lambda: uncertainty.whiten(1.0, np.eye(1)), r"h must be a vector"),
    "twists": (
        lambda: uncertainty.dead_reckoning(T3, np.ones((4, 3)), 0.1),
        r"twists must have the shape \(k, \.\.\., 6\): rx \[rad\]",
    ),
    "dt": (
        lambda: uncertainty.dead_reckoning(T3, np.ones((4, 6)), [0.1, 0.1]),
        r"dt must be one number or 4",
    ),
    "dt 0": (lambda: uncertainty.dead_reckoning(T3, np.ones((4, 6)), 0.0), r"dt must be positive"),
    "noise": (
        lambda: uncertainty.dead_reckoning(T3, np.ones((4, 6)), 0.1, noise=np.stack([S6] * 3)),
        r"noise.*k = 4",
    ),
    "nothing": (uncertainty.block_diagonal, r"at least one"),
}


@pytest.mark.parametrize(("call", "message"), BAD.values(), ids=BAD)
def test_refusals_say_what_and_how_to_cure_it(call, message):
    with pytest.raises(UncertaintyError, match=message) as caught:
        call()
    assert isinstance(caught.value, LiegenError)
    assert str(caught.value).startswith("test_uncertainty.py:")


def test_units_do_not_decide_what_is_positive_definite():
    """Microradians beside kilometres are fine, though eigenvalues of S span twenty orders."""
    S = spd(6, rng(), [1e-7] * 3 + [1e3] * 3)
    R = uncertainty.sqrt_info(S)
    scale = np.sqrt(np.diag(S))
    close((R * scale) @ (S / np.outer(scale, scale)) @ (R * scale).T, np.eye(6), 1e-12)


def test_dead_reckoning_of_nothing_is_the_start():
    track = uncertainty.dead_reckoning(SO2.exp([0.3]), np.zeros((0, 1)), 0.1, start=[[2.0]])
    close(np.asarray(track.poses), [[np.cos(0.3), np.sin(0.3)]], 1e-15)
    close(track.covariances, [[[2.0]]], 0)
    assert uncertainty.dead_reckoning(R3.identity(), np.ones((2, 3)), 0.5).covariances is None


def test_the_guide_runs(capsys):
    """The code of docs/uncertainty.md, and what it says about its figures."""
    text = (Path(__file__).resolve().parents[2] / "docs" / "uncertainty.md").read_text()
    code = "\n".join(line[4:] for line in text.splitlines() if line.startswith("    "))
    names = {}
    exec(code, names)
    assert np.max(np.sqrt(np.diag(names["S_x1"]))) == pytest.approx(0.18, abs=0.01)
    assert np.trace(names["relative"]) == pytest.approx(np.trace(names["S"]), rel=1e-9)
    assert np.trace(names["wrong"]) > 5 * np.trace(names["S"])
    assert "R3(" in capsys.readouterr().out
