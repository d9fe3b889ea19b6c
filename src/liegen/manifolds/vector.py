"""Vectors: ``Vector`` of any dimension, ``R1`` (a scalar) to ``R9``, and ``class R12(R, dim=12)``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any, ClassVar, NoReturn, Self, SupportsIndex, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from liegen.advice import for_no_vector, for_operator_here
from liegen.algebra import call
from liegen.errors import DefinitionError

from .condition import Condition
from .given import LARGEST, dimension, real_numbers
from .group import Group
from .node import Value, apply, called, formula, here, user_frame
from .rn_form import RForm
from .vector_operations import (
    ARITHMETIC,
    Elementwise,
    Partials,
    comparison,
    constant_product,
    elementwise,
    join,
    length_of,
    positions,
    spoken_as,
    take,
)

V = TypeVar("V", bound="Vector")


class Vector(Group):
    """A vector. Arithmetic is elementwise, as in NumPy; a scalar (``R1`` or a number) fits any dimension."""

    __slots__ = ()
    form: ClassVar[RForm]  # pyright: ignore[reportIncompatibleVariableOverride]

    @overload
    def __add__(self: R1, other: V) -> V: ...
    @overload
    def __add__(self, other: VectorLike) -> Self: ...
    def __add__(self, other: Any) -> Any:
        return _binary("add", self, other)

    @overload
    def __sub__(self: R1, other: V) -> V: ...
    @overload
    def __sub__(self, other: VectorLike) -> Self: ...
    def __sub__(self, other: Any) -> Any:
        return _binary("sub", self, other)

    @overload
    def __mul__(self: R1, other: V) -> V: ...
    @overload
    def __mul__(self, other: VectorLike) -> Self: ...
    def __mul__(self, other: Any) -> Any:
        return _binary("mul", self, other)

    @overload
    def __truediv__(self: R1, other: V) -> V: ...
    @overload
    def __truediv__(self, other: VectorLike) -> Self: ...
    def __truediv__(self, other: Any) -> Any:
        return _binary("div", self, other)

    def __radd__(self, other: float | Sequence[float] | NDArray[Any]) -> Self:
        return _binary("add", other, self)

    def __rsub__(self, other: float | Sequence[float] | NDArray[Any]) -> Self:
        return _binary("sub", other, self)

    def __rmul__(self, other: float | Sequence[float] | NDArray[Any]) -> Self:
        return _binary("mul", other, self)

    def __rtruediv__(self, other: float | Sequence[float] | NDArray[Any]) -> Self:
        return _binary("div", other, self)

    def __neg__(self) -> Self:
        return _elementwise("neg", "-{0}", (self,), lambda a: -a, lambda _, _a: (-1,))

    def __pos__(self) -> Self:
        return self

    def __abs__(self) -> Self:
        return unary("abs", self)

    def __pow__(self, exponent: int) -> Self:
        if not isinstance(exponent, int) or exponent < 0:  # pyright: ignore[reportUnnecessaryIsInstance]
            cure = for_operator_here(Vector, user_frame()) or "exp(y * log(x)) for x ** y"
            raise DefinitionError(f"{here()}: ** takes a whole number that is not negative; write {cure}")
        if exponent > LARGEST:
            raise DefinitionError(f"{here()}: ** takes a whole number up to {LARGEST}; write exp(y * log(x))")
        if exponent == 0:
            return self * 0 + 1
        half = self ** (exponent // 2) if exponent > 1 else None
        square = self if half is None else half * half
        return square * self if half is not None and exponent % 2 else square

    def __rpow__(self, base: float) -> NoReturn:
        cure = for_operator_here(Vector, user_frame()) or "exp(x * log(base)) for base ** x"
        raise DefinitionError(f"{here()}: ** takes a whole number that is not negative; write {cure}")

    def __rmatmul__(self, matrix: NDArray[Any]) -> Vector:
        """``M @ v`` with a constant matrix."""
        return _constant_product(matrix, self)

    def __lt__(self, other: VectorLike) -> Condition:
        return _compare("lt", "{0} < {1}", self, other)

    def __gt__(self, other: VectorLike) -> Condition:
        return _compare("lt", "{0} < {1}", other, self)

    def __le__(self, other: VectorLike) -> Condition:
        return _compare("le", "{0} <= {1}", self, other)

    def __ge__(self, other: VectorLike) -> Condition:
        return _compare("le", "{0} <= {1}", other, self)

    @overload
    def __getitem__(self, index: SupportsIndex) -> R1: ...
    @overload
    def __getitem__(self, index: slice) -> Vector: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Vector:
        picked = positions(self, len(self), index)
        cls = vector_class(len(picked))
        return apply(take(cls, len(self), picked, single=not isinstance(index, slice)), cls, self)

    def __iter__(self) -> Iterator[R1]:
        return (self[k] for k in range(len(self)))

    def __len__(self) -> int:
        return self.form.dim

    def range(self, other: Vector) -> R1:
        """Euclidean distance to another point; 0 with gradient 0 where both coincide."""
        return norm(as_vector(other, self.form.dim, "range") - self)


class R(Vector):
    """Base of the vector spaces: ``class R12(R, dim=12)`` makes the annotation of larger vectors.

    ``R(12)`` is that class too: an annotation, or ``R12 = R(12)``.
    """

    __slots__ = ()

    def __init_subclass__(cls, dim: int = 0, **kwargs: Any) -> None:
        usage = f"class {cls.__name__}(R, dim=12)"
        if kwargs:
            raise DefinitionError(f"{here()}: {cls.__name__}: only dim= is known; write {usage}")
        super().__init_subclass__()
        cls.form = rform(dimension(dim, f"{here()}: {cls.__name__}", usage))

    def __new__(cls, *entries: float | Vector) -> Self:
        """From its entries, numbers or scalars: ``R3(1, 2, x[0])``."""
        if cls is R:
            size: Any = entries[0] if len(entries) == 1 else entries
            usage = "R(12), or R3(1, 2, 3) for a vector of numbers"
            sized: Any = vector_class(dimension(size, f"{here()}: R", usage))
            return sized
        if not entries:
            cure = f"{cls.__name__}.identity() is that of zeros"
            raise DefinitionError(f"{here()}: {cls.__name__} needs {cls.form.dim} entries, got none; {cure}")
        v = stack(*entries)
        if len(v) != cls.form.dim:
            raise DefinitionError(f"{here()}: {cls.__name__} needs {cls.form.dim} entries, got {len(v)}")
        return cls.holding(v._coords, v._node)  # pyright: ignore[reportPrivateUsage]


@cache
def rform(n: int) -> RForm:
    """The one closed-form record of R^n."""
    return RForm(n)


class R1(R, dim=1):
    """A scalar."""

    __slots__ = ()


class R2(R, dim=2):
    """The plane."""

    __slots__ = ()


class R3(R, dim=3):
    """Space."""

    __slots__ = ()


class R4(R, dim=4):
    """Vectors with 4 components."""

    __slots__ = ()


class R5(R, dim=5):
    """Vectors with 5 components."""

    __slots__ = ()


class R6(R, dim=6):
    """Vectors with 6 components."""

    __slots__ = ()


class R7(R, dim=7):
    """Vectors with 7 components."""

    __slots__ = ()


class R8(R, dim=8):
    """Vectors with 8 components."""

    __slots__ = ()


class R9(R, dim=9):
    """Vectors with 9 components."""

    __slots__ = ()


VectorLike = Vector | float | Sequence[float] | NDArray[Any]
_NAMED: tuple[type[R], ...] = (R1, R2, R3, R4, R5, R6, R7, R8, R9)


@cache
def vector_class(n: int) -> type[Vector]:
    """``R1`` to ``R9``, or a class made for a larger n. Raises DefinitionError where n is too large."""
    return _NAMED[n - 1] if n <= len(_NAMED) else type(f"R{n}", (R,), {"__slots__": ()}, dim=n)


def as_vector(v: Any, dim: int | None = None, where: str = "this operation") -> Vector:
    """Coerce numbers, sequences and arrays (..., n) to a constant vector, or a batch of them.

    Raises DefinitionError for anything that is no vector, and for a dimension other than ``dim``.
    """
    if isinstance(v, list | tuple) and any(isinstance(x, Value) for x in v):  # pyright: ignore[reportUnknownVariableType]
        v = stack(*v)  # pyright: ignore[reportUnknownArgumentType]
    if not isinstance(v, Vector):
        if isinstance(v, Value):
            cure = for_no_vector(type(v), formula(v), user_frame())
            raise DefinitionError(
                f"{here()}: {where} needs a vector, got {called(v)}" + (f"; write {cure}" if cure else "")
            )
        numbers = np.atleast_1d(real_numbers(v, f"{here()}: {where} needs a vector or numbers"))
        if 0 in numbers.shape[-1:]:
            raise DefinitionError(f"{here()}: {where} needs a vector, got an array of shape {numbers.shape}")
        if dim is not None and numbers.shape[-1] != dim:
            raise DefinitionError(
                f"{here()}: {where} needs a vector with {dim} entries, or an array of shape (..., {dim}), "
                f"got R{numbers.shape[-1]} with {numbers.shape[-1]}, an array of shape {numbers.shape}"
            )
        v = vector_class(numbers.shape[-1]).from_storage(numbers)
    if dim is not None and len(v) != dim:
        raise DefinitionError(
            f"{here()}: {where} needs a vector with {dim} entries, got {called(v)} with {len(v)}; "
            "take a slice or stack() to fit"
        )
    return v


def _binary(name: str, a: Any, b: Any) -> Any:
    f, partials, show = ARITHMETIC[name]
    return _elementwise(name, show, (a, b), f, partials)


def _elementwise(
    name: str, show: str, operands: Sequence[Any], f: Elementwise, partials: Partials | None
) -> Any:
    """An elementwise operation; without ``partials`` CasADi differentiates it."""
    vectors = [as_vector(v, where=name) for v in operands]
    n = max(len(v) for v in vectors)
    if any(len(v) not in (1, n) for v in vectors):
        raise DefinitionError(
            f"{here()}: {name} of {' and '.join(map(called, vectors))}; "
            "both need the same dimension, or one a scalar"
        )

    cls = vector_class(n)
    return apply(elementwise(cls, n, name, show, f, partials), cls, *vectors)


def unary(name: str, v: Vector | float) -> Any:
    """A scalar function of the backends, entry by entry, differentiated by CasADi."""
    return _elementwise(name, name + "({0})", (v,), lambda a: call(name, a), None)


def binary(name: str, show: str, a: Any, b: Any, f: Elementwise, partials: Partials | None = None) -> Any:
    """An elementwise function of two vectors."""
    return _elementwise(name, show, (a, b), f, partials)


def _compare(name: str, show: str, a: Any, b: Any) -> Condition:
    vectors = as_vector(a, where="a comparison"), as_vector(b, where="a comparison")
    if any(len(v) != 1 for v in vectors):
        entries, lengths = (" < ".join(spoken_as(v, t) for v in vectors) for t in ("{}[0]", "norm({})"))
        raise DefinitionError(
            f"{here()}: a comparison is of two scalars, got {' and '.join(map(called, vectors))}; "
            f"write {entries} for entries, {lengths} for lengths"
        )
    return apply(comparison(Condition, name, show), Condition, *vectors)


def _constant_product(matrix: Any, v: Vector) -> Vector:
    if isinstance(matrix, Value):
        cure = for_operator_here(type(matrix), user_frame()) or "dot(x, y) for x @ y"
        raise DefinitionError(f"{here()}: @ does not take {called(matrix)} and {called(v)}; write {cure}")
    numbers = real_numbers(matrix, f"{here()}: matrix @ {called(v)} needs a matrix with {len(v)} columns")
    if numbers.ndim != 2 or numbers.shape[1] != len(v):
        raise DefinitionError(
            f"{here()}: a matrix of shape {numbers.shape} cannot multiply {called(v)}; "
            f"it needs {len(v)} columns"
        )
    cls = vector_class(len(numbers))
    return apply(constant_product(cls, numbers.tolist()), cls, v)


def stack(*parts: VectorLike) -> Vector:
    """Join vectors, scalars and numbers to one vector."""
    vectors = [as_vector(p, where="stack") for p in parts]
    if not vectors:
        raise DefinitionError(f"{here()}: stack() needs at least one part")
    if len(vectors) == 1:
        return vectors[0]
    sizes = [len(v) for v in vectors]
    cls = vector_class(sum(sizes))
    return apply(join(cls, sizes), cls, *vectors)


def norm(v: VectorLike) -> R1:
    """Euclidean length; at 0, and at a difference that is but rounding, its gradient is 0. No overflow."""
    return apply(length_of(R1), R1, as_vector(v, where="norm"))
