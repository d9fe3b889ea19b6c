"""What is wrong with the arrays of a call, with the argument's name; looked for where a call failed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .source import Parameter

#: NumPy's kinds of real numbers.
_REAL = "fiub"


def with_columns(parameters: Sequence[Parameter], arrays: Sequence[Any]) -> tuple[Any, ...]:
    """The arrays, with a single number for a scalar as an array of shape (1,)."""
    pairs = zip(parameters, arrays, strict=True)
    return tuple(np.reshape(a, 1) if p.shape == (1,) and _is_number(a) else a for p, a in pairs)


def _is_number(given: Any) -> bool:
    return isinstance(given, float | int | np.number) or (isinstance(given, np.ndarray) and given.ndim == 0)


def problem(name: str, parameters: Sequence[Parameter], arrays: Sequence[Any]) -> Exception | None:
    """The error that names the argument that no kernel takes; None where all of them fit."""
    batches: dict[str, tuple[int, ...]] = {}
    for p, given in zip(parameters, arrays, strict=True):
        what = f"{name}: argument {p.name}: expected shape {_shown(p.shape)}"
        try:
            array = np.asarray(given)
        except (ValueError, TypeError):
            return ValueError(f"{what}, got a {type(given).__name__} whose rows differ in length")
        if array.dtype.kind not in _REAL:
            return TypeError(f"{what} of real numbers, got {_kind(given, array)}")
        core = len(p.shape)
        if array.shape[array.ndim - core :] != p.shape or array.ndim < core:
            cure = "; a batch of scalars is array[:, None]" if p.shape == (1,) else ""
            return ValueError(f"{what}, got {array.shape}{cure}")
        batches[p.name] = array.shape[: array.ndim - core]
    try:
        np.broadcast_shapes(*batches.values())
    except ValueError:
        got = ", ".join(f"{argument} {batch}" for argument, batch in batches.items())
        return ValueError(f"{name}: leading dimensions do not broadcast: {got}")
    return None


def _shown(shape: tuple[int, ...]) -> str:
    return f"(..., {', '.join(map(str, shape))})"


def _kind(given: Any, array: Any) -> str:
    named = {"c": "complex numbers", "U": "text", "S": "text", "M": "dates", "m": "times"}
    return named.get(array.dtype.kind, "None" if given is None else f"a {type(given).__name__}")
