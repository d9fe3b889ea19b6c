"""Samples of an uncertain element, and the covariance that measurements leave."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from liegen.errors import UncertaintyError
from liegen.manifolds import Group
from liegen.manifolds.group import tangent_class
from liegen.manifolds.node import here

from .covariance import Array, covariance, definite, numbers, square
from .covariance import sqrt_info as root_of
from .transport import adjoint

G = TypeVar("G", bound=Group)
#: Relative singular value, columns scaled, below which a direction counts as not measured: rounding makes
#: zeros of about 1e-16, and its variance would be 1e24 times that of the best direction.
RANK = 1e-12


def sample(z: G, S: ArrayLike, rng: np.random.Generator, size: int | tuple[int, ...] = ()) -> G:
    """Samples z Exp(n), n ~ N(0, S): S in the body frame of z.

    z has shape (...), S (..., n, n); the result has shape (*size, ...). In the between factor's frames:
    ``x2 = x1 @ sample(z, S, rng)``.
    """
    adjoint(z, "z")
    if not isinstance(rng, np.random.Generator):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise UncertaintyError(
            f"{here()}: rng must be a generator, np.random.default_rng(seed), got a {type(rng).__name__}"  # pyright: ignore[reportUnreachable]
        )
    n = z.form.dim
    root = _root(covariance(S, n))
    batch = np.broadcast_shapes(np.asarray(z).shape[:-1], root.shape[:-2])
    extra = (size,) if isinstance(size, int) else tuple(size)
    noise = root @ rng.standard_normal((*extra, *batch, n, 1))
    return z.compose(type(z).exp(tangent_class(n).from_storage(noise[..., 0])))


def _root(S: Array) -> Array:
    """A square root B with B B^T = S, also where S is only semidefinite: scaled, so that units may differ."""
    deviation: Array = np.sqrt(np.maximum(np.diagonal(S, axis1=-2, axis2=-1), 0.0))
    try:
        return np.linalg.cholesky(S).astype(np.float64, copy=False)
    except np.linalg.LinAlgError:
        unit = np.where(deviation > 0, deviation, 1.0)
        values, vectors = np.linalg.eigh(S / unit[..., :, None] / unit[..., None, :])
        sizes: Array = np.sqrt(np.maximum(values, 0.0))
        return deviation[..., None] * vectors * sizes[..., None, :]


def posterior(A: ArrayLike, S: ArrayLike | None = None, *, sqrt_info: ArrayLike | None = None) -> Array:
    """(A^T S^-1 A)^-1: covariance of the estimate, in its tangent space, body frame.

    A (..., m, n) stacks the Jacobians of the residuals by the variable (or by several, side by side), taken
    at the estimate x; S (..., m, m) is the covariance of the stacked measurements (``block_diagonal``),
    each in the frame of its measurement. Or give ``sqrt_info``, a square root R (m, m) with R^T R = S^-1.
    The estimate is x Exp(n) with n ~ N(0, result), of shape (..., n, n). To first order: exact for linear
    residuals.

    Raises UncertaintyError when the measurements leave a direction free. Solved by QR of R A, not by forming
    A^T S^-1 A.
    """
    rows = numbers(A, "A")
    if rows.ndim < 2 or rows.shape[-1] == 0:
        raise UncertaintyError(f"{here()}: A must have the shape (..., m, n), this one has {rows.shape}")
    m, n = rows.shape[-2:]
    if (S is None) == (sqrt_info is None):
        raise UncertaintyError(f"{here()}: posterior(A, S) or posterior(A, sqrt_info=R): give one of both")
    R = (
        square(sqrt_info, m, "sqrt_info")
        if sqrt_info is not None
        else root_of(definite([] if S is None else S, m))
    )
    B = R @ rows
    _need_rank(B, m, n)
    T = np.linalg.inv(np.linalg.qr(B, mode="r"))
    result = T @ np.swapaxes(T, -1, -2)
    return (result + np.swapaxes(result, -1, -2)) / 2


def _need_rank(B: Array, m: int, n: int) -> None:
    scale = np.linalg.norm(B, axis=-2, keepdims=True)
    columns = B / np.where(scale > 0, scale, 1.0)
    _, values, directions = np.linalg.svd(columns)
    values = values.reshape(-1, values.shape[-1])
    free = [n - min(m, n) + int(np.sum(v <= RANK * v[0])) for v in values]
    worst = int(np.argmax(free))
    if free[worst]:
        v = directions.reshape(-1, n, n)[worst, -1] / np.where(scale > 0, scale, 1.0).reshape(-1, n)[worst]
        text = ", ".join(f"{x:.3g}" for x in v / np.max(np.abs(v)))
        raise UncertaintyError(
            f"{here()}: the measurements leave {free[worst]} of {n} directions free, among them ({text}); "
            "add a prior or a measurement that sees it"
        )
