"""Without a compiler: the emitted NumPy code for batches, Python's floats for a single element."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from liegen.emit.importing import load_modules
from liegen.emit.loops import NUMBERS, Method
from liegen.program import Port

from .calls import Evaluate
from .source import PACKAGE, Source

Array = NDArray[Any]
#: What Python's floats raise where arrays hold inf or NaN.
_RAISED = (ZeroDivisionError, ValueError, OverflowError)


def numpy_evaluators(source: Source) -> dict[str, Evaluate]:
    """A function for each method, called as the gufunc of that method would be."""
    package = load_modules(source.numpy, PACKAGE)
    floats = _namespace(source.floats)
    made = {
        m.name: _evaluator(source, m, getattr(package, m.title), floats[m.name])
        for m in source.methods
        if m.name != "status"
    }
    return {**made, "status": _status(source, made["value"], _namespace(source.conditions)["conditions"])}


def _namespace(text: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(text, "liegen_compiled", "exec"), names)
    return names


def _evaluator(
    source: Source, method: Method, batch: Callable[..., Any], single: Callable[..., Any]
) -> Evaluate:
    keywords = [p.name for p in source.parameters if p.keyword]
    positional = len(source.parameters) - len(keywords)
    given = [port.shape for port in method.inputs]
    shapes = [port.shape for port in method.outputs]

    def evaluate(*arrays: Any, out: Any = None) -> Any:
        values = [np.asarray(array) for array in arrays]
        results = _alone(values) if [v.shape for v in values] == given else None
        if results is None:
            named = dict(zip(keywords, values[positional:], strict=True))
            made = batch(*values[:positional], **named)
            results = [made] if len(shapes) == 1 else list(made)
        return handed(results, number(values), out)

    def _alone(values: Sequence[Array]) -> list[Array] | None:
        if any(v.dtype.kind not in "fiu" for v in values):
            return None
        try:
            made = single([v.ravel().astype(np.float64, copy=False).tolist() for v in values])
        except _RAISED:
            return None
        if made is None:
            return [np.full(shape, np.nan) for shape in shapes]
        return [np.array(flat).reshape(shape) for flat, shape in zip(made, shapes, strict=True)]

    return evaluate


def _status(source: Source, value: Evaluate, conditions: Callable[..., Any]) -> Evaluate:
    described = next(m for m in source.methods if m.name == "value")
    first, single = len(described.outputs[0].shape), len(described.outputs) == 1

    def evaluate(*arrays: Any, out: Any = None) -> Any:
        values = [np.asarray(array) for array in arrays]
        results = value(*values)  # refuses what it refuses
        value_shape: tuple[int, ...] = np.shape(results if single else results[0])
        batch = value_shape[: len(value_shape) - first]
        parts = [_components(v, port) for v, port in zip(values, described.inputs, strict=True)]
        with np.errstate(all="ignore"):
            held = conditions(parts)
        bits = [np.broadcast_to(np.where(h, 0, 1 << k), batch) for k, h in enumerate(held)]
        return handed([sum(bits, np.zeros(batch, np.int32))], np.dtype(np.int32), out)

    return evaluate


def _components(array: Array, port: Port) -> list[Array]:
    flat = array.reshape(*array.shape[: array.ndim - len(port.shape)], port.size).astype(np.float64)
    return [flat[..., k] for k in range(port.size)]


def number(values: Sequence[Array]) -> np.dtype[Any]:
    """The type of the results: the first that all arguments can be cast to safely, as in a gufunc."""
    types = [np.dtype(n.dtype) for n in NUMBERS]
    fits = (t for t in types if all(np.can_cast(v.dtype, t) for v in values))
    return next(fits, types[-1])


def targets(out: Any, count: int) -> tuple[Any, ...]:
    """An array, or None for a new one, for each result. Raises ValueError for another number of them."""
    given: tuple[Any, ...] = (
        cast(Any, out) if isinstance(out, tuple) else (out,) * (count if out is None else 1)
    )
    if len(given) != count:
        raise ValueError(f"out must hold {count} arrays, one for each result, got {len(given)}")
    return given


def handed(results: Sequence[Array], dtype: np.dtype[Any], out: Any) -> Any:
    """Results in their type, or written to ``out``; a single one is not a tuple."""
    made = [r if r.dtype == dtype else r.astype(dtype) for r in results]
    for k, target in enumerate(targets(out, len(results))):
        if target is not None:
            if target is not made[k]:
                np.copyto(target, made[k], casting="same_kind")
            made[k] = target
    return made[0] if len(made) == 1 else tuple(made)
