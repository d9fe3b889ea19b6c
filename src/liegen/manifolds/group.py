"""``Manifold`` and ``Group``: the typed operations that every manifold and every group has."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from liegen.advice import for_made, for_operator_here
from liegen.algebra import Scalar
from liegen.algebra.linear import Matrix
from liegen.errors import DefinitionError

from .form import GroupForm, ManifoldForm
from .given import real_numbers
from .node import Operation, V, Value, apply, called, here, shown_storage, user_frame
from .rn_form import RForm

if TYPE_CHECKING:
    from .vector import Vector, VectorLike


#: Numbers that overflow, or have no value, give inf or NaN; NumPy's warning would name a line of liegen.
_QUIET = np.errstate(all="ignore")


@cache
def tangent_class(n: int) -> type[Vector]:
    """The class of vectors with n components (vectors are groups too: hence the late import)."""
    from .vector import vector_class

    return vector_class(n)


def as_tangent(v: VectorLike, form: ManifoldForm, where: str) -> Vector:
    """Coerce to a tangent vector of ``form``. Raises DefinitionError for another dimension."""
    from .vector import as_vector

    return as_vector(v, form.dim, where)


def as_element(operation: str, x: V, y: V | object) -> V:
    """Coerce ``y`` to an element of the manifold of ``x``: one of its own, or stored numbers (..., n).

    Raises DefinitionError for anything else.
    """
    if isinstance(y, Value):
        if x.form != y.form:
            write = for_operator_here(type(x), user_frame(), type(y)) if operation == "compose" else ""
            raise DefinitionError(
                f"{here()}: {operation} needs two elements of one manifold, got {called(x)} and {called(y)}; "
                f"give it two of {x.form.name}" + (f": write {write}" if write else "")
            )
        return y  # pyright: ignore[reportReturnType]
    form, what = x.form, f"{here()}: {operation} of {called(x)} needs another {x.form.name}"
    numbers = real_numbers(y, what)
    if numbers.ndim == 0 and form.size == 1:
        numbers = numbers[None]
    if numbers.ndim == 0 or numbers.shape[-1] != form.size:
        tangent = numbers.ndim and numbers.shape[-1] == form.dim and isinstance(form, GroupForm)
        cure = f"; {form.name}.exp makes an element of a tangent vector" if tangent else ""
        raise DefinitionError(
            f"{what}, or its stored numbers (..., {form.size}) ({shown_storage(form.storage)}), "
            f"got an array of shape {numbers.shape}{cure}"
        )
    return type(x).from_storage(numbers)


def composes(form: GroupForm, space: int, other: object) -> bool:
    """Whether ``x @ other`` is a product of elements; an array is where it is too long for a point."""
    if isinstance(other, Value):
        return isinstance(other, Group) and not isinstance(other.form, RForm)
    shape: tuple[int, ...] = np.shape(other) if type(other) is np.ndarray else ()
    return shape[-1:] == (form.size,) and form.size != space


class Manifold(Value):
    """An element of a manifold."""

    __slots__ = ()

    if not TYPE_CHECKING:  # classes that are made of parts have their own

        def __new__(cls, *_: object, **__: object) -> Any:
            """Raises DefinitionError with the ways to make an element."""
            stored = shown_storage(cls.form.storage) if hasattr(cls, "form") else "..."
            cure = for_made(cls, user_frame()) or f"{cls.__name__}.from_storage([{stored}])"
            raise DefinitionError(f"{here()}: {cls.__name__} is not made of parts; write {cure}")

    def retract(self, d: VectorLike) -> Self:
        """The point that the tangent vector ``d`` of shape (..., dim) at self leads to."""
        form = self.form
        operation = Operation("retract", type(self), form.retract, form.retract_blocks(), "{0}.retract({1})")
        return apply(operation, type(self), self, as_tangent(d, form, f"{form.name}.retract"))

    def local(self, other: Self) -> Vector:
        """The tangent vector at self that leads to ``other``; inverse of ``retract``."""
        other = as_element("local", self, other)
        form, result = self.form, tangent_class(self.form.dim)
        operation = Operation("local", result, form.local, form.local_blocks(), "{0}.local({1})")
        return apply(operation, result, self, other)


class Group(Manifold):
    """An element of a Lie group. ``@`` composes."""

    __slots__ = ()
    form: ClassVar[GroupForm]  # pyright: ignore[reportIncompatibleVariableOverride]

    @classmethod
    def identity(cls) -> Self:
        """The neutral element."""
        return cls.holding([np.float64(c) for c in cls.form.identity()])

    @classmethod
    def exp(cls, d: VectorLike) -> Self:
        """The exponential of a tangent vector of shape (..., dim)."""
        form = cls.form
        operation = Operation("exp", cls, form.exp, form.exp_blocks(), cls.__name__ + ".exp({0})")
        return apply(operation, cls, as_tangent(d, form, f"{form.name}.exp"))

    def log(self) -> Vector:
        """The logarithm, a tangent vector; inverse of ``exp`` for rotations below pi."""
        result = tangent_class(self.form.dim)
        return apply(
            Operation("log", result, self.form.log, self.form.log_blocks(), "{0}.log()"), result, self
        )

    def compose(self, other: Self) -> Self:
        """The product self * other."""
        other = as_element("compose", self, other)
        operation = Operation(
            "compose", type(self), self.form.compose, self.form.compose_blocks(), "{0}.compose({1})"
        )
        return apply(operation, type(self), self, other)

    def inverse(self) -> Self:
        """The inverse element."""
        operation = Operation(
            "inverse", type(self), self.form.inverse, self.form.inverse_blocks(), "{0}.inverse()"
        )
        return apply(operation, type(self), self)

    def between(self, other: Self) -> Self:
        """The product self^-1 * other: ``other`` as seen from self."""
        other = as_element("between", self, other)
        operation = Operation(
            "between", type(self), self.form.between, self.form.between_blocks(), "{0}.between({1})"
        )
        return apply(operation, type(self), self, other)

    @_QUIET
    def matrix(self) -> NDArray[Any]:
        """The element as a matrix of shape (..., n, n)."""
        return as_array(self.form.matrix(self.coords))

    @_QUIET
    def adjoint(self) -> NDArray[Any]:
        """Ad with self exp(d) = exp(Ad d) self, of shape (..., dim, dim)."""
        return as_array(self.form.adjoint_matrix(self.coords))

    @classmethod
    @_QUIET
    def Jr(cls, d: VectorLike) -> NDArray[Any]:
        """Right Jacobian of exp at d, of shape (..., dim, dim)."""
        return as_array(cls.form.Jr(as_tangent(d, cls.form, f"{cls.__name__}.Jr").coords))

    @classmethod
    @_QUIET
    def Jl(cls, d: VectorLike) -> NDArray[Any]:
        """Left Jacobian of exp at d."""
        return as_array(cls.form.Jl(as_tangent(d, cls.form, f"{cls.__name__}.Jl").coords))

    @classmethod
    @_QUIET
    def Jr_inv(cls, d: VectorLike) -> NDArray[Any]:
        """Inverse of the right Jacobian; singular where the rotation is a multiple of 2 pi, 0 excepted."""
        return as_array(cls.form.Jr_inv(as_tangent(d, cls.form, f"{cls.__name__}.Jr_inv").coords))

    @classmethod
    @_QUIET
    def Jl_inv(cls, d: VectorLike) -> NDArray[Any]:
        """Inverse of the left Jacobian."""
        return as_array(cls.form.Jl_inv(as_tangent(d, cls.form, f"{cls.__name__}.Jl_inv").coords))


def as_array(matrix: Matrix | Sequence[Sequence[Scalar]]) -> NDArray[Any]:
    """An array (..., rows, columns); of objects when the scalars are no floats."""
    entries = [x for row in matrix for x in row]
    exact = any(type(x).__module__.partition(".")[0] in ("mpmath", "sympy", "casadi") for x in entries)
    if exact:
        return np.array([list(row) for row in matrix], dtype=object)
    parts = np.broadcast_arrays(*[np.asarray(x, dtype=np.float64) for x in entries])
    flat = np.stack(parts, axis=-1)
    return flat.reshape(*flat.shape[:-1], len(matrix), len(matrix[0]))
