"""What `SparseSolver` is given: solved as NumPy's dense solver does, or refused by name."""

from __future__ import annotations

import numpy as np
import pytest

from liegen import SparseSolver

sparse = pytest.importorskip("scipy.sparse")

H = np.array([[2.0, 1, 0], [1, 3, 0.5], [0, 0.5, 4]])
B = np.array([1.0, -2, 3])


@pytest.fixture(params=["cholmod", "superlu"])
def solver(request):
    if request.param == "cholmod":
        pytest.importorskip("cvxopt.cholmod")
    return SparseSolver(request.param)


MATRICES = {
    "dense": H,
    "lists": H.tolist(),
    "single": sparse.csc_array(H.astype(np.float32)),
    "integers": np.array([[4, 1, 0], [1, 5, 2], [0, 2, 6]]),
    "sparse integers": sparse.csr_array(np.array([[4, 1, 0], [1, 5, 2], [0, 2, 6]])),
    "dia": sparse.dia_array(H),
    "lil": sparse.lil_array(H),
    "a matrix": sparse.csr_matrix(H),
    "fortran": np.asfortranarray(H),
}


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize(
    "b", [B, B.tolist(), [1, 2, 3], np.stack([B, 2 * B], 1), B[:, None], np.zeros((3, 0))]
)
def test_solved(solver, name, b):
    given = MATRICES[name]
    expected = np.linalg.solve(given.toarray() if sparse.issparse(given) else np.array(given), b)
    found = solver(given, b)
    assert found.shape == np.shape(b)
    np.testing.assert_allclose(found, expected, rtol=1e-5 if name == "single" else 1e-12)


@pytest.mark.parametrize("damping", [1, np.float32(0.5), np.array(2.0), 0])
def test_damping_scales_the_diagonal(solver, damping):
    expected = np.linalg.solve(H + float(damping) * np.diag(np.diag(H)), B)
    np.testing.assert_allclose(solver(H, B, damping), expected, rtol=1e-12)


def test_no_unknowns(solver):
    assert solver(np.zeros((0, 0)), np.zeros(0)).shape == (0,)


def test_another_pattern_of_the_same_size_is_seen(solver):
    """As many entries in each column, in other rows; and the same pattern in another format."""
    a = np.array([[4.0, 1, 0, 0], [1, 4, 0, 0], [0, 0, 4, 1], [0, 0, 1, 4]])
    b = a[np.ix_([0, 2, 1, 3], [0, 2, 1, 3])]
    side = np.arange(1.0, 5)
    assert np.array_equal(sparse.csc_array(a).indptr, sparse.csc_array(b).indptr)
    for given in (a, b, a):
        np.testing.assert_allclose(
            solver(sparse.csc_array(given), side), np.linalg.solve(given, side), atol=1e-15
        )
    for layout in (sparse.csr_array, sparse.bsr_array, sparse.csc_array, sparse.coo_array):
        np.testing.assert_allclose(solver(layout(b), side), np.linalg.solve(b, side))


def test_indices_of_the_same_columns_count(solver):
    """Equal pointers, equal shapes: only the indices differ, of matrices that are not reordered before."""
    side = np.arange(1.0, 5)
    for i, j in ((0, 1), (2, 3)), ((0, 2), (1, 3)), ((0, 3), (1, 2)):
        given = 3.0 * np.eye(4)
        for p in (i, j):
            given[p[0], p[1]] = given[p[1], p[0]] = 1.0
        np.testing.assert_allclose(
            solver(sparse.csc_array(given), side), np.linalg.solve(given, side), atol=1e-15
        )


def test_a_matrix_that_is_not_square_is_seen_after_one_that_is(solver):
    good = sparse.csr_array(np.eye(2))
    solver(good, np.ones(2))
    wide = sparse.csr_array((good.data, good.indices, good.indptr), shape=(2, 3))
    with pytest.raises(ValueError, match=r"H must be square, its shape is \(2, 3\)"):
        solver(wide, np.ones(2))


def _with(entry, i=1, j=2):
    changed = H.copy()
    changed[i, j] = changed[j, i] = entry
    return changed


