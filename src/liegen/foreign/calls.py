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
from liegen.errors import LiegenError, SourceError
from liegen.kernel import Kernel
from liegen.manifolds import Value
from liegen.text import exception_text

from .gtsam_factors import evaluated, given_by, is_factor, made
from .returned import checked
from .signature import Signature, of_kernel, signature

Array = NDArray[np.float64]
#: From the stored arguments to the residual and a Jacobian for each variable.
Call = Callable[[Sequence[Array]], tuple[Array, ...]]

_LIBRARIES = (".so", ".dylib", ".dll", ".pyd")
_SOURCES = (".c", ".cc", ".cpp", ".cxx", ".h", ".hpp", ".o", ".a")


@dataclass(frozen=True)
class Loaded:
    """What stands at a place, and the stored numbers of the arguments that it fixes.

    ``own``: it takes the numbers in liegen's own layout, whatever the factor's layout is.
    """

    call: Call
    given: Mapping[str, Array] = field(default_factory=dict[str, Array])
    own: bool = False


@dataclass(frozen=True)
class Foreign:
    """What is checked, and the arguments that it fixes: a factor object has its measurement."""

    call: Call
    given: Mapping[str, Value] = field(default_factory=dict[str, Value])
    own: bool = False  # whether it takes the numbers in liegen's own layout


def foreign(place: str, function: Function[..., Any], given: Mapping[str, str] | None = None) -> Foreign:
    """What is at ``place``, run in this process, checked for the shapes that the formula has.

    ``given`` names, for a factor of GTSAM, the objects beside it that are what the formula is given and the
    factor does not tell. Raises SourceError for a place that cannot be read or has no such function, and for
    a factor that lacks what the formula is given.
    """
    return typed(loaded(place, signature(function), given or {}), function)


def typed(found: Loaded, function: Function[..., Any]) -> Foreign:
    """With elements in place of the stored numbers that it fixes."""
    manifolds: dict[str, Any] = {p.name: p.manifold for p in function.graph.parameters}
    values = {name: manifolds[name].from_storage(stored) for name, stored in found.given.items()}
    return Foreign(found.call, values, found.own)


def of_callable(function: Callable[..., Any], kernel: Kernel, place: str) -> Foreign:
    """A Python function; its results are checked at each call, which raises ToolError for a wrong shape."""
    return Foreign(checked(function, place, of_kernel(kernel)))


def loaded(place: str, expected: Signature, given: Mapping[str, str]) -> Loaded:
    """What is at a place; errors as :func:`foreign` says."""
    source, _, name = place.rpartition(":")
    if not source or not name.isidentifier():
        raise SourceError(f"{place!r} is not FILE.py:FUNCTION, MODULE:FUNCTION or LIBRARY.so:FUNCTION")
    if source.endswith(_SOURCES):
        library = Path(source).with_suffix(".so").name
        raise SourceError(
            f"{source} is not compiled; compile it and give the library, for example: "
            f"cc -shared -fPIC -O2 -o {library} {source} -lm, then --against ./{library}:{name}"
        )
    if source.endswith(_LIBRARIES):
        return Loaded(_c_function(source, name, expected))
    module = _module(source)
    found: Any = getattr(module, name, None)
    if is_factor(found):
        stated = {argument: _object(module, other, source) for argument, other in given.items()}
        return _gtsam_factor(found, expected, place, stated)
    if not callable(found):
        raise SourceError(f"{source} has no function {name!r}")
    return Loaded(checked(found, place, expected))


def _object(module: Any, name: str, source: str) -> Any:
    if not hasattr(module, name):
        raise SourceError(f"{source} has no {name!r}")
    return getattr(module, name)


def _gtsam_factor(found: Any, expected: Signature, place: str, stated: Mapping[str, Any]) -> Loaded:
    def of_object(*arguments: Array) -> tuple[Array, ...]:
        values = {a.name: stored for a, stored in zip(expected.arguments, arguments, strict=True)}
        factor = made(found, expected, values) if isinstance(found, type) else found
        return evaluated(factor, expected.variables, [values[v.name] for v in expected.variables])

    call = checked(of_object, place, expected)
    if isinstance(found, type):
        return Loaded(call, own=True)
    return Loaded(call, given_by(found, expected, place, stated), own=True)


def _c_function(source: str, name: str, expected: Signature) -> Call:
    library = Path(source)
    if not library.is_file():
        raise SourceError(f"{source} cannot be loaded: there is no such file; give LIBRARY.so:FUNCTION")
    try:
        function = ctypes.CDLL(str(library.resolve()))[name]
    except OSError as error:
        reason = str(error).replace(str(library.resolve()), source)
        raise SourceError(f"{source} cannot be loaded: {reason.removeprefix(f'{source}: ')}") from None
    except AttributeError:
        raise SourceError(f"{source} has no function {name!r}") from None
    function.restype = ctypes.c_int
    shapes = [(expected.size,), *((expected.rows, v.dim) for v in expected.variables)]
    function.argtypes = [ctypes.c_void_p] * (len(expected.arguments) + len(shapes))

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
    except (LiegenError, KeyboardInterrupt):
        raise
    except BaseException as error:  # a user's file may raise anything
        raise SourceError(f"{source} cannot be imported: {exception_text(error)}") from error
