"""Order of the tangent's coordinates, and the covariances of ROS messages."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.errors import UncertaintyError
from liegen.manifolds import SE3, Group
from liegen.manifolds.form import PoseForm
from liegen.manifolds.node import here
from liegen.manifolds.similarity_form import SimilarityForm

from .covariance import Array, covariance, through

Order = Literal["rotation-first", "translation-first"]


def to_order(G: type[Group], S: ArrayLike, order: Order) -> Array:
    """S (..., n, n) of the group G, rows and columns taken from liegen's order to ``order``.

    G is SE2, SE3, Sim2 or Sim3. liegen's order is that of GTSAM: SE3 and Sim3 rotation first, SE2 and Sim2
    translation first; the logarithm of a scale stays last, as in Sophus.
    """
    p = permutation(G, order)
    return covariance(S, len(p))[..., p[:, None], p]


def from_order(G: type[Group], S: ArrayLike, order: Order) -> Array:
    """S (..., n, n) of the group G, rows and columns taken from ``order`` to liegen's order."""
    p = np.argsort(permutation(G, order))
    return covariance(S, len(p))[..., p[:, None], p]


def from_ros(T: SE3, S: ArrayLike) -> Array:
    """The body-frame covariance (liegen's and GTSAM's) of a ``geometry_msgs/PoseWithCovariance``.

    ``T`` is the message's pose, T_FB with F the frame of ``header.frame_id``; S (..., 6, 6) is its
    covariance, ``np.reshape(msg.covariance, (6, 6))``, in the order x, y, z [m], rotation about X, Y, Z
    [rad].

    Assumed definition: both errors are along the *fixed axes of F*, the position's is added, the rotation's
    turns the body about its own origin:

        p_true = p + dp,    R_true = Exp(dtheta) R,    S = covariance of (dp, dtheta)

    so n = (R^T dtheta, R^T dp) in T Exp(n), rotation first. To first order small turns about X, Y, Z in any
    sequence are the rotation vector dtheta. The message's comment only says "fixed axis"; publishers that
    fill in variances of roll, pitch and yaw of the whole orientation agree with this only near roll = pitch
    = 0. A ``TwistWithCovariance`` is in the axes of the child frame: ``from_order(SE3, S,
    "translation-first")``.
    """
    return through(_ros_map(T), covariance(S, 6))


def to_ros(T: SE3, S: ArrayLike) -> Array:
    """The covariance for a ``geometry_msgs/PoseWithCovariance``; inverse of ``from_ros``, same definition."""
    return through(np.swapaxes(_ros_map(T), -1, -2), covariance(S, 6))


def _ros_map(T: SE3) -> Array:
    """M with n = M (dp, dtheta); orthogonal."""
    if not isinstance(T, SE3):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise UncertaintyError(
            f"{here()}: the pose of a PoseWithCovariance must be SE3, got a {type(T).__name__}"  # pyright: ignore[reportUnreachable]
        )
    R: NDArray[Any] = T.rotation.matrix()
    M = np.zeros((*R.shape[:-2], 6, 6))
    M[..., :3, 3:] = M[..., 3:, :3] = np.swapaxes(R, -1, -2)
    return M


def permutation(G: type[Group], order: Order) -> NDArray[np.intp]:
    """Positions in liegen's order of the coordinates listed in ``order``."""
    form = G.form
    if not isinstance(form, PoseForm | SimilarityForm):
        raise UncertaintyError(
            f"{here()}: {G.__name__} has no rotation and translation to reorder; "
            "give a pose group, SE2 or SE3, or Sim2 or Sim3"
        )
    turns, moves, n = form.rotation.dim, form.rotation.space, form.dim
    start = 0 if form.rotation_first else moves
    rotation = np.arange(start, start + turns)
    translation = np.setdiff1d(np.arange(turns + moves), rotation)
    scale = np.arange(turns + moves, n)
    orders = {
        "rotation-first": (rotation, translation, scale),
        "translation-first": (translation, rotation, scale),
    }
    if order not in orders:
        raise UncertaintyError(f"{here()}: unknown order {order!r}; one of {', '.join(orders)}")
    return np.concatenate(orders[order])
