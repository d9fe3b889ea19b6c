"""C++ that wrenfold generates: from its own language, and from liegen's closed forms."""

from __future__ import annotations

import importlib
import importlib.metadata
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from liegen.algebra import Algebra
from liegen.manifolds import ManifoldForm

from .programs import EIGEN_OPTIONS, FORMS, Rows, closed_forms, eigen_wrapper, finished, prototype
from .variant import AbsentError, Task, Variant, fastest
from .wrenfold_formulas import FORMULAS

NAME = "wrenfold"
SYMBOL = "wrenfold_call"
#: Factoring passes that are tried; the program with the fewest operations is kept.
FACTORING = (0, 1, 3, 5)
Outputs = Callable[[Any, Mapping[str, Any]], Rows]


def _module(name: str) -> Any:
    try:
        return importlib.import_module(f"wrenfold.{name}")
    except ImportError as error:
        raise AbsentError(f"wrenfold is not installed ({error})") from None


def variants(task: Task) -> tuple[Variant, ...]:
    """Its own formulation by the chain rule and by first-order retraction, and liegen's closed forms."""
    sym = _module("sym")
    forms = _variant(task, sym, FORMS, lambda s, given: _closed(task, s, given))
    if not (task.published and task.function.name in FORMULAS):
        return (forms,)
    formula = FORMULAS[task.function.name]
    return (
        _variant(
            task,
            sym,
            "chain rule",
            lambda s, given: finished(task, _chain(task, s, formula, given), s.matrix),
        ),
        _variant(
            task,
            sym,
            "first order",
            lambda s, given: finished(task, _first_order(task, s, formula, given), s.matrix),
        ),
        forms,
    )


def _variant(task: Task, sym: Any, note: str, outputs: Outputs) -> Variant:
    wf: Any = _module("code_generation")
    made = [(n, *fastest(lambda n=n: _generated(task, wf, sym, outputs, n))) for n in FACTORING]
    passes, text, seconds = min(made, key=lambda row: sum(operations(row[1]).values()))
    version = importlib.metadata.version("wrenfold")
    optional = frozenset(port.name for port in task.outputs[len(task.function.graph.outputs) :])
    files = eigen_wrapper(task, SYMBOL, f"gen::{task.name}", "generated.h", optional)
    call = (f"{SYMBOL}(a, b);",)
    detail = f"{note}, {passes} factoring passes" if passes else note
    return Variant(
        NAME, version, detail, prototype(SYMBOL), call, {"generated.h": text, **files},
        operations(text), seconds, column_major=True, options=EIGEN_OPTIONS,
        borrowed=note == FORMS,
    )  # fmt: skip


def _generated(task: Task, wf: Any, sym: Any, outputs: Outputs, passes: int) -> str:
    description = wf.FunctionDescription(name=task.name)
    types: Any = _module("type_info")
    given = {
        port.name: description.add_input_argument(port.name, types.MatrixType(port.size, 1))
        for port in task.inputs
    }
    values = len(task.function.graph.outputs)
    for k, (name, rows) in enumerate(outputs(sym, given).items()):
        description.add_output_argument(name=name, is_optional=k >= values, value=sym.matrix(rows))
    parameters = wf.OptimizationParams()
    parameters.factorization_passes = passes
    generator = wf.CppGenerator(wf.CppMatrixTypeBehavior.Eigen)
    code = generator.generate(wf.transpile(description, optimization_params=parameters))
    return generator.apply_preamble(code, namespace="gen")


def operations(text: str) -> dict[str, int]:
    """The counts by kind that wrenfold writes into its code."""
    found = re.findall(r"^\s*// (\w+): (\d+)$", text, re.MULTILINE)
    return {kind: int(count) for kind, count in found if kind != "total"}


def _closed(task: Task, sym: Any, given: Mapping[str, Any]) -> Rows:
    return closed_forms(task, {name: list(x.to_flat_list()) for name, x in given.items()}, _algebra(sym))


def _algebra(sym: Any) -> Algebra:
    """liegen's functions on wrenfold's scalars; conditions are its booleans."""

    def both(a: Any, b: Any) -> Any:
        return sym.iverson(a) * sym.iverson(b) > 0

    def either(a: Any, b: Any) -> Any:
        return sym.iverson(a) + sym.iverson(b) > 0

    def negated(a: Any) -> Any:
        return sym.iverson(a) < 1

    names = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "abs", "atan2", "lt", "le")
    functions = {name: getattr(sym, name) for name in names}
    more = {"and": both, "or": either, "not": negated, "select": sym.where}
    return Algebra("wrenfold", False, {**functions, **more}, sym.float_constant)


