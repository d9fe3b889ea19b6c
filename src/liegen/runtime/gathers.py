"""Index arrays the short way: a gufunc that gathers, for arrays as they usually are."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from liegen.emit.gathers import gathers_symbol
from liegen.emit.loops import INT, NUMBERS, Method
from liegen.program import Port

from .calls import Evaluate
from .indexed import Array, Indices, steps
from .source import PACKAGE
from .ufuncs import Made, made_gufunc

_DOUBLE = next(n for n in NUMBERS if n.type == "double")
_DTYPE = np.dtype(_DOUBLE.dtype)


@dataclass(frozen=True)
class _Expected:
    """What an argument must be: its shape, one of several, or that of an element and their least number."""

    shapes: tuple[tuple[int, ...], ...]
    element: tuple[int, ...]
    least: int | None

    def fits(self, array: Any) -> bool:
        """Whether it is a contiguous array of doubles of that shape."""
        if type(array) is not np.ndarray or array.dtype != _DTYPE or not array.flags.c_contiguous:
            return False
        if self.least is None:
            return array.shape in self.shapes
        return array.shape[1:] == self.element and array.ndim > 0 and len(array) >= self.least


def gathering_evaluator(
    library: ctypes.CDLL, name: str, method: Method, indices: Indices, otherwise: Evaluate
) -> Evaluate:
    """A method as one gufunc on arrays to gather from, NumPy's way of calling C that takes least time.

    For contiguous float64 arrays of the right shapes; all other arguments, and wrong ones, go to
    ``otherwise``.
    """
    gathered = [port.name for port in method.inputs if port.name in indices.arrays]
    gather = _gathering_gufunc(library, name, method, gathered)
    index = tuple(indices.arrays[argument] for argument in gathered)
    expected = [_expected(port, indices) for port in method.inputs]
    shapes = [(indices.length, *port.shape) for port in method.outputs]

    def evaluate(*arrays: Any, out: Any = None) -> Any:
        for array, wanted in zip(arrays, expected, strict=True):
            if not wanted.fits(array):
                return otherwise(*arrays, out=out)
        if out is None:
            return gather.call(*arrays, *index)
        if not _take(out, shapes):
            return otherwise(*arrays, out=out)
        return gather.call(*arrays, *index, out=out)

    return evaluate


def _expected(port: Port, indices: Indices) -> _Expected:
    shapes = ((indices.length, *port.shape), port.shape, (1, *port.shape))
    least = indices.largest[port.name] + 1 if port.name in indices.arrays else None
    return _Expected(shapes, port.shape, least)


def _take(out: Any, shapes: Sequence[tuple[int, ...]]) -> bool:
    """Whether C can write to all of the caller's arrays."""
    given = cast("tuple[Any, ...]", out if isinstance(out, tuple) else (out,))
    return len(given) == len(shapes) and all(
        o is None or _takes(o, shape) for o, shape in zip(given, shapes, strict=True)
    )


def _takes(target: Any, shape: tuple[int, ...]) -> bool:
    if type(target) is not np.ndarray or target.dtype != _DTYPE or target.shape != shape:
        return False
    array: Array = target
    return array.flags.carray or (array.flags.aligned and steps(array, shape[1:])[1] != 0)


def _gathering_gufunc(library: ctypes.CDLL, name: str, method: Method, gathered: Sequence[str]) -> Made:
    inputs = len(method.inputs)
    first, total = inputs + len(gathered), inputs + len(gathered) + len(method.outputs)
    places = [inputs + gathered.index(p.name) if p.name in gathered else 0 for p in method.inputs]
    told = (ctypes.c_int * (2 + inputs))(first, total, *places)
    types = [_DOUBLE.code] * inputs + [INT] * len(gathered) + [_DOUBLE.code] * len(method.outputs)
    left = [_core(port, f"n{k}" if places[k] else "") for k, port in enumerate(method.inputs)]
    left += ["()"] * len(gathered)
    signature = f"{','.join(left)}->{','.join(_core(port) for port in method.outputs)}"
    loop = library[gathers_symbol(name, method.name, PACKAGE)]
    return made_gufunc(loop, told, types, method.title, first, signature)


def _core(port: Port, first: str = "") -> str:
    return f"({','.join([*([first] if first else []), *map(str, port.shape)])})"
