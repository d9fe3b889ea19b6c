"""SymForce: Python code generated from its symbolic groups with its own epsilon, Jacobians included."""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Callable, Mapping
from typing import Any

from .contract import Array, Evaluate, Operation, Peer, doubles, vector, version_of


def load() -> Peer:
    """The installed SymForce. Raises ImportError where there is none. Generates code: some seconds."""
    symforce: Any = importlib.import_module("symforce")
    symforce.set_epsilon_to_symbol()
    sf: Any = importlib.import_module("symforce.symbolic")
    sym: Any = importlib.import_module("sym")
    epsilon = float(sf.numeric_epsilon)
    found: list[Operation] = []
    for name, cls, group, size in (
        ("so3", sf.Rot3, sym.Rot3, 3),
        ("se3", sf.Pose3, sym.Pose3, 6),
        ("se2", sf.Pose2, sym.Pose2, 3),
    ):
        between = _generated(_between_formula(sf, cls, size), f"liegen_between_{name}", ("x", "y"))
        found.append(Operation(f"between_{name}", "symforce", _between(between, group, epsilon)))
    log = _generated(_log_formula(sf), "liegen_log_so3", ("x",))
    found += [
        Operation("so3_log", "symforce", _log(log, sym.Rot3, epsilon)),
        Operation("so3_exp", "symforce", _exp(sym.Rot3, epsilon)),
    ]
    note = f"generated Python, epsilon {epsilon:.1e}; its poses have no exponential of their group"
    return Peer("symforce", version_of("symforce"), note, tuple(found))


def _between_formula(sf: Any, cls: Any, size: int) -> Callable[..., Any]:
    def formula(x: Any, y: Any, z: Any, epsilon: Any) -> Any:
        return sf.Matrix(z.local_coordinates(x.between(y), epsilon=epsilon))

    vector = {3: sf.V3, 6: sf.V6}[size]
    formula.__annotations__ = {"x": cls, "y": cls, "z": cls, "epsilon": sf.Scalar, "return": vector}
    return formula


def _log_formula(sf: Any) -> Callable[..., Any]:
    def formula(x: Any, epsilon: Any) -> Any:
        return sf.Matrix(x.to_tangent(epsilon=epsilon))

    formula.__annotations__ = {"x": sf.Rot3, "epsilon": sf.Scalar, "return": sf.V3}
    return formula


def _generated(formula: Callable[..., Any], name: str, variables: tuple[str, ...]) -> Callable[..., Any]:
    """The generated function: (value, Jacobian by each variable)."""
    codegen: Any = importlib.import_module("symforce.codegen")
    util: Any = importlib.import_module("symforce.codegen.codegen_util")
    plain = codegen.Codegen.function(formula, config=codegen.PythonConfig(), name=name)
    whole = plain.with_jacobians(which_args=list(variables), include_results=True)
    with tempfile.TemporaryDirectory() as folder:
        written = whole.generate_function(output_dir=folder)
        return util.load_generated_function(whole.name, written.function_dir)


def _between(function: Callable[..., Any], group: Any, epsilon: float) -> Evaluate:
    def evaluate(a: Mapping[str, Array]) -> Mapping[str, Array]:
        x, y, z = (group.from_storage(a[n].tolist()) for n in ("x", "y", "z"))
        res, by_x, by_y = function(x, y, z, epsilon)
        return {"res": vector(res), "res_D_x": doubles(by_x), "res_D_y": doubles(by_y)}

    return evaluate


def _log(function: Callable[..., Any], group: Any, epsilon: float) -> Evaluate:
    def evaluate(a: Mapping[str, Array]) -> Mapping[str, Array]:
        value, slope = function(group.from_storage(a["x"].tolist()), epsilon)
        return {"out": vector(value), "out_D_x": doubles(slope)}

    return evaluate


def _exp(group: Any, epsilon: float) -> Evaluate:
    return lambda a: {"out": doubles(group.from_tangent(a["d"], epsilon).to_storage())}
