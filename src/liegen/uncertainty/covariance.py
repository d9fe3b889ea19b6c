"""Covariance matrices: what is accepted as one, its square-root information, blocks and linear maps."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.errors import UncertaintyError
from liegen.manifolds.node import here

Array = NDArray[np.float64]
#: Largest asymmetry, in units of the entries' standard deviations, that counts as rounding.
ASYMMETRY = 1e-9


def numbers(a: ArrayLike, name: str) -> Array:
    """An array of finite floats. Raises UncertaintyError for anything else."""
    try:
        array = np.asarray(a, dtype=np.float64)
    except (TypeError, ValueError):
        raise UncertaintyError(
            f"{here()}: {name} must be an array of numbers, got a {type(a).__name__}"
        ) from None
    if not np.all(np.isfinite(array)):
        index = _place(~np.isfinite(array))
        raise UncertaintyError(f"{here()}: {name}{list(index)} is {array[index]}; give it a finite number")
    return array


def square(a: ArrayLike, n: int | None, name: str) -> Array:
    """An array of shape (..., n, n). Raises UncertaintyError with the size that was expected."""
    array = numbers(a, name)
    size = n if n is not None else (array.shape[-1] if array.ndim else 0)
    if array.ndim < 2 or array.shape[-2:] != (size, size) or size == 0:
        wanted = f"(..., {n}, {n})" if n is not None else "(..., n, n)"
        raise UncertaintyError(
            f"{here()}: {name} must have the shape {wanted}, this one has {array.shape}; "
            f"{_cure(array, n, name)}"
        )
    return array


def covariance(a: ArrayLike, n: int | None = None, name: str = "S") -> Array:
    """A covariance of shape (..., n, n), exactly symmetric: positive semidefinite to rounding.

    What is known exactly has variance 0, and covariance 0 with all else. Raises UncertaintyError unless it is
    symmetric (to 1e-9 of the standard deviations; what is below is rounding and is averaged away), and the
    eigenvalues of the correlation matrix, which do not depend on units, are above -n times 1e-9. A row that
    is all below the rounding of the variances that it is coupled to counts as 0.
    """
    S = square(a, n, name)
    rounding = _rounding(S)
    return _checked(S, rounding, _exact(S, rounding), name, _SEMIDEFINITE)


def definite(a: ArrayLike, n: int | None = None, name: str = "S") -> Array:
    """A covariance that has an inverse, exactly symmetric.

    Raises UncertaintyError likewise, and where an eigenvalue of the correlation matrix is not above n times
    the machine precision.
    """
    S = square(a, n, name)
    return _checked(S, np.zeros(S.shape[:-1]), np.zeros(S.shape[:-1], dtype=bool), name, _DEFINITE)


class _Kind(NamedTuple):
    """``eigenvalue`` times n is the smallest one of a correlation matrix; ``cure`` of a variance."""

    word: str
    eigenvalue: float
    cure: str


_EPS = float(np.finfo(np.float64).eps)
_SMALL = "give a direction that is known exactly a small variance, one that is unknown a large variance"
_SEMIDEFINITE = _Kind("semidefinite", -ASYMMETRY, "what is known exactly has 0 in its whole row and column")
_DEFINITE = _Kind("definite", _EPS, _SMALL)
#: Part of a variance that rounding may take, however much larger the others are.
_LOST = 1e-3


def _rounding(S: Array) -> Array:
    """What float64 may leave of a variance that is 0, (..., n): relative to the largest tied to it."""
    n = S.shape[-1]
    tied = (S != 0) | np.swapaxes(S != 0, -1, -2) | np.eye(n, dtype=bool)
    for _ in range(n.bit_length()):
        tied = tied @ tied
    variance = np.abs(np.diagonal(S, axis1=-2, axis2=-1))
    largest: Array = np.max(np.where(tied, variance[..., None, :], 0.0), axis=-1)
    return (16 * n * _EPS) * largest


def _exact(S: Array, rounding: Array) -> NDArray[np.bool_]:
    """What is known exactly, (..., n): its row and column are 0, or all of it is rounding."""
    variance = np.diagonal(S, axis1=-2, axis2=-1)
    off = np.abs(np.where(np.eye(S.shape[-1], dtype=bool), 0.0, S))
    most = np.maximum(off.max(axis=-1), off.max(axis=-2))
    alone = (most == 0) & (variance <= 0) & (variance >= -rounding.max(axis=-1, keepdims=True))
    return alone | ((np.abs(variance) <= rounding) & (most <= rounding))


def _checked(S: Array, rounding: Array, exact: NDArray[np.bool_], name: str, kind: _Kind) -> Array:
    variance = np.diagonal(S, axis1=-2, axis2=-1)
    bad = (variance <= 0) & ~exact
    if np.any(bad):
        index = _place(bad)
        raise UncertaintyError(
            f"{here()}: {_element(name, index[:-1])} is not positive {kind.word}: variance {index[-1]} "
            f"(counted from 0) is {variance[index]:.6g}; {kind.cure}"
        )
    used = np.where(exact, 1.0, variance)
    rest = np.where(exact[..., :, None] | exact[..., None, :], 0.0, S)
    lost = np.minimum(rounding, _LOST * used)
    deviation, blurred = np.sqrt(used), np.sqrt(lost)
    skew = np.abs(rest - np.swapaxes(rest, -1, -2)) > ASYMMETRY * _outer(deviation) + _outer(blurred)
    if np.any(skew):
        *batch, i, j = index = _place(skew)
        raise UncertaintyError(
            f"{here()}: {_element(name, tuple(batch))} is not symmetric: entry [{i}, {j}] is {S[index]:.9g}, "
            f"entry [{j}, {i}] is {S[(*batch, j, i)]:.9g}; if that is rounding give (S + S.T) / 2"
        )
    raised = rest + np.swapaxes(rest, -1, -2) + 2 * (lost + exact)[..., None] * np.eye(S.shape[-1])
    _need_positive(raised / 2 / _outer(deviation), name, kind)
    return (S + np.swapaxes(S, -1, -2)) / 2


def _outer(v: Array) -> Array:
    return v[..., :, None] * v[..., None, :]


def _need_positive(correlation: Array, name: str, kind: _Kind) -> None:
    values, vectors = np.linalg.eigh(correlation)
    n = correlation.shape[-1]
    least = n * kind.eigenvalue
    bad = values[..., 0] <= least
    if np.any(bad):
        index = _place(bad)
        value, direction = values[index][0], vectors[index][:, 0]
        along = ", ".join(f"{x:.2g}" for x in direction)
        cure = (
            _SMALL
            if value > -16 * n * _EPS
            else "check the entries off its diagonal: order, frames, a transposed block"
        )
        raise UncertaintyError(
            f"{here()}: {_element(name, index)} is not positive {kind.word}: eigenvalue 0 of {n} of its "
            f"correlation matrix is {value:.6g}, along ({along}); it must exceed {least:.2g}; {cure}"
        )


def propagate(J: ArrayLike, S: ArrayLike) -> Array:
    """J S J^T: covariance of J n for n ~ N(0, S).

    J has shape (..., m, n), S (..., n, n). With the Jacobian of a function in its tangent spaces this is
    the function's covariance (micro Lie, "Uncertainty in manifolds, covariance propagation").
    """
    jacobian = numbers(J, "J")
    if jacobian.ndim < 2:
        raise UncertaintyError(f"{here()}: J must have the shape (..., m, n), this one has {jacobian.shape}")
    return through(jacobian, covariance(S, jacobian.shape[-1]))


@np.errstate(all="ignore")  # what overflows is inf; a warning would name this line
def through(J: Array, S: Array) -> Array:
    """J S J^T, exactly symmetric, of arrays that are checked."""
    moved = J @ S @ np.swapaxes(J, -1, -2)
    return (moved + np.swapaxes(moved, -1, -2)) / 2


def joint(S1: ArrayLike, S2: ArrayLike, cross: ArrayLike | None = None) -> Array:
    """The covariance [[S1, C], [C^T, S2]] of (n1, n2), of shape (..., n1 + n2, n1 + n2).

    ``cross`` is C = E[n1 n2^T], of shape (..., n1, n2); None: independent. Each of n1 and n2 lives in its
    own body frame. Raises UncertaintyError when the whole is not positive semidefinite: a cross covariance
    can be too large.
    """
    A, B = covariance(S1, name="S1"), covariance(S2, name="S2")
    if cross is None:
        return _blocks(A, B, np.zeros((A.shape[-1], B.shape[-1])))
    C = numbers(cross, "cross")
    if C.shape[-2:] != (A.shape[-1], B.shape[-1]):
        raise UncertaintyError(
            f"{here()}: cross must have the shape (..., {A.shape[-1]}, {B.shape[-1]}), E[n1 n2^T], "
            f"this one has {C.shape}"
        )
    return covariance(_blocks(A, B, C), name="the joint covariance [[S1, cross], [cross^T, S2]]")


def block_diagonal(*S: ArrayLike) -> Array:
    """The covariance of independent errors stacked in this order, as residuals and Jacobians are."""
    parts = [covariance(a, name=f"covariance {k}") for k, a in enumerate(S)]
    if not parts:
        raise UncertaintyError(f"{here()}: block_diagonal() needs at least one covariance")
    whole = parts[0]
    for part in parts[1:]:
        whole = _blocks(whole, part, np.zeros((whole.shape[-1], part.shape[-1])))
    return whole


def sqrt_info(S: ArrayLike) -> Array:
    """The upper triangular R with R^T R = S^-1 and a positive diagonal, of the shape of S.

    R h is whitened: its covariance is the identity when that of h is S. S is factored from its last row up
    (S = U U^T, R = U^-1), so that S^-1 is never formed. Raises UncertaintyError where S is only semidefinite:
    it has no inverse.
    """
    reverse = definite(S)[..., ::-1, ::-1]
    upper = np.linalg.cholesky(reverse)[..., ::-1, ::-1]
    return np.triu(np.linalg.inv(upper)).astype(np.float64, copy=False)


def packed(R: ArrayLike) -> Array:
    """The upper triangle of R (..., n, n) row by row, (..., n (n + 1) / 2): what ``noise="packed"`` takes."""
    rows = numbers(R, "R")
    if rows.ndim < 2 or rows.shape[-1] != rows.shape[-2]:
        raise UncertaintyError(f"{here()}: R must have shape (..., n, n), got {rows.shape}")
    return np.ascontiguousarray(rows[(..., *np.triu_indices(rows.shape[-1]))])


def whiten(h: ArrayLike, S: ArrayLike) -> Array:
    """R h with R = ``sqrt_info(S)``; h has shape (..., n), in the frame and order of S."""
    h = numbers(h, "h")
    if h.ndim == 0:
        raise UncertaintyError(f"{here()}: h must be a vector of shape (..., n), got a single number")
    R = sqrt_info(definite(S, h.shape[-1]))
    return (R @ h[..., None])[..., 0]


def squared_error(h: ArrayLike, S: ArrayLike) -> Array:
    """Squared Mahalanobis distance e = h^T S^-1 h, of shape (...).

    The negative log density is e / 2 up to a constant; GTSAM's ``error`` is that half.
    """
    return np.sum(np.square(whiten(h, S)), axis=-1)


def _blocks(A: Array, B: Array, C: Array) -> Array:
    batch = np.broadcast_shapes(A.shape[:-2], B.shape[:-2], C.shape[:-2])
    n, m = A.shape[-1], B.shape[-1]
    whole = np.zeros((*batch, n + m, n + m))
    whole[..., :n, :n], whole[..., n:, n:] = A, B
    whole[..., :n, n:], whole[..., n:, :n] = C, np.swapaxes(C, -1, -2)
    return whole


def _place(bad: NDArray[np.bool_]) -> tuple[int, ...]:
    """Index of the first entry that is bad."""
    return tuple(int(k) for k in np.argwhere(bad)[0])


def _element(name: str, index: tuple[Any, ...]) -> str:
    return f"{name}{list(index)}" if index else name


def _cure(array: Array, n: int | None, name: str) -> str:
    if n is not None and array.shape[-1:] == (n * n,) and n > 1:
        return f"reshape it: np.reshape({name}, {(*array.shape[:-1], n, n)})"
    if n is not None and array.shape[-1:] == (n,) and array.ndim == 1:
        return "of standard deviations make np.diag(sigmas**2), of variances np.diag(variances)"
    if n is not None and array.ndim >= 2 and array.shape[-1] == array.shape[-2]:
        return f"the tangent space has dimension {n}: check which group it belongs to"
    return "a covariance is a square matrix"
