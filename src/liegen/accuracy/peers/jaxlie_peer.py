"""jaxlie in float64: forward-mode differentiation on the manifold, and its own ``jlog``."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .contract import SWAPPED, Array, Evaluate, Operation, Peer, version_of


def load() -> Peer:
    """The installed jaxlie. Raises ImportError where there is none. Switches JAX to 64 bits."""
    jaxlie: Any = importlib.import_module("jaxlie")
    jax: Any = importlib.import_module("jax")
    jax.config.update("jax_enable_x64", True)
    found: list[Operation] = []
    for name, group, stored, order in (
        ("so3", jaxlie.SO3, (3, 0, 1, 2), (0, 1, 2)),
        ("se3", jaxlie.SE3, (3, 0, 1, 2, 4, 5, 6), SWAPPED),
        ("se2", jaxlie.SE2, (0, 1, 2, 3), (0, 1, 2)),
    ):
        found += _operations(jax, jaxlie.manifold, group, name, np.array(stored), np.array(order))
    return Peer(
        "jaxlie", version_of("jaxlie"), "float64; jax.jacfwd of the residual, jlog for log", tuple(found)
    )


def _operations(
    jax: Any, manifold: Any, group: Any, name: str, stored: Array, order: Array
) -> list[Operation]:
    """``stored`` and ``order`` take liegen's storage and tangent to jaxlie's; tangents are swapped back alike."""
    zero = np.zeros(group.tangent_dim)

    def residual(x: Any, y: Any, z: Any, d: Any, e: Any) -> Any:
        left, right = (group(v) for v in (x, y))
        between = manifold.rplus(left, d).inverse() @ manifold.rplus(right, e)
        return (group(z).inverse() @ between).log()

    def moved(d: Any, e: Any) -> Any:
        return manifold.rminus(group.exp(d), group.exp(d + e))

    value = jax.jit(lambda x, y, z: residual(x, y, z, zero, zero))
    slopes = jax.jit(jax.jacfwd(residual, argnums=(3, 4)))
    log, jlog = jax.jit(lambda x: group(x).log()), jax.jit(lambda x: group(x).jlog())
    exp, slope = jax.jit(lambda d: group.exp(d).parameters()), jax.jit(jax.jacfwd(moved, argnums=1))
    inverse = jax.jit(lambda d: group.exp(d).jlog())

    def tangent(v: Any) -> Array:
        return np.asarray(v)[order]

    def both(J: Any) -> Array:
        return np.asarray(J)[np.ix_(order, order)]

    def between(a: Mapping[str, Array]) -> Mapping[str, Array]:
        xyz = [a[n][stored] for n in ("x", "y", "z")]
        by_x, by_y = slopes(*xyz, zero, zero)
        return {"res": tangent(value(*xyz)), "res_D_x": both(by_x), "res_D_y": both(by_y)}

    def logarithm(a: Mapping[str, Array]) -> Mapping[str, Array]:
        x = a["x"][stored]
        return {"out": tangent(log(x)), "out_D_x": both(jlog(x))}

    def exponential(a: Mapping[str, Array]) -> Mapping[str, Array]:
        d = a["d"][order]
        coords = np.empty(len(stored))
        coords[stored] = np.asarray(exp(d))
        return {"out": coords, "out_D_d": both(slope(d, zero))}

    def inverse_jacobian(a: Mapping[str, Array]) -> Mapping[str, Array]:
        return {"out": both(inverse(a["d"][order]))}

    rules: dict[str, Callable[..., Any]] = {
        f"between_{name}": between,
        f"{name}_log": logarithm,
        f"{name}_exp": exponential,
        f"{name}_Jr_inv": inverse_jacobian,
    }
    return [Operation(function, "gtsam", _checked(rule)) for function, rule in rules.items()]


def _checked(rule: Evaluate) -> Evaluate:
    """With writable double-precision copies."""
    return lambda a: {name: np.array(v, dtype=np.float64) for name, v in rule(a).items()}
