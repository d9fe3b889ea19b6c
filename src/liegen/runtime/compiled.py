"""``Compiled``: a factor as fast functions, its methods, and how it travels to another process."""

from __future__ import annotations

import pickle
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache, partial
from typing import Any, Literal, cast

from numpy.typing import ArrayLike

from liegen.define import Function
from liegen.emit.loops import Method
from liegen.errors import CompilerWarning, DefinitionError, ToolError, warned
from liegen.native import find_compiler

from .calls import Call, Evaluate, call, signature
from .gathers import gathering_evaluator
from .indexed import Indices, batch_evaluator, checked_indices, gathering
from .libraries import Libraries
from .numpy_code import numpy_evaluators
from .source import Source, emitted

Backend = Literal["c", "numpy"]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Methods(Call):
    """A call of the value, with further methods beside it."""

    calls: Mapping[str, Call]

    def __post_init__(self) -> None:
        super().__post_init__()
        for method in self.calls.values():
            object.__setattr__(method, "owner", self)

    @cached_property
    def jacobians(self) -> Call:
        """The value and all Jacobians, as a named tuple. AttributeError for a factor without variables."""
        return self._method("jacobians")

    @cached_property
    def status(self) -> Call:
        """The bits of the requirements that do not hold, 0 inside of the domain: integers (...)."""
        return self._method("status")

    def _method(self, name: str) -> Call:
        try:
            return self.calls[name]
        except KeyError:
            raise AttributeError(f"{self.name} has no {name}: it has no variables") from None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Indexed(Methods):
    """A compiled factor with index arrays: their arguments are arrays (N, ...) to gather from."""

    compiled: Compiled
    indices: Indices

    @cached_property
    def gauss_newton(self) -> Indexed:
        """The Gauss-Newton terms of each factor, with the same index arrays."""
        return self.compiled.gauss_newton.indexed(**self.indices.arrays)

    def __reduce__(self) -> tuple[Any, ...]:
        return reindexed, (self.compiled, dict(self.indices.arrays))

    def __repr__(self) -> str:
        names = ", ".join(self.indices.arrays)
        return f"<{self.name}, {self.indices.length} factors by the index of {names}>"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Compiled(Methods):
    """A factor on arrays (..., n): ``k(x, y, z=z)``, ``k.jacobians(x, y, z=z)``, ``k.status(x, y, z=z)``.

    ``backend`` is "c" or "numpy"; ``asked`` what the caller chose. ``libraries`` are the compiled C.
    ``requirements`` names the bits of the status.
    """

    source: Source
    backend: Backend
    asked: Backend | None
    libraries: Libraries | None
    terms: Callable[[], Source] | None = None

    @cached_property
    def gauss_newton(self) -> Compiled:
        """The Gauss-Newton terms, as a named tuple (cost, g_x, ..., H_x_y, ...); compiled at their first use.

        AttributeError for a ``@function``, which has no residual.
        """
        if self.terms is None:
            raise AttributeError(f"{self.name} has no Gauss-Newton terms: it is no factor with a residual")
        return assembled(self.terms(), self.asked)

    @property
    def requirements(self) -> tuple[str, ...]:
        """What must hold inside of the domain, in the order of the bits of the status."""
        return self.source.requirements

    def indexed(self, /, **index: ArrayLike) -> Indexed:
        """The factor of each number in index arrays (n,), one for each argument that is gathered.

        ``k.indexed(x=i, y=j).jacobians(poses, poses, z=z)`` computes factor n from poses[i[n]], poses[j[n]]
        and z[n]. The arrays are copied and checked here, once; a call then compares only the largest number
        with the length. Raises IndexError for negative numbers, and on a call for one that is too large.
        """
        indices = checked_indices(self.source, index)
        calls: dict[str, Call] = {}
        for method in self.source.methods:
            calls[method.name] = call(self.source, method.name, partial(self._gathered, method, indices))
        return Indexed(*_first(calls), calls=calls, compiled=self, indices=indices)

    def _gathered(self, method: Method, indices: Indices) -> Evaluate:
        libraries = self.libraries
        if libraries is None or method.name == "status":
            return gathering(method, self.calls[method.name].in_fitting_type, indices)
        any_layout = batch_evaluator(libraries, method, indices)
        return gathering_evaluator(libraries.whole, self.source.name, method, indices, any_layout)

    def __repr__(self) -> str:
        shown = {"c": "C", "numpy": "NumPy code"}[self.backend]
        return (
            f"<compiled {self.name}{signature(self.parameters)} {self.source.methods[0].signature}, {shown}>"
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Compiled) and (self.source, self.backend) == (other.source, other.backend)

    def __hash__(self) -> int:
        return hash(self.source)

    def __reduce__(self) -> tuple[Any, ...]:
        terms = self.terms() if self.terms else None
        packed = zlib.compress(pickle.dumps((self.source, terms)))
        return restored, (self.name, self.source.digest, packed, self.asked)


