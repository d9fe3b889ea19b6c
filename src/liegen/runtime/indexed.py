"""Batches that gather their arguments: index arrays are checked once, the C function reads through them."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.emit.loops import NUMBERS, Method
from liegen.program import Port

from .calls import Evaluate
from .libraries import Libraries
from .numpy_code import handed, number, targets
from .source import PACKAGE, Source

Array = NDArray[Any]


class Input(ctypes.Structure):
    """``PACKAGE_in`` of the emitted header."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("stride", ctypes.c_ssize_t),
        ("comp", ctypes.c_ssize_t),
        ("index", ctypes.c_void_p),
    )


class _Out(ctypes.Structure):
    """``PACKAGE_out`` of the emitted header."""

    _fields_ = (("data", ctypes.c_void_p), ("stride", ctypes.c_ssize_t), ("comp", ctypes.c_ssize_t))


@dataclass(frozen=True, eq=False)
class Indices:
    """Index arrays of one length by the name of their argument, and the largest number in each."""

    arrays: Mapping[str, NDArray[np.int32]]
    largest: Mapping[str, int]
    length: int

    def check(self, function: str, argument: str, array: Array, core: tuple[int, ...]) -> None:
        """Raise ValueError for an array that is no list of elements, IndexError where it is too short."""
        if array.shape[1:] != core or array.ndim != len(core) + 1:
            expected = ", ".join(["N", *map(str, core)])
            raise ValueError(
                f"{function}: argument {argument} is indexed: expected shape ({expected}), got {array.shape}"
            )
        if self.largest[argument] >= len(array):
            raise IndexError(
                f"{function}: the index of {argument} holds {self.largest[argument]}, "
                f"but {argument} has {len(array)} elements"
            )


def checked_indices(source: Source, given: Mapping[str, ArrayLike]) -> Indices:
    """Copies of index arrays as the C function takes them.

    Raises TypeError for a name that is no argument and for what are no integers, ValueError for other
    shapes than one (n,) for all, IndexError for negative numbers.
    """
    names = [p.name for p in source.parameters]
    if not given:
        raise TypeError(f"{source.name}: give an index array for an argument: {', '.join(names)}")
    arrays: dict[str, NDArray[np.int32]] = {}
    for name, value in given.items():
        if name not in names:
            raise TypeError(f"{source.name}: no argument {name!r}; it has {', '.join(names)}")
        arrays[name] = _checked(f"{source.name}: the index of {name}", np.asarray(value))
    lengths = {len(array) for array in arrays.values()}
    if len(lengths) > 1:
        shown = ", ".join(f"{name} {len(array)}" for name, array in arrays.items())
        raise ValueError(f"{source.name}: index arrays must have one length: {shown}")
    largest = {name: int(array.max(initial=-1)) for name, array in arrays.items()}
    return Indices(arrays, largest, lengths.pop())


def _checked(what: str, array: Array) -> NDArray[np.int32]:
    if array.ndim != 1:
        raise ValueError(f"{what} must have one dimension, its shape is {array.shape}")
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{what} must hold integers, got {array.dtype}")
    if array.size and array.min() < 0:
        raise IndexError(f"{what} holds {array.min()}: negative numbers are no index here")
    if array.size and array.max() > np.iinfo(np.int32).max:
        raise IndexError(f"{what} holds {array.max()}, more than C's index of 32 bits can say")
    made = np.array(array, dtype=np.int32)
    made.flags.writeable = False
    return made


def gathering(method: Method, evaluate: Evaluate, indices: Indices) -> Evaluate:
    """The same without C: the elements are copied together first."""

    def gathered(*arrays: Any, out: Any = None) -> Any:
        values: list[Any] = []
        for array, port in zip(arrays, method.inputs, strict=True):
            index = indices.arrays.get(port.name)
            value = np.asarray(array)
            if index is None:
                _leading(method, port, value, indices.length)
            else:
                indices.check(method.title, port.name, value, port.shape)
            values.append(value if index is None else value[index])
        return evaluate(*values, out=out)

    return gathered


def _leading(method: Method, port: Port, array: Array, length: int) -> bool:
    """Whether an array that is not indexed has an element for each factor, not one for all."""
    if array.shape in (port.shape, (1, *port.shape)):
        return False
    if array.shape == (length, *port.shape):
        return True
    core = ", ".join(map(str, port.shape))
    raise ValueError(
        f"{method.title}: argument {port.name}: expected shape ({length}, {core}) or ({core}), "
        f"got {array.shape}"
    )


