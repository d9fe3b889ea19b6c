"""jaxlie under ``jit(vmap)``: the between factor of SE(3) with both Jacobians, for a batch at once."""

from __future__ import annotations

import importlib
import importlib.metadata
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .variant import AbsentError

Array = NDArray[np.float64]
#: Its tangent is translation, rotation.
ORDER = [3, 4, 5, 0, 1, 2]


def between_batch() -> Callable[[Array, Array, Array], tuple[Array, Array, Array]]:
    """A function of stored poses (n, 7) that gives residuals (n, 6) and Jacobians (n, 6, 6) twice.

    Right perturbations by its forward differentiation, in double precision. Raises AbsentError.
    """
    try:
        jax: Any = importlib.import_module("jax")
        jaxlie: Any = importlib.import_module("jaxlie")
    except ImportError as error:
        raise AbsentError(f"jaxlie is not installed ({error})") from None
    jax.config.update("jax_enable_x64", True)
    zero = jax.numpy.zeros(6)

    def pose(x: Any) -> Any:
        return jaxlie.SE3(jax.numpy.concatenate([x[3:4], x[:3], x[4:]]))

    def residual(d: Any, e: Any, x: Any, y: Any, z: Any) -> Any:
        moved = pose(x) @ jaxlie.SE3.exp(d), pose(y) @ jaxlie.SE3.exp(e)
        return (pose(z).inverse() @ moved[0].inverse() @ moved[1]).log()

    def one(x: Any, y: Any, z: Any) -> Any:
        D_x, D_y = jax.jacfwd(residual, argnums=(0, 1))(zero, zero, x, y, z)
        return residual(zero, zero, x, y, z), D_x, D_y

    mapped = jax.jit(jax.vmap(one))

    def batch(x: Array, y: Array, z: Array) -> tuple[Array, Array, Array]:
        res, D_x, D_y = jax.block_until_ready(mapped(x, y, z))
        return res, D_x, D_y

    return batch


def in_order(res: Array, D_x: Array, D_y: Array) -> tuple[Array, Array, Array]:
    """The same with rotation first."""
    rows = np.ix_(ORDER, ORDER)
    return np.asarray(res)[:, ORDER], np.asarray(D_x)[:, *rows], np.asarray(D_y)[:, *rows]


def version() -> str:
    """Of jaxlie and of jax. Raises AbsentError."""
    try:
        return f"{importlib.metadata.version('jaxlie')} (jax {importlib.metadata.version('jax')})"
    except importlib.metadata.PackageNotFoundError as error:
        raise AbsentError(f"jaxlie is not installed ({error})") from None