@lru_cache(maxsize=256)
def restored(name: str, digest: str, packed: bytes, asked: Backend | None) -> Compiled:
    """A pickled factor: its entry in the cache, or compiled anew.

    Raises ToolError where it was pickled by another version of liegen, or does not compile.
    """
    try:
        source, terms = pickle.loads(zlib.decompress(packed))
        same = source.digest == digest
    except Exception:  # whatever a changed class does
        source, terms, same = None, None, False
    if source is None or not same:
        raise ToolError(
            f"{name} was pickled by another version of liegen; call liegen.compile on the factor again"
        )
    return assembled(source, asked, (lambda: terms) if terms else None)


def reindexed(compiled: Compiled, index: Mapping[str, ArrayLike]) -> Indexed:
    """A pickled factor with index arrays."""
    return compiled.indexed(**index)


def compile(function: Function[..., Any], *, backend: Backend | None = None) -> Compiled:
    """Compile a ``@factor`` or ``@function`` for this machine's processor.

    ``backend`` "c" insists on a C compiler, "numpy" does without; by default it is C where there is a
    compiler, else NumPy code with a warning (CompilerWarning). The machine code is kept in the user's cache
    folder.
    Raises DefinitionError for what is no factor, ToolError for a compiler that fails.
    """
    given = cast(object, function)
    if not isinstance(given, Function):
        raise DefinitionError(f"liegen.compile needs a @factor or @function, got {type(given).__name__}")
    if backend not in (None, "c", "numpy"):
        raise DefinitionError(f"liegen.compile: backend is 'c' or 'numpy', got {backend!r}")
    return assembled(emitted(function.kernel), backend, _terms_of(function) if function.is_factor else None)


def _terms_of(function: Function[..., Any]) -> Callable[[], Source]:
    return cache(lambda: emitted(function.gauss_newton_kernel, summed=True))


def assembled(source: Source, asked: Backend | None, terms: Callable[[], Source] | None = None) -> Compiled:
    """The methods of a factor on a backend."""
    in_c = asked == "c" or (asked is None and _has_compiler())
    libraries = Libraries(source) if in_c else None
    calls = _in_c(source, libraries) if libraries else _in_numpy(source)
    return Compiled(
        *_first(calls),
        calls=calls, source=source, backend="c" if libraries else "numpy", asked=asked, libraries=libraries,
        terms=terms,
    )  # fmt: skip


def _first(calls: Mapping[str, Call]) -> tuple[Any, ...]:
    """What calling the factor itself does."""
    value = calls["value"]
    made = value.all_types, value.doubles
    return value.name, value.method, value.parameters, *made, value.make, value.doc


def _in_c(source: Source, libraries: Libraries) -> Mapping[str, Call]:
    """The value is compiled now, so that what the compiler refuses is told now."""
    _ = libraries.value
    return {
        m.name: call(source, m.name, partial(libraries.all_of, m), partial(libraries.doubles_of, m))
        for m in source.methods
    }


def _in_numpy(source: Source) -> Mapping[str, Call]:
    made = numpy_evaluators(source)
    return {name: call(source, name, *[partial(made.__getitem__, name)] * 2) for name in made}


def _has_compiler() -> bool:
    if find_compiler():
        return True
    warned(
        "no C compiler was found: compiled factors run as NumPy code; install one, name it in the "
        "environment variable CC, or pip install liegen[compile]",
        CompilerWarning,
    )
    return False
