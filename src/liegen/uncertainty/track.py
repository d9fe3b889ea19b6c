"""Integration of body velocities, with the covariance that their errors leave."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from liegen.errors import UncertaintyError
from liegen.manifolds import Group
from liegen.manifolds.group import tangent_class
from liegen.manifolds.node import here

from .covariance import Array, covariance, numbers, through
from .transport import adjoint_inverse, dimension

G = TypeVar("G", bound=Group)


@dataclass(frozen=True)
class Track(Generic[G]):
    """A trajectory and its uncertainty.

    ``poses`` has shape (k + 1, ...), the start first; ``covariances`` (k + 1, ..., n, n), each in its
    pose's body frame, or None where no covariance was given.
    """

    poses: G
    covariances: Array | None


def dead_reckoning(
    T: G, twists: ArrayLike, dt: ArrayLike, *, start: ArrayLike | None = None, noise: ArrayLike | None = None
) -> Track[G]:
    """T <- T Exp(twist dt), k times: exact where the twist is constant over each step.

    ``twists`` (k, ..., n) are body velocities in the order of the tangent (SE3: angular [rad/s], then
    linear [m/s]; SE2: linear, then angular), ``dt`` [s] is one number or k. ``start`` (..., n, n) is the
    covariance of T in its body frame; None: exactly known, covariance 0. ``noise`` (n, n) or (k, ..., n, n)
    is the covariance of the twist's error, constant over a step and independent between steps [(rad/s)^2,
    (m/s)^2]; a white noise of density Q has Q / dt. None: no error.

    One step: S <- Ad(Exp(d)^-1) S Ad(Exp(d)^-1)^T + Jr(d) (noise dt^2) Jr(d)^T with d = twist dt
    (composition as in ``of_compose``; micro Lie, eq. 67 for Jr). First order in the errors.
    """
    n = dimension(T, "T")
    d = numbers(twists, "twists")
    if d.ndim < 2 or d.shape[-1] != n:
        raise UncertaintyError(
            f"{here()}: twists must have the shape (k, ..., {n}): {', '.join(T.form.tangent)} per second; "
            f"this one has {d.shape}"
        )
    times = _times(dt, len(d))
    d = d * times.reshape(-1, *([1] * (d.ndim - 1)))
    steps = [type(T).exp(tangent_class(n).from_storage(row)) for row in d]
    poses = [T]
    for step in steps:
        poses.append(poses[-1].compose(step))
    track = np.stack(np.broadcast_arrays(*[np.asarray(pose) for pose in poses]))
    if start is None and noise is None:
        return Track(type(T).from_storage(track), None)
    covariances = [np.zeros((n, n)) if start is None else covariance(start, n, "start")]
    spread = None if noise is None else covariance(noise, n, "noise")
    if spread is not None and spread.ndim > 2 and len(spread) != len(d):
        raise UncertaintyError(
            f"{here()}: noise must have the shape ({n}, {n}) or (k, ..., {n}, {n}) with k = {len(d)}, "
            f"this one has {spread.shape}"
        )
    for k, step in enumerate(steps):
        grown = through(adjoint_inverse(step, "T"), covariances[-1])
        if spread is not None:
            Jr = np.asarray(type(T).Jr(tangent_class(n).from_storage(d[k])), dtype=np.float64)
            grown = grown + through(Jr, (spread if spread.ndim == 2 else spread[k]) * times[k] ** 2)
        covariances.append(grown)
    shape = np.broadcast_shapes(covariances[-1].shape, (*track.shape[1:-1], n, n))
    return Track(type(T).from_storage(track), np.stack([np.broadcast_to(S, shape) for S in covariances]))


def _times(dt: ArrayLike, k: int) -> Array:
    times = numbers(dt, "dt")
    if times.shape not in ((), (k,)):
        raise UncertaintyError(
            f"{here()}: dt must be one number or {k}, one a twist; its shape is {times.shape}"
        )
    if np.any(times <= 0):
        raise UncertaintyError(f"{here()}: dt must be positive [s]")
    return np.broadcast_to(times, (k,))
