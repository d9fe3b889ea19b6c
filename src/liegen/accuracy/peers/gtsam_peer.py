"""GTSAM: the between factors as it linearises them, Logmap and Expmap with their Jacobians."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .contract import Array, Evaluate, Operation, Peer, version_of


def load() -> Peer:
    """The installed GTSAM. Raises ImportError where there is none."""
    gtsam: Any = importlib.import_module("gtsam")
    version = version_of("gtsam")
    preset = "gtsam-4.2" if version.startswith("4.2") else "gtsam"
    groups = {
        "so3": (gtsam.Rot3, gtsam.BetweenFactorRot3, _so3(gtsam), _so3_back),
        "se3": (gtsam.Pose3, gtsam.BetweenFactorPose3, _se3(gtsam), _se3_back),
        "se2": (gtsam.Pose2, gtsam.BetweenFactorPose2, _se2(gtsam), _se2_back),
    }
    found: list[Operation] = []
    for name, (group, between, make, back) in groups.items():
        found += [
            Operation(f"between_{name}", preset, _between(gtsam, between, make)),
            Operation(f"{name}_log", "gtsam", _with_jacobian(group.Logmap, make, np.asarray, "x")),
            Operation(f"{name}_exp", "gtsam", _with_jacobian(group.Expmap, np.asarray, back, "d")),
            *_derivatives(group, name),
        ]
    return Peer("gtsam", version, "rotations as matrices, as in its wheel", tuple(found))


def _derivatives(group: Any, name: str) -> list[Operation]:
    methods = {"Jr": "ExpmapDerivative", "Jr_inv": "LogmapDerivative"}
    present = {ours: getattr(group, theirs, None) for ours, theirs in methods.items()}
    return [
        Operation(f"{name}_{ours}", "gtsam", _of_vector(method))
        for ours, method in present.items()
        if method and _takes(method, np.zeros(6 if name == "se3" else 3))
    ]


def _takes(method: Callable[..., Any], *arguments: Any) -> bool:
    """Versions differ in what their Python wrappers accept."""
    try:
        method(*arguments)
    except TypeError:
        return False
    return True


def _of_vector(method: Callable[[Array], Array]) -> Evaluate:
    return lambda a: {"out": method(a["d"])}


def _with_jacobian(
    function: Callable[..., Any],
    make: Callable[[Array], Any],
    back: Callable[[Any], Array],
    argument: str,
) -> Evaluate:
    """``function(x, H)`` fills H, where the wrapper has it."""

    def evaluate(a: Mapping[str, Array]) -> Mapping[str, Array]:
        n = 6 if len(a[argument]) > 4 else 3
        element, H = make(a[argument]), np.zeros((n, n), order="F")
        if not _takes(function, element, H):
            return {"out": back(function(element))}
        return {"out": back(function(element, H)), f"out_D_{argument}": H}

    return evaluate


def _between(gtsam: Any, factor: Any, make: Callable[[Array], Any]) -> Evaluate:
    def evaluate(a: Mapping[str, Array]) -> Mapping[str, Array]:
        n = 6 if len(a["x"]) == 7 else 3
        values = gtsam.Values()
        values.insert(0, make(a["x"]))
        values.insert(1, make(a["y"]))
        noise = gtsam.noiseModel.Unit.Create(n)
        A, b = factor(0, 1, make(a["z"]), noise).linearize(values).jacobian()
        return {"res": -b, "res_D_x": A[:, :n], "res_D_y": A[:, n:]}

    return evaluate


def _so3(gtsam: Any) -> Callable[[Array], Any]:
    return lambda q: gtsam.Rot3.Quaternion(q[3], q[0], q[1], q[2])


def _so3_back(R: Any) -> Array:
    q = R.toQuaternion()
    return np.array([q.x(), q.y(), q.z(), q.w()])


def _se3(gtsam: Any) -> Callable[[Array], Any]:
    rotation = _so3(gtsam)
    return lambda x: gtsam.Pose3(rotation(x[:4]), x[4:])


def _se3_back(T: Any) -> Array:
    return np.array([*_so3_back(T.rotation()), *np.ravel(T.translation())])


def _se2(gtsam: Any) -> Callable[[Array], Any]:
    return lambda x: gtsam.Pose2(gtsam.Rot2.fromCosSin(x[0], x[1]), x[2:])


def _se2_back(T: Any) -> Array:
    r = T.rotation()
    return np.array([r.c(), r.s(), T.x(), T.y()])
