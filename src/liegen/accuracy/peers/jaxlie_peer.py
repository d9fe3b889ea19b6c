"""jaxlie in float64: forward-mode differentiation on the manifold, and its own ``jlog``."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from .contract import SWAPPED, Array, Evaluate, Operation, Order, Peer, doubles, version_of


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
    jax: Any, manifold: Any, group: Any, name: str, stored: Order, order: Order
) -> list[Operation]:
    """``stored`` and ``order`` take liegen's storage and tangent to jaxlie's; both orders are swaps."""
    zero = np.zeros(group.tangent_dim)

    def residual(x: Any, y: Any, z: Any, d: Any, e: Any) -> Any:
        left, right = (group(v) for v in (x, y))
        between = manifold.rplus(left, d).inverse() @ manifold.rplus(right, e)
        return (group(z).inverse() @ between).log()

    def moved(d: Any, e: Any) -> Any:
        return manifold.rminus(group.exp(d), group.exp(d + e))

    def at_rest(x: Any, y: Any, z: Any) -> Any:
        return residual(x, y, z, zero, zero)

    def logarithm_of(x: Any) -> Any:
        return group(x).log()

    def slope_of(x: Any) -> Any:
        return group(x).jlog()

    def stored_exponential(d: Any) -> Any:
        return group.exp(d).parameters()

    value = jax.jit(at_rest)
    slopes = jax.jit(jax.jacfwd(residual, argnums=(3, 4)))
    log, jlog = jax.jit(logarithm_of), jax.jit(slope_of)
    exp, slope = jax.jit(stored_exponential), jax.jit(jax.jacfwd(moved, argnums=1))

    def tangent(v: Any) -> Array:
        return doubles(v)[order]

    def both(J: Any) -> Array:
        return doubles(J)[np.ix_(order, order)]

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
        coords[stored] = doubles(exp(d))
        return {"out": coords, "out_D_d": both(slope(d, zero))}

    rules: dict[str, Evaluate] = {
        f"between_{name}": between,
        f"{name}_log": logarithm,
        f"{name}_exp": exponential,
    }
    return [Operation(function, "gtsam", rule) for function, rule in rules.items()]