REFUSED = [
    (H * 1j, B, 0.0, TypeError, ["H", "complex128", "H.real"]),
    (sparse.csc_array(H * 1j), B, 0.0, TypeError, ["H", "complex128", "H.real"]),
    (_with(np.nan), B, 0.0, ValueError, ["H[", "nan"]),
    (sparse.csr_array(_with(np.inf)), B, 0.0, ValueError, ["H[", "inf"]),
    (H.astype(object), B, 0.0, TypeError, ["H", "object"]),
    ("H", B, 0.0, TypeError, ["H", "real numbers"]),
    ([[1.0], [2.0, 3]], B, 0.0, TypeError, ["H", "different lengths"]),
    (np.ma.masked_array(H, H > 3), B, 0.0, TypeError, ["H", "masked"]),
    (H[:2], B, 0.0, ValueError, ["H must be square", "(2, 3)"]),
    (H[0], B, 0.0, ValueError, ["H must be square", "(3,)"]),
    (H, B[:2], 0.0, ValueError, ["b must have the shape (3,)", "(2,)"]),
    (H, B[None], 0.0, ValueError, ["b must have the shape (3,) or (3, k)", "(1, 3)"]),
    (H, 1.0, 0.0, ValueError, ["b must have the shape", "()"]),
    (H, np.ones((3, 2, 2)), 0.0, ValueError, ["b must have the shape", "(3, 2, 2)"]),
    (H, B * 1j, 0.0, TypeError, ["b", "complex128"]),
    (H, [1.0, np.nan, 0], 0.0, ValueError, ["b[1]", "nan"]),
    (H, ["1", "2", "3"], 0.0, TypeError, ["b", "real numbers"]),
    (H, sparse.csc_array(B[:, None]), 0.0, TypeError, ["b", "b.toarray()"]),
    (H, np.ma.masked_array(B, [0, 1, 0]), 0.0, TypeError, ["b", "masked"]),
    (H, B, np.nan, ValueError, ["damping", "nan"]),
    (H, B, -0.5, ValueError, ["damping", "-0.5"]),
    (H, B, np.inf, ValueError, ["damping", "inf"]),
    (H, B, "0.1", TypeError, ["damping", "str"]),
    (H, B, None, TypeError, ["damping", "NoneType"]),
    (H, B, True, TypeError, ["damping", "bool"]),
    (H, B, 1j, TypeError, ["damping", "complex"]),
    (H, B, [0.1, 0.2, 0.3], TypeError, ["damping", "(3,)"]),
    (np.triu(H), B, 0.0, ValueError, ["H is not symmetric", "both triangles"]),
    (sparse.csr_array(np.tril(H)), B, 0.0, ValueError, ["H is not symmetric", "both triangles"]),
    (np.diag([1.0, -1, 1]), B, 0.0, np.linalg.LinAlgError, ["not positive definite", "prior"]),
    (np.ones((3, 3)), B, 0.0, np.linalg.LinAlgError, ["not positive definite", "prior", "damping"]),
]  # fmt: skip


@pytest.mark.parametrize(("matrix", "b", "damping", "error", "parts"), REFUSED)
def test_refused_by_name(solver, matrix, b, damping, error, parts):
    with pytest.raises(error) as caught:
        solver(matrix, b, damping)
    for part in parts:
        assert part in str(caught.value)
    np.testing.assert_allclose(solver(H, B), np.linalg.solve(H, B))  # nothing is left of it


@pytest.mark.parametrize("seed", range(4))
def test_what_the_factors_leave_free_is_found(solver, seed):
    """A chain that no prior holds: its last pivot is rounding, of either sign."""
    rng = np.random.default_rng(seed)
    J = np.zeros((3 * 9, 3 * 10))
    for k in range(9):
        W = rng.normal(size=(3, 3))
        J[3 * k : 3 * k + 3, 3 * k : 3 * k + 6] = np.hstack([-W, W])
    with pytest.raises(np.linalg.LinAlgError, match=r"pivot.*give damping"):
        solver(sparse.csc_array(J.T @ J), np.ones(30))
    assert np.isfinite(solver(sparse.csc_array(J.T @ J), np.ones(30), 1e-6)).all()