def batch_evaluator(libraries: Libraries, method: Method, indices: Indices) -> Evaluate:
    """A method through the C function of batches; the interpreter's lock is released while it runs."""
    single, _ = NUMBERS

    @cache
    def function(dtype: np.dtype[Any]) -> Callable[..., int]:
        if dtype == single.dtype:
            return _function(libraries.singles, method, single.precision.suffix)
        return _function(libraries.whole, method, "")

    n, given = indices.length, len(method.inputs)
    order = [port.name for port in (*method.inputs, *method.outputs)]
    places = [order.index(name) if name in order else None for name in method.taken[given:]]

    def evaluate(*arrays: Any, out: Any = None) -> Any:
        values = [np.asarray(array) for array in arrays]
        dtype = number(values)
        inputs, passed = structures(method, values, indices, dtype)
        made_here: list[_Out] = []
        results: list[Array] = []
        for port, target in zip(method.outputs, targets(out, len(method.outputs)), strict=True):
            shape = (n, *port.shape)
            made = target if _direct(target, shape, dtype, inputs) else np.empty(shape, dtype)
            made_here.append(_Out(made.ctypes.data, *steps(made, port.shape)))
            results.append(made)
        wanted = (_Out(None, 0, 0) if p is None else made_here[p - given] for p in places)
        function(dtype)(n, *passed, *wanted, None)
        return handed(results, dtype, out)

    return evaluate


def structures(
    method: Method, arrays: Sequence[Any], indices: Indices, dtype: np.dtype[Any]
) -> tuple[list[Array], list[Any]]:
    """Arguments as arrays that C can read, and as its structures in the order in which it takes them.

    The structures point into the arrays.
    """
    inputs = [
        _cast(method, port, np.asarray(a), dtype) for port, a in zip(method.inputs, arrays, strict=True)
    ]
    made = {p.name: _input(method, p, a, indices) for p, a in zip(method.inputs, inputs, strict=True)}
    return inputs, [made[name] for name in method.taken[: len(inputs)]]


def _function(library: ctypes.CDLL, method: Method, suffix: str) -> Callable[..., int]:
    function = library[f"{PACKAGE}_{method.function}{suffix}"]
    inputs, total = len(method.inputs), len(method.taken)
    function.argtypes = [ctypes.c_ssize_t, *[Input] * inputs, *[_Out] * (total - inputs), ctypes.c_void_p]
    function.restype = ctypes.c_int
    return function


def _cast(method: Method, port: Port, array: Array, dtype: np.dtype[Any]) -> Array:
    """The argument in the type of the loop, laid out so that steps count items."""
    try:
        made = array.astype(dtype, casting="same_kind", copy=False)
    except TypeError as error:
        raise TypeError(f"{method.title}: argument {port.name}: {error}") from None
    return made if made.flags.aligned and _regular(made, port.shape) else np.ascontiguousarray(made)


def _regular(array: Array, core: tuple[int, ...]) -> bool:
    return array.ndim < len(core) or steps(array, core)[1] != 0


def steps(array: Array, core: tuple[int, ...]) -> tuple[int, int]:
    """Items between elements, and between the numbers of an element; (0, 0) where no such steps exist."""
    size, count = array.itemsize, len(core)
    if array.flags.c_contiguous:
        return math.prod(core), 1
    strides = array.strides[array.ndim - count :]
    if any(step % size for step in array.strides):
        return 0, 0
    used = [step for step, extent in zip(strides, core, strict=True) if extent > 1]
    comp = used[-1] if used else size
    if len(used) > 1 and used[0] != core[-1] * comp:
        return 0, 0
    return (array.strides[0] // size if array.ndim > count else 0), comp // size


def _input(method: Method, port: Port, array: Array, indices: Indices) -> Input:
    index = indices.arrays.get(port.name)
    if index is None:
        each = _leading(method, port, array, indices.length)
        stride, comp = steps(array, port.shape)
        return Input(array.ctypes.data, stride if each else 0, comp, None)
    indices.check(method.title, port.name, array, port.shape)
    stride, comp = steps(array, port.shape)
    return Input(array.ctypes.data, stride, comp, index.ctypes.data)


def _direct(target: Any, shape: tuple[int, ...], dtype: np.dtype[Any], inputs: Sequence[Array]) -> bool:
    """Whether C can write to the caller's array."""
    if not isinstance(target, np.ndarray):
        return False
    array: Array = np.asarray(target)  # pyright: ignore[reportUnknownArgumentType]
    if array.shape != shape or array.dtype != dtype:
        return False
    plain = array.flags.writeable and array.flags.aligned and _regular(array, shape[1:])
    return plain and not any(np.may_share_memory(array, x) for x in inputs)
