"""C++ that SymForce generates: from its own geometry, and from liegen's closed forms."""

from __future__ import annotations

import importlib
import importlib.metadata
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from liegen.algebra import Algebra
from liegen.manifolds import ManifoldForm

from .operations import counted
from .programs import EIGEN_OPTIONS, FORMS, Rows, closed_forms, eigen_wrapper, finished, prototype
from .symforce_formulas import FORMULAS
from .variant import AbsentError, Task, Variant, fastest

NAME = "SymForce"
SYMBOL = "symforce_call"
#: Its two ways to tangent-space Jacobians.
JACOBIANS = {"chain rule": "tangent_jacobians_chain_rule", "first order": "tangent_jacobians_first_order"}
Outputs = Callable[[Mapping[str, Any]], Rows]


def _module(name: str) -> Any:
    try:
        symforce: Any = importlib.import_module("symforce")
        symforce.set_epsilon_to_number()  # 2.2e-15, its number for double precision
        return importlib.import_module(f"symforce.{name}")
    except ImportError as error:
        raise AbsentError(f"SymForce is not installed ({error})") from None


def variants(task: Task) -> tuple[Variant, ...]:
    """Its own formulation by both of its differentiations, and liegen's closed forms."""
    sf = _module("symbolic")
    forms = _variant(task, sf, FORMS, lambda given: _closed(task, sf, given))
    if not (task.published and task.function.name in FORMULAS):
        return (forms,)
    own = [
        _variant(
            task, sf, note, lambda given, how=how: finished(task, _derived(task, sf, how, given), sf.Matrix)
        )
        for note, how in JACOBIANS.items()
    ]
    return (*own, forms)


def _variant(task: Task, sf: Any, note: str, outputs: Outputs) -> Variant:
    inputs = {p.name: sf.matrix_type_from_shape((p.size, 1)).symbolic(p.name) for p in task.inputs}
    text, seconds = fastest(lambda: _generated(task, sf, inputs, outputs(inputs)))
    everything = frozenset(port.name for port in task.outputs)
    name = re.search(r"^void (\w+)\(", text, re.MULTILINE)  # its own spelling of the task's name
    files = eigen_wrapper(task, SYMBOL, f"sym::{name[1] if name else task.name}", "generated.h", everything)
    return Variant(
        NAME, importlib.metadata.version("symforce"), note, prototype(SYMBOL), (f"{SYMBOL}(a, b);",),
        {"generated.h": text, **files}, counted(text), seconds, column_major=True, options=EIGEN_OPTIONS,
        borrowed=note == FORMS,
    )  # fmt: skip


def _generated(task: Task, sf: Any, inputs: Mapping[str, Any], rows: Rows) -> str:
    codegen, values = _module("codegen"), _module("values")
    outputs = values.Values(**{name: sf.Matrix(block) for name, block in rows.items()})
    config = codegen.CppConfig()
    generator = codegen.Codegen(
        inputs=values.Values(**inputs), outputs=outputs, config=config, name=task.name
    )
    with tempfile.TemporaryDirectory() as folder:
        generator.generate_function(output_dir=folder, skip_directory_nesting=True)
        return Path(folder, f"{task.name}.h").read_text(encoding="utf-8")


def _lifted(sf: Any, form: ManifoldForm, entries: Sequence[Any]) -> Any:
    """The element of SymForce with this storage; a list for a product."""
    if form.parts:
        found: list[Any] = []
        start = 0
        for part in form.parts:
            found.append(_lifted(sf, part, entries[start : start + part.size]))
            start += part.size
        return found
    if form.name == "SO3":
        return sf.Rot3.from_storage(list(entries))
    if form.name in POSES:
        module, name = POSES[form.name]
        return getattr(_module(module), name).from_storage(list(entries))
    return sf.Matrix(list(entries))


#: Poses with the exponential map of the whole group, and where they are.
POSES: Mapping[str, tuple[str, str]] = {
    "SE3": ("geo.unsupported.pose3_se3", "Pose3_SE3"),
    "SE2": ("geo.unsupported.pose2_se2", "Pose2_SE2"),
}


def _derived(task: Task, sf: Any, how: str, given: Mapping[str, Any]) -> Rows:
    """The value, and its Jacobians in tangent spaces as SymForce derives them."""
    graph = task.function.graph
    derive = getattr(_module("jacobian_helpers"), how)
    elements = {p.name: _lifted(sf, p.manifold.form, list(given[p.name])) for p in graph.parameters}
    result = FORMULAS[task.function.name](**elements)
    ((name, _),) = graph.outputs
    found: dict[str, Any] = {name: [[entry] for part in result for entry in part.to_storage()]}
    for p in graph.parameters:
        if p.variable:
            argument = elements[p.name]
            parts = argument if p.manifold.form.parts else [argument]
            blocks = [derive(part, parts) for part in result]
            rows = [
                [entry for block in row for entry in block[k, :]]
                for row in blocks
                for k in range(row[0].shape[0])
            ]
            order = ORDERS.get(p.manifold.form.name)
            found[f"{name}_D_{p.name}"] = [[row[k] for k in order] for row in rows] if order else rows
    return found


#: Where SymForce's tangent has another order.
ORDERS: Mapping[str, Sequence[int]] = {"SE2": (1, 2, 0)}


def _closed(task: Task, sf: Any, given: Mapping[str, Any]) -> Rows:
    return closed_forms(task, {name: list(x) for name, x in given.items()}, _algebra(sf))


def _algebra(sf: Any) -> Algebra:
    """liegen's functions on SymForce's scalars, which know no branches: conditions are 0 or 1."""

    def atan2(y: Any, x: Any) -> Any:
        return sf.atan2(y, x, epsilon=0)

    def both(a: Any, b: Any) -> Any:
        return a * b

    def either(a: Any, b: Any) -> Any:
        return a + b - a * b

    def negated(a: Any) -> Any:
        return 1 - a

    def select(condition: Any, a: Any, b: Any) -> Any:
        return condition * a + (1 - condition) * b

    names = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log")
    functions = {name: getattr(sf, name) for name in names}
    more = {
        "abs": sf.Abs, "atan2": atan2, "lt": sf.less, "le": sf.less_equal,
        "and": both, "or": either, "not": negated, "select": select,
    }  # fmt: skip
    return Algebra("symforce", False, {**functions, **more}, sf.S)