def _values(task: Task, formula: Callable[..., Any], given: Mapping[str, Any]) -> Any:
    return formula(**{port.name: given[port.name] for port in task.inputs})


def _chain(task: Task, sym: Any, formula: Callable[..., Any], given: Mapping[str, Any]) -> Rows:
    """d value / d storage by wrenfold, times d storage / d tangent."""
    graph = task.function.graph
    value = _values(task, formula, given)
    ((name, node),) = graph.outputs
    local = local_slope(sym, node.manifold.form, value)
    found = {name: _rows(value)}
    for p in graph.parameters:
        if p.variable:
            x = given[p.name]
            by_storage = sym.jacobian(value, x) * retract_slope(sym, p.manifold.form, x)
            found[f"{name}_D_{p.name}"] = _rows(by_storage if local is None else local * by_storage)
    return found


def _first_order(task: Task, sym: Any, formula: Callable[..., Any], given: Mapping[str, Any]) -> Rows:
    """Every variable moved by d to first order; the derivative by d, at 0."""
    graph = task.function.graph
    ((name, node),) = graph.outputs
    value = _values(task, formula, given)
    local = local_slope(sym, node.manifold.form, value)
    found = {name: _rows(value)}
    for p in graph.parameters:
        if not p.variable:
            continue
        form = p.manifold.form
        d = sym.vector(*sym.unique_symbols(form.dim, real=True)) if form.dim > 1 else None
        step = d if d is not None else sym.vector(sym.unique_symbols(1, real=True))
        moved = given[p.name] + retract_slope(sym, form, given[p.name]) * step
        slope = sym.jacobian(_values(task, formula, {**given, p.name: moved}), step)
        slope = slope.subs([(symbol, 0) for symbol in step.to_flat_list()])
        found[f"{name}_D_{p.name}"] = _rows(slope if local is None else local * slope)
    return found


def _rows(matrix: Any) -> list[list[Any]]:
    flat, (rows, columns) = matrix.to_flat_list(), matrix.shape
    return [flat[i * columns : (i + 1) * columns] for i in range(rows)]


def retract_slope(sym: Any, form: ManifoldForm, x: Any) -> Any:
    """d storage / d tangent of a right perturbation, (size, dim)."""
    blocks = _slopes(form, x.to_flat_list())
    return sym.diag([block if hasattr(block, "shape") else sym.matrix(block) for block in blocks])


def _slopes(form: ManifoldForm, x: Sequence[Any]) -> list[Any]:
    """Diagonal blocks of the slope, by the manifold's name; a product has those of its parts."""
    if form.parts:
        found: list[Any] = []
        start = 0
        for part in form.parts:
            found += _slopes(part, x[start : start + part.size])
            start += part.size
        return found
    return SLOPES.get(form.name, _identity)(x)


def _identity(x: Sequence[Any]) -> list[Any]:
    return [_module("sym").eye(len(x))]


def _rotation(x: Sequence[Any]) -> list[Any]:
    """Scalar last: half of the quaternion times that of the perturbation."""
    a, b, c, w = (entry / 2 for entry in x)
    return [[[w, -c, b], [c, w, -a], [-b, a, w], [-a, -b, -c]]]


def _pose(x: Sequence[Any]) -> list[Any]:
    quaternion = _module("geometry").Quaternion.from_xyzw(_module("sym").vector(*x[:4]))
    return [*_rotation(x[:4]), quaternion.to_rotation_matrix()]


def _planar(x: Sequence[Any]) -> list[Any]:
    """Tangent (x, y, angle), storage (cos, sin, x, y)."""
    c, s = x[:2]
    return [[[0, 0, -s], [0, 0, c], [c, -s, 0], [s, c, 0]]]


SLOPES: Mapping[str, Callable[[Sequence[Any]], list[Any]]] = {
    "SO3": _rotation,
    "SE3": _pose,
    "SE2": _planar,
}


def local_slope(sym: Any, form: ManifoldForm, y: Any) -> Any:
    """d y.local(storage) / d storage at y, (dim, size); None for vectors. Quaternions come first."""
    if not form.quaternions:
        return None
    rotation = _module("geometry").Quaternion.from_xyzw(y[0:4]).right_local_coordinates_derivative()
    w, a, b, c = (rotation[:, k] for k in range(4))
    turned = sym.hstack([a, b, c, w])
    return sym.diag([turned, sym.eye(form.size - 4)]) if form.size > 4 else turned
