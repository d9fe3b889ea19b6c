"""Covariances of the inverse, of a product, of a relative pose, and seen from another frame.

All follow from T Exp(n) = Exp(Ad_T n) T (micro Lie, eq. 29-32).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from liegen.errors import UncertaintyError
from liegen.manifolds import Group
from liegen.manifolds.node import here

from .covariance import Array, covariance, joint, through


def adjoint(T: Group, name: str) -> Array:
    """Ad_T of shape (..., n, n). Raises UncertaintyError for values that are no group elements."""
    if not isinstance(T, Group):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise UncertaintyError(
            f"{here()}: {name} must be an element of a Lie group (SO2, SE2, SO3, SE3, R1 ...), "
            f"got a {type(T).__name__}"  # pyright: ignore[reportUnreachable]
        )
    matrix = np.asarray(T.adjoint(), dtype=np.float64)
    return np.broadcast_to(matrix, (*np.asarray(T).shape[:-1], *matrix.shape[-2:]))


def adjoint_inverse(T: Group, name: str) -> Array:
    """Ad of T^-1, likewise."""
    dimension(T, name)
    return adjoint(T.inverse(), name)


def dimension(T: Group, name: str) -> int:
    """n, the dimension of T's tangent space; likewise."""
    return adjoint(T, name).shape[-1]


def body_to_world(T: Group, S: ArrayLike) -> Array:
    """Ad_T S Ad_T^T: of n_W in Exp(n_W) T, from the covariance S of n_B in T Exp(n_B).

    T_WB has shape (...), S (..., n, n). Right (body) perturbations to left (world) ones; exact, no
    linearisation (micro Lie, "Uncertainty in manifolds": global perturbations). The translation part of n_W
    is the velocity, over a unit time, of the point that sits at the world's origin, not of the body; for
    position errors along the world's axes see ``to_ros``.
    """
    A = adjoint(T, "T")
    return through(A, covariance(S, T.form.dim))


def world_to_body(T: Group, S: ArrayLike) -> Array:
    """Ad_T^-1 S Ad_T^-T: inverse of ``body_to_world``.

    With an exactly known extrinsic T_BC it also takes the covariance of T_WB, in the frame of B, to that of
    T_WB T_BC, in the frame of C.
    """
    return through(adjoint_inverse(T, "T"), covariance(S, T.form.dim))


def of_inverse(T: Group, S: ArrayLike) -> Array:
    """Covariance of T^-1, in its own body frame: Ad_T S Ad_T^T.

    S (..., n, n) is the covariance of T, in the body frame of T. Exact: (T Exp(n))^-1 = T^-1 Exp(-Ad_T n)
    (Mangelson et al. 2020, pose inverse). The same matrix as ``body_to_world``: T_WB^-1 has W as its body.
    """
    return body_to_world(T, S)


def of_compose(T12: Group, S1: ArrayLike, S12: ArrayLike, cross: ArrayLike | None = None) -> Array:
    """Covariance of T1 T12, in its body frame: A S1 A^T + S12 + A C + C^T A^T with A = Ad(T12^-1).

    S1 is the covariance of T1 in the body frame of T1, S12 that of T12 in its body frame, both (..., n, n);
    ``cross`` is C = E[n1 n12^T], None when both are independent (odometry). T1 itself does not matter.
    First order: T1 Exp(n1) T12 Exp(n12) = T1 T12 Exp(A n1) Exp(n12) (Barfoot & Furgale 2014, compounding;
    Mangelson et al. 2020, pose composition).
    """
    n = dimension(T12, "T12")
    return _of_two(T12, 1.0, joint(covariance(S1, n, "S1"), covariance(S12, n, "S12"), cross))


def of_between(T12: Group, S: ArrayLike) -> Array:
    """Covariance of T12 = T1^-1 T2, in its body frame.

    A S11 A^T + S22 - A S12 - S12^T A^T with A = Ad(T12^-1). S (..., 2n, 2n) is the joint covariance of (T1,
    T2), each in its own body frame; from blocks: ``joint(S11, S22, S12)``. Poses of one trajectory are
    strongly correlated: with the cross terms left out the result is too large, often by far (Mangelson et
    al. 2020, relative pose). First order: (T1 Exp(n1))^-1 T2 Exp(n2) = T12 Exp(-A n1) Exp(n2).
    """
    return _of_two(
        T12, -1.0, covariance(S, 2 * dimension(T12, "T12"), "the joint covariance S of both poses")
    )


def _of_two(T12: Group, sign: float, S: Array) -> Array:
    A = sign * adjoint_inverse(T12, "T12")
    return through(np.concatenate([A, np.broadcast_to(np.eye(A.shape[-1]), A.shape)], axis=-1), S)
