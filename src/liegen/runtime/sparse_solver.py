"""``SparseSolver``: H d = b with H sparse and positive definite; what its pattern decides is done once."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.errors import ToolError

from .sparse_inputs import damping_of, matrix_of, need_symmetric, right_sides

Array = NDArray[np.float64]
Backend = Literal["cholmod", "superlu"]
#: Numbers of the matrix in the order of its columns, and b (dim,) or (dim, k): the solution, of b's shape.
Solve = Callable[[Array, Array], Array]
#: Pivots of the elimination, relative to the diagonal of H, from which on they are rounding.
SMALLEST_PIVOT = 16 * float(np.finfo(np.float64).eps)


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

    layout: tuple[Any, ...]
    indices: NDArray[Any]
    indptr: NDArray[Any]
    columns: Columns
    solve: Solve

    def fits(self, H: Any) -> bool:
        """Whether a matrix has this pattern, in the same format."""
        return (
            _layout(H) == self.layout
            and np.array_equal(H.indptr, self.indptr)
            and np.array_equal(H.indices, self.indices)
        )


def _layout(H: Any) -> tuple[Any, ...]:
    return H.format, H.shape, H.data.shape


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

    def __call__(self, H: Any, b: ArrayLike, damping: float = 0.0) -> Array:
        """The solution d, of the shape of ``b``: (dim,), or (dim, k) for k right-hand sides.

        ``H`` is a sparse array of SciPy with both triangles, or a dense (dim, dim) array. BSR, CSC and CSR of
        float64 are read as they are, all else is converted. ``damping`` is relative to the diagonal.
        Raises LinAlgError for a matrix that is not positive definite, also when a pivot is only rounding;
        ValueError for other shapes, numbers that are not finite, a matrix that is not symmetric (looked at
        when the pattern is), or has an entry twice or none on its diagonal, and for negative damping;
        TypeError for what holds no real numbers.
        """
        matrix, scale = matrix_of(H), 1.0 + damping_of(damping)
        sides = right_sides(b, int(matrix.shape[0]))
        if self._analysis is None or not self._analysis.fits(matrix):
            self._analysis = _analysed(matrix, self.backend)
        columns = self._analysis.columns
        data = matrix.data.ravel()[columns.take]
        data[columns.diagonal] *= scale
        return self._analysis.solve(data, sides)


def _installed(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _analysed(H: Any, backend: Backend) -> _Analysis:
    prepare = {"cholmod": _with_cholmod, "superlu": _with_superlu}[backend]
    columns = _columns(H, lower=backend == "cholmod")
    need_symmetric(H)
    return _Analysis(_layout(H), H.indices.copy(), H.indptr.copy(), columns, prepare(columns))


def _columns(H: Any, *, lower: bool) -> Columns:
    """The pattern by columns, of the lower triangle alone or of both."""
    dim = int(H.shape[0])
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
        try:
            cholmod.numeric(matrix, factor)
        except ArithmeticError:
            raise _not_definite("a pivot is not positive") from None
        order = cvxopt.matrix(np.arange(columns.dim, dtype=np.float64))
        cholmod.solve(factor, order, sys=7)  # the permutation
        pivots = np.square(np.array(cholmod.diag(factor)).ravel())
        _need_pivots(pivots, np.array(order).ravel().astype(np.intp), data[columns.diagonal])
        found = cvxopt.matrix(b)
        cholmod.solve(factor, found)
        return np.array(found).reshape(b.shape)

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
        except RuntimeError:
            raise _not_definite("a pivot is 0") from None
        _need_pivots(lu.U.diagonal(), np.argsort(lu.perm_c), data[columns.diagonal])
        return lu.solve(b)

    return solve


def _need_pivots(pivots: Array, order: NDArray[np.intp], diagonal: Array) -> None:
    """Raise LinAlgError unless the pivots, of the unknowns in ``order``, are positive beyond rounding."""
    bad = np.flatnonzero(~(pivots > SMALLEST_PIVOT * np.abs(diagonal[order])))
    if len(bad):
        k = int(order[bad[0]])
        raise _not_definite(
            f"the pivot of unknown {k} is {pivots[bad[0]]:.3g}, H[{k}, {k}] {diagonal[k]:.3g}"
        )


def _not_definite(what: str) -> np.linalg.LinAlgError:
    return np.linalg.LinAlgError(
        f"H is not positive definite, or singular to rounding: {what}; hold a variable fixed, add a prior "
        "or give damping"
    )
