"""Sparse systems against dense ones, with both factorisations."""

import importlib

import numpy as np
import pytest

from liegen import SparseSolver
from liegen.errors import ToolError
from liegen.runtime import sparse_solver

sparse = pytest.importorskip("scipy.sparse")


@pytest.fixture(params=["cholmod", "superlu"])
def backend(request):
    if request.param == "cholmod":
        pytest.importorskip("cvxopt.cholmod")
    return request.param


def system(seed, blocks=7, size=3):
    """A positive definite matrix of blocks, not all of them stored, and a right-hand side."""
    rng = np.random.default_rng(seed)
    J = np.zeros((4 * blocks * size, blocks * size))
    for k in range(4 * blocks):
        for b in (k % blocks, (k * k + 1) % blocks):
            J[size * k : size * (k + 1), size * b : size * (b + 1)] += rng.normal(size=(size, size))
    return J.T @ J + 0.1 * np.eye(blocks * size), rng.normal(size=blocks * size)


FORMATS = {
    "bsr": lambda H: sparse.bsr_array(H, blocksize=(3, 3)),
    "csc": sparse.csc_array,
    "csr": sparse.csr_array,
    "coo": sparse.coo_array,
}


@pytest.mark.parametrize("layout", FORMATS)
def test_solutions_are_those_of_the_dense_system(backend, layout):
    solver = SparseSolver(backend)
    assert solver.backend == backend
    for seed in range(3):
        H, b = system(seed)
        for damping in (0.0, 0.5):
            expected = np.linalg.solve(H + damping * np.diag(np.diag(H)), b)
            found = solver(FORMATS[layout](H), b, damping)
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_the_matrix_is_left_as_it_is_and_unsorted_rows_are_fine(backend):
    H, b = system(1)
    given = sparse.csr_array(H)
    for row in range(given.shape[0]):
        part = slice(given.indptr[row], given.indptr[row + 1])
        given.indices[part], given.data[part] = (
            given.indices[part][::-1].copy(),
            given.data[part][::-1].copy(),
        )
    given.has_sorted_indices = False
    before = given.indices.copy(), given.data.copy()
    found = SparseSolver(backend)(given, b, damping=1.0)
    np.testing.assert_allclose(found, np.linalg.solve(H + np.diag(np.diag(H)), b), rtol=1e-9)
    np.testing.assert_array_equal(given.indices, before[0])
    np.testing.assert_array_equal(given.data, before[1])


def test_a_pattern_is_analysed_once(backend, monkeypatch):
    counted = []
    real = sparse_solver._analysed
    monkeypatch.setattr(sparse_solver, "_analysed", lambda H, b: counted.append(H.shape) or real(H, b))
    solver = SparseSolver(backend)
    for seed in range(3):
        H, b = system(seed)
        solver(sparse.csc_array(H), b)
    assert counted == [(21, 21)]
    H, b = system(0, blocks=5)
    np.testing.assert_allclose(solver(sparse.csc_array(H), b), np.linalg.solve(H, b), rtol=1e-9)
    assert counted == [(21, 21), (15, 15)]


def test_matrices_without_a_solution_are_errors(backend):
    solver = SparseSolver(backend)
    with pytest.raises(np.linalg.LinAlgError, match=r"positive definite|singular"):
        solver(sparse.csc_array(np.ones((3, 3))), np.ones(3))
    H, b = system(2)  # and it can be used again
    np.testing.assert_allclose(solver(sparse.csc_array(H), b), np.linalg.solve(H, b), rtol=1e-9)
    with pytest.raises(ValueError, match="must be square"):
        solver(sparse.csc_array(np.ones((3, 2))), np.ones(3))
    with pytest.raises(ValueError, match="diagonal"):
        solver(sparse.csc_array(np.array([[1.0, 0], [0, 0]])), np.ones(2))
    twice = sparse.csc_array((np.ones(3), [0, 1, 1], [0, 1, 3]), shape=(2, 2))
    with pytest.raises(ValueError, match="sum_duplicates"):
        solver(twice, np.ones(2))


def test_what_is_not_positive_definite_is_found_by_cholmod():
    pytest.importorskip("cvxopt.cholmod")
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        SparseSolver("cholmod")(sparse.csc_array(np.diag([1.0, -1.0])), np.ones(2))


def test_scipy_does_where_cholmod_is_missing(monkeypatch):
    real = importlib.import_module

    def without(name):
        if name.startswith("cvxopt"):
            raise ImportError(name)
        return real(name)

    monkeypatch.setattr(sparse_solver.importlib, "import_module", without)
    assert SparseSolver().backend == "superlu"
    with pytest.raises(ToolError, match=r"liegen\[cholesky\]"):
        SparseSolver("cholmod")
    with pytest.raises(ValueError, match="'cholmod' or 'superlu'"):
        SparseSolver("lu")
