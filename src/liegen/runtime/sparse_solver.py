"""``SparseSolver``: H d = b with H sparse and positive definite; what its pattern decides is done once."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from liegen.errors import ToolError

Array = NDArray[np.float64]
Backend = Literal["cholmod", "superlu"]
#: Numbers of the matrix in the order of its columns, and b: the solution.
Solve = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Columns:
    """A pattern column by column: the row and the column of each entry, and where columns begin.

    ``take`` says which number of H each entry is, ``diagonal`` where H_kk is.
    """

    dim: int
    rows: NDArray[np.int32]
    owners: NDArray[np.int32]
    starts: NDArray[np.int32]
    take: NDArray[np.intp]
    diagonal: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class _Analysis:
    """The pattern as the matrix gave it, and what solves with numbers in it."""

    indices: NDArray[Any]
    indptr: NDArray[Any]
    shape: tuple[int, ...]
    columns: Columns
    solve: Solve

    def fits(self, H: Any) -> bool:
        """Whether a matrix has this pattern."""
        return (
            H.data.shape == self.shape
            and np.array_equal(H.indptr, self.indptr)
            and np.array_equal(H.indices, self.indices)
        )


class SparseSolver:
    """Solves (H + damping diag H) d = b, again and again for matrices of one pattern.

    ``backend`` "cholmod" is the supernodal Cholesky factorisation of SuiteSparse, through the package CVXOPT
    (``pip install liegen[cholesky]``); "superlu" is SciPy's sparse LU, without pivoting. By default CHOLMOD
    where it is installed. The order of elimination is found at the first call, and whenever the pattern is
    another one. Raises ToolError where the package is missing.
    """

    def __init__(self, backend: Backend | None = None) -> None:
        found = _installed("cvxopt.cholmod") if backend != "superlu" else None
        if backend == "cholmod" and found is None:
            raise ToolError("CHOLMOD needs the package cvxopt: pip install liegen[cholesky]")
        if backend not in (None, "cholmod", "superlu"):
            raise ValueError(f"backend is 'cholmod' or 'superlu', got {backend!r}")
        if _installed("scipy.sparse") is None:
            raise ToolError("sparse matrices need SciPy: pip install liegen[sparse]")
        self.backend: Backend = "superlu" if found is None else "cholmod"
        self._analysis: _Analysis | None = None

    def __call__(self, H: Any, b: Array, damping: float = 0.0) -> Array:
        """The solution d (dim,) for a sparse array ``H`` of SciPy, with both triangles, and ``b`` (dim,).

        Formats: BSR, CSC, CSR; the other ones are converted. Raises LinAlgError for a matrix that is not
        positive definite (SuperLU: that is singular), ValueError for one that is not square, or has an entry
        twice or none on its diagonal.
        """
        matrix = H if H.format in ("bsr", "csc", "csr") else H.tocsc()
        if self._analysis is None or not self._analysis.fits(matrix):
            self._analysis = _analysed(matrix, self.backend)
        columns = self._analysis.columns
        data = matrix.data.ravel()[columns.take]
        data[columns.diagonal] *= 1.0 + damping
        return self._analysis.solve(data, np.asarray(b, dtype=np.float64))


def _installed(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _analysed(H: Any, backend: Backend) -> _Analysis:
    prepare = {"cholmod": _with_cholmod, "superlu": _with_superlu}[backend]
    columns = _columns(H, lower=backend == "cholmod")
    return _Analysis(H.indices.copy(), H.indptr.copy(), H.data.shape, columns, prepare(columns))


def _columns(H: Any, *, lower: bool) -> Columns:
    """The pattern by columns, of the lower triangle alone or of both."""
    dim = int(H.shape[0])
    if H.shape != (dim, dim):
        raise ValueError(f"H must be square, its shape is {H.shape}")
    numbers = np.arange(int(H.data.size), dtype=np.float64)
    places = type(H)((numbers.reshape(H.data.shape), H.indices, H.indptr), shape=H.shape).tocsc()
    places.sort_indices()
    rows, owners = places.indices, np.repeat(np.arange(dim, dtype=np.int32), np.diff(places.indptr))
    if np.any((rows[1:] == rows[:-1]) & (owners[1:] == owners[:-1])):
        raise ValueError("H has an entry twice: call H.sum_duplicates() first")
    kept = rows >= owners if lower else np.ones(len(rows), dtype=bool)
    rows, owners = rows[kept].astype(np.int32), owners[kept]
    diagonal = np.flatnonzero(rows == owners)
    if len(diagonal) != dim:
        raise ValueError("H has no entry at some place of its diagonal: a variable is in no factor")
    starts = np.searchsorted(owners, np.arange(dim + 1)).astype(np.int32)
    return Columns(dim, rows, owners, starts, places.data[kept].astype(np.intp), diagonal)


def _with_cholmod(columns: Columns) -> Solve:
    cvxopt: Any = importlib.import_module("cvxopt")
    cholmod: Any = importlib.import_module("cvxopt.cholmod")
    rows, owners = (cvxopt.matrix(c.astype(np.int64)) for c in (columns.rows, columns.owners))
    matrix = cvxopt.spmatrix(1.0, rows, owners, (columns.dim, columns.dim))
    factor = cholmod.symbolic(matrix)

    def solve(data: Array, b: Array) -> Array:
        matrix.V = cvxopt.matrix(data)
        found = cvxopt.matrix(b)
        try:
            cholmod.numeric(matrix, factor)
        except ArithmeticError as error:
            raise np.linalg.LinAlgError(f"H is not positive definite (CHOLMOD: {error})") from None
        cholmod.solve(factor, found)
        return np.array(found).ravel()

    return solve


def _with_superlu(columns: Columns) -> Solve:
    sparse: Any = importlib.import_module("scipy.sparse")
    linalg: Any = importlib.import_module("scipy.sparse.linalg")
    dim = columns.dim

    def solve(data: Array, b: Array) -> Array:
        matrix = sparse.csc_array((data, columns.rows, columns.starts), shape=(dim, dim))
        try:
            lu = linalg.splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise np.linalg.LinAlgError(f"H is singular (SuperLU: {error})") from None
        return lu.solve(b)

    return solve
