"""Sophus by sophuspy: residuals, logarithms and exponentials; it has no Jacobians in Python."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .contract import (
    SWAPPED,
    Array,
    Evaluate,
    Operation,
    Order,
    Peer,
    doubles,
    quaternion,
    rotation_matrix,
    vector,
    version_of,
)


def load() -> Peer:
    """The installed sophuspy. Raises ImportError where there is none, or where it cannot run."""
    version = version_of("sophuspy")
    if np.__version__ >= "2":
        raise ImportError(f"sophuspy {version} crashes with NumPy 2; this is NumPy {np.__version__}")
    sophus: Any = importlib.import_module("sophuspy")
    found: list[Operation] = []
    for name, group, make, back, order in (
        ("so3", sophus.SO3, rotation_matrix, quaternion, (0, 1, 2)),
        ("se3", sophus.SE3, _pose, _pose_back, SWAPPED),
        ("se2", sophus.SE2, _plane, _plane_back, (0, 1, 2)),
    ):
        found += _operations(group, name, make, back, np.array(order))
    return Peer("sophuspy", version, "elements given as matrices; no Jacobians", tuple(found))


def _operations(
    group: Any, name: str, make: Callable[[Array], Array], back: Callable[[Array], Array], order: Order
) -> list[Operation]:
    def between(a: Mapping[str, Array]) -> Mapping[str, Array]:
        x, y, z = (group(make(a[n])) for n in ("x", "y", "z"))
        return {"res": vector((z.inverse() * (x.inverse() * y)).log())[order]}

    def log(a: Mapping[str, Array]) -> Mapping[str, Array]:
        return {"out": vector(group(make(a["x"])).log())[order]}

    def exp(a: Mapping[str, Array]) -> Mapping[str, Array]:
        return {"out": back(doubles(group.exp(a["d"][order]).matrix()))}

    rules: dict[str, Evaluate] = {f"between_{name}": between, f"{name}_log": log, f"{name}_exp": exp}
    return [Operation(function, "gtsam", rule) for function, rule in rules.items()]


def _pose(x: Array) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_matrix(x[:4]), x[4:]
    return T


def _pose_back(T: Array) -> Array:
    return np.array([*quaternion(T[:3, :3]), *T[:3, 3]])


def _plane(x: Array) -> Array:
    c, s, u, v = x
    return np.array([[c, -s, u], [s, c, v], [0.0, 0.0, 1.0]])


def _plane_back(T: Array) -> Array:
    return np.array([T[0, 0], T[1, 0], T[0, 2], T[1, 2]])
