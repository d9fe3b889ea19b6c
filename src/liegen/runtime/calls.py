"""``Call``: one method of a compiled factor, with the signature of the factor."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache, partial
from inspect import Parameter as Place
from inspect import Signature
from typing import Any, NoReturn, cast

import numpy as np
from numpy import ndarray

from liegen.errors import DefinitionError
from liegen.manifolds import Value

from .arguments import problem, with_columns
from .source import Parameter, Source

#: Arrays in the order of the parameters in, an array or a tuple of arrays out, and ``out=``: as a gufunc.
Evaluate = Callable[..., Any]
_DOUBLE, _SINGLE = np.dtype(np.float64), np.dtype(np.float32)


@cache
def record(name: str, fields: tuple[str, ...]) -> type[tuple[Any, ...]]:
    """A named tuple; its values can be pickled although no module holds the class."""
    base: Any = namedtuple(name, fields)  # pyright: ignore[reportUntypedNamedTuple]
    return type(name, (base,), {"__slots__": (), "__reduce__": _reduced, "__module__": __name__})


def _reduced(values: Any) -> tuple[Any, ...]:
    return _restored, (type(values).__name__, values._fields, tuple(values))


def _restored(name: str, fields: tuple[str, ...], values: tuple[Any, ...]) -> tuple[Any, ...]:
    made: Any = record(name, fields)
    return made._make(values)


@lru_cache(maxsize=64)
def _is_small(dtype: np.dtype[Any]) -> bool:
    """Whether single precision holds all numbers of this type."""
    return np.can_cast(dtype, _SINGLE)


@dataclass(frozen=True, eq=False, repr=False)
class Call:
    """Callable on arrays (..., n) and on typed values; keyword-only arguments by name.

    ``out`` is an array, or a tuple of arrays where there are several results. Raises TypeError for missing or
    unknown arguments and for what is no real number, DefinitionError for a typed value of another manifold,
    ValueError for another shape; each names the argument. A plain number is taken for a scalar.

    ``all_types`` and ``doubles`` make what evaluates it, at the first call that needs it: for any type of
    number, and where one of the arguments is no smaller one than float64.
    """

    name: str
    method: str
    parameters: tuple[Parameter, ...]
    all_types: Callable[[], Evaluate]
    doubles: Callable[[], Evaluate] | None = None
    make: Any = None  # of the results, the tuple that is returned
    doc: str = ""
    owner: Any = field(default=None, init=False)  # the compiled factor that this is a method of
    _made: Evaluate | None = field(default=None, init=False)  # by doubles
    _positional: int = field(init=False)
    _keywords: tuple[str, ...] = field(init=False)
    _defaults: Mapping[str, Any] = field(init=False)

    def __post_init__(self) -> None:
        keywords = tuple(p.name for p in self.parameters if p.keyword)
        object.__setattr__(self, "_positional", len(self.parameters) - len(keywords))
        object.__setattr__(self, "_keywords", keywords)
        defaults = {
            p.name: np.array(p.default).reshape(p.shape) for p in self.parameters if p.default is not None
        }
        object.__setattr__(self, "_defaults", defaults)
        object.__setattr__(self, "__doc__", self.doc)
        object.__setattr__(self, "__name__", self.name)
        object.__setattr__(self, "__signature__", signature(self.parameters))

    def __reduce__(self) -> tuple[Any, ...]:
        return getattr, (self.owner, self.method)

    def __call__(self, /, *arrays: Any, out: Any = None, **given: Any) -> Any:
        """Evaluate; the docstring of the instance describes arguments and results."""
        if len(arrays) == self._positional and len(given) == len(self._keywords):
            try:
                for name in self._keywords:
                    arrays += (given[name],)
            except KeyError:
                self._refuse(arrays, given)
        else:
            arrays = self.bound(arrays, given)
        evaluate = self._made
        for array in arrays:
            if type(array) is not ndarray:
                arrays, evaluate = self._plain(arrays), None
                break
        try:
            if evaluate is None or arrays[0].dtype is not _DOUBLE:
                evaluate = self._fitting(arrays)
            results = evaluate(*arrays) if out is None else evaluate(*arrays, out=out)
        except (TypeError, ValueError) as error:
            results = self._again(error, arrays, out)
        return results if self.make is None else self.make(results)

    def _again(self, error: Exception, arrays: Sequence[Any], out: Any) -> Any:
        """The results with plain numbers for scalars, or the error with the name of the argument."""
        columns = with_columns(self.parameters, arrays)
        indexed = self.doubles is None  # it names the arguments itself, whose leading dimensions may differ
        wrong = None if indexed else problem(self.name, self.parameters, columns)
        if wrong is not None:
            raise wrong from None
        if all(new is old for new, old in zip(columns, arrays, strict=True)):
            raise error
        evaluate = self._fitting(columns)
        return evaluate(*columns) if out is None else evaluate(*columns, out=out)

    @cached_property
    def evaluate(self) -> Evaluate:
        """The method on arrays of any type, in the order of the parameters: of C, NumPy's ufunc itself."""
        return self.all_types()

    def in_fitting_type(self, *arrays: Any, out: Any = None) -> Any:
        """As ``evaluate``, but single precision is compiled only where all arguments are of it."""
        return self._fitting(arrays)(*arrays, out=out)

    def _fitting(self, arrays: Sequence[Any]) -> Evaluate:
        """Single precision is compiled where all arguments are of it."""
        if self.doubles is None or all(_is_small(np.asarray(array).dtype) for array in arrays):
            return self.evaluate
        if self._made is None:
            object.__setattr__(self, "_made", self.doubles())
        return cast("Evaluate", self._made)

    def __repr__(self) -> str:
        return f"<compiled {self.name}{signature(self.parameters)}>"

    def bound(self, arrays: Sequence[Any], given: Mapping[str, Any]) -> tuple[Any, ...]:
        """All arguments in the order of the parameters; positional ones may be named too."""
        if len(arrays) > self._positional:
            self._refuse(arrays, given)
        names = [p.name for p in self.parameters]
        named = dict(zip(names, arrays, strict=False))
        if named.keys() & given.keys() or {*named, *given, *self._defaults} != set(names):
            self._refuse(arrays, given)
        named = {**self._defaults, **named, **given}
        return tuple(named[name] for name in names)

    def _refuse(self, arrays: Sequence[Any], given: Mapping[str, Any]) -> NoReturn:
        names = [p.name for p in self.parameters]
        passed = [*names[: min(len(arrays), self._positional)], *given]
        missing = [name for name in names if name not in passed and name not in self._defaults]
        unknown = [name for name in given if name not in names]
        twice = [name for name in passed if passed.count(name) > 1]
        problems = [
            f"{what} {', '.join(dict.fromkeys(which))}"
            for what, which in (("missing", missing), ("unknown", unknown), ("given twice", twice))
            if which
        ] or [f"{len(arrays)} positional arguments"]
        usage = ", ".join(f"{p.name}=" if p.keyword else p.name for p in self.parameters)
        raise TypeError(f"{self.name}: {'; '.join(problems)}; call it as {self.name}({usage})")

    def _plain(self, values: Sequence[Any]) -> tuple[Any, ...]:
        """Typed values as arrays."""
        for p, value in zip(self.parameters, values, strict=True):
            if isinstance(value, Value) and value.form.name != p.manifold:
                raise DefinitionError(
                    f"{self.name}: argument {p.name!r} must be {p.manifold}, got {value.form.name}"
                )
        return tuple(np.asarray(v) if isinstance(v, Value) else v for v in values)


def signature(parameters: Sequence[Parameter]) -> Signature:
    """What ``inspect.signature`` and ``help`` show."""
    places = [
        Place(
            p.name,
            Place.KEYWORD_ONLY if p.keyword else Place.POSITIONAL_OR_KEYWORD,
            default=Place.empty if p.default is None else p.default,
        )
        for p in parameters
    ]
    return Signature([*places, Place("out", Place.KEYWORD_ONLY, default=None)])


def call(
    source: Source,
    method: str,
    all_types: Callable[[], Evaluate],
    doubles: Callable[[], Evaluate] | None = None,
) -> Call:
    """The method of a factor on top of what makes its evaluators; see :class:`Call`."""
    described = next(m for m in source.methods if m.name == method)
    fields = tuple(port.name for port in described.outputs)
    made: Any = record(source.records[method], fields) if len(fields) > 1 else None
    make = partial(tuple.__new__, made) if made else None  # pyright: ignore[reportUnknownMemberType]
    doc = source.docs[method]
    return Call(described.title, method, source.parameters, all_types, doubles, make, doc)
