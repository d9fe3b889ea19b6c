"""What is checked: Python's ``module:function`` and ``file.py:function``, C's ``library.so:function``, and
factors of GTSAM, ``file.py:factor`` or ``gtsam:BetweenFactorPose3``.

A Python function takes the stored arguments as arrays in the formula's order, variables and given ones, and
returns the residual and a Jacobian for each variable. A C function has the signature of the generated ones::

    int f(const double *x, ..., double *res, double *res_D_x, ...)   // Jacobians row by row
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.define import Function
from liegen.errors import SourceError, ToolError
from liegen.kernel import Kernel
from liegen.manifolds import Value
from liegen.trace import Graph

from .gtsam_factors import evaluated, given_by, is_factor, made

Array = NDArray[np.float64]
#: From the stored arguments to the residual and a Jacobian for each variable.
Call = Callable[[Sequence[Array]], tuple[Array, ...]]


@dataclass(frozen=True)
class Foreign:
    """What is checked, and the arguments that it fixes: a factor object has its measurement."""

    call: Call
    given: Mapping[str, Value] = field(default_factory=dict[str, Value])


_SHARED = (".so", ".dylib", ".dll")


def foreign(place: str, function: Function[..., Any], given: Mapping[str, str] | None = None) -> Foreign:
    """What is at ``place``, checked for the shapes that the formula has.

    ``given`` names, for a factor of GTSAM, the objects beside it that are what the formula is given and the
    factor does not tell. Raises SourceError for a place that cannot be read or has no such function, and for
    a factor that lacks what the formula is given.
    """
    kernel = function.kernel
    source, _, name = place.rpartition(":")
    if not source or not name.isidentifier():
        raise SourceError(f"{place!r} is not FILE.py:FUNCTION, MODULE:FUNCTION or LIBRARY.so:FUNCTION")
    if source.endswith(_SHARED):
        return Foreign(_c_function(Path(source), name, kernel))
    module = _module(source)
    found: Any = getattr(module, name, None)
    if is_factor(found):
        stated = {argument: _object(module, other, source) for argument, other in (given or {}).items()}
        return _gtsam_factor(found, function.graph, kernel, place, stated)
    if not callable(found):
        raise SourceError(f"{source} has no function {name!r}")
    return of_callable(found, kernel, place)


def _object(module: Any, name: str, source: str) -> Any:
    if not hasattr(module, name):
        raise SourceError(f"{source} has no {name!r}")
    return getattr(module, name)


def _gtsam_factor(found: Any, graph: Graph, kernel: Kernel, place: str, stated: Mapping[str, Any]) -> Foreign:
    variables = graph.variables
    names = [p.name for p in graph.parameters]

    def of_object(*arguments: Array) -> tuple[Array, ...]:
        values = dict(zip(names, arguments, strict=True))
        factor = made(found, graph, values) if isinstance(found, type) else found
        return evaluated(factor, variables, [values[p.name] for p in variables])

    call = _checked(of_object, kernel, place)
    return Foreign(call) if isinstance(found, type) else Foreign(call, given_by(found, graph, place, stated))


def of_callable(function: Callable[..., Any], kernel: Kernel, place: str) -> Foreign:
    """A Python function; its results are checked at each call, which raises ToolError for a wrong shape."""
    return Foreign(_checked(function, kernel, place))


def _checked(function: Callable[..., Any], kernel: Kernel, place: str) -> Call:
    shapes = [(kernel.outputs[0].dim,), *((kernel.outputs[0].dim, v.dim) for v in kernel.variables)]
    names = ["the residual", *(f"the Jacobian by {v.name}" for v in kernel.variables)]

    def call(arguments: Sequence[Array]) -> tuple[Array, ...]:
        try:
            results = function(*arguments)
        except ToolError as error:
            raise ToolError(f"{place}: {error}") from None
        except Exception as error:
            raise ToolError(f"{place} raised {type(error).__name__}: {error}") from error
        if not isinstance(results, (tuple, list)) or len(results) != len(shapes):  # pyright: ignore[reportUnknownArgumentType]
            raise ToolError(f"{place} must return {len(shapes)} arrays: {', '.join(names)}")
        arrays: list[Array] = []
        listed: list[Any] = [*results]  # pyright: ignore[reportUnknownArgumentType]
        for value, shape, name in zip(listed, shapes, names, strict=True):
            array = np.asarray(value, dtype=np.float64)
            if array.size != np.prod(shape) or (array.ndim == 2 and len(shape) == 2 and array.shape != shape):
                raise ToolError(f"{place}: {name} has shape {array.shape}, {shape} is needed")
            arrays.append(array.reshape(shape))
        return tuple(arrays)

    return call


def _c_function(library: Path, name: str, kernel: Kernel) -> Call:
    try:
        function = ctypes.CDLL(str(library.resolve()))[name]
    except OSError as error:
        raise SourceError(f"{library} cannot be loaded: {error}") from None
    except AttributeError:
        raise SourceError(f"{library} has no function {name!r}") from None
    function.restype = ctypes.c_int
    rows = kernel.outputs[0].dim
    shapes = [(kernel.outputs[0].size,), *((rows, v.dim) for v in kernel.variables)]
    function.argtypes = [ctypes.c_void_p] * (len(kernel.arguments) + len(shapes))

    def call(arguments: Sequence[Array]) -> tuple[Array, ...]:
        given = [np.ascontiguousarray(a, dtype=np.float64) for a in arguments]
        results = [np.full(shape, np.nan) for shape in shapes]
        function(*(a.ctypes.data for a in (*given, *results)))
        return tuple(results)

    return call


def _module(source: str) -> Any:
    path = Path(source)
    try:
        if not source.endswith(".py"):
            if str(Path.cwd()) not in sys.path:
                sys.path.insert(0, str(Path.cwd()))
            return importlib.import_module(source)
        if not path.is_file():
            raise SourceError(f"{path} does not exist; give FILE.py:FUNCTION")
        spec: Any = importlib.util.spec_from_file_location(f"_liegen_foreign_{path.stem}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    except SourceError:
        raise
    except Exception as error:
        raise SourceError(f"{source} cannot be imported: {type(error).__name__}: {error}") from None
