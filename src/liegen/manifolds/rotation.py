"""``Rotation``: what rotations of the plane and of space have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Generic, NoReturn, Self, TypeVar, overload

from numpy.typing import NDArray

from liegen.algebra.linear import matvec, negated, transpose

from .form import Blocks, Coords, RotationForm
from .group import Group, composes, tangent_class
from .node import Operation, apply, refuse
from .vector import Vector, VectorLike, as_vector

P = TypeVar("P", bound=Vector)


class Rotation(Group, Generic[P]):
    """A rotation R. ``@`` composes with a rotation and turns a vector."""

    __slots__ = ()
    form: ClassVar[RotationForm]  # pyright: ignore[reportIncompatibleVariableOverride]

    def rotate(self, v: VectorLike) -> P:
        """R v."""
        form = self.form

        def blocks(_: Coords, q: Coords, v: Coords) -> Blocks:
            return (*form.turned(q), *form.lever(q, v, matvec(form.matrix(q), v))), form.turned(q)

        return self._turn(
            Operation(
                "rotate",
                tangent_class(form.space),
                lambda q, v: matvec(form.matrix(q), v),
                blocks,
                "{0} @ {1}",
            ),
            v,
        )

    def unrotate(self, v: VectorLike) -> P:
        """R^-1 v."""
        form = self.form

        def blocks(w: Coords, q: Coords, v: Coords) -> Blocks:
            return negated(form.lever(q, w, v)), form.turned(q, inverse=True)

        def value(q: Coords, v: Coords) -> Any:
            return matvec(transpose(form.matrix(q)), v)

        return self._turn(
            Operation("unrotate", tangent_class(form.space), value, blocks, "{0}.unrotate({1})"), v
        )

    def matrix(self) -> NDArray[Any]:
        """R as an array of shape (..., n, n).

        While a factor is traced it is what matrices are for: ``R.matrix() @ v``, ``v @ R.matrix()``, ``.T``,
        and products of such.
        """
        traced: Any = RotationMatrix(self)
        return traced if self.traced else super().matrix()

    def _turn(self, operation: Operation, v: VectorLike) -> Any:
        where = f"{self.form.name}.{operation.name}"
        return apply(operation, operation.result, self, as_vector(v, self.form.space, where))

    @overload
    def __matmul__(self, other: Self) -> Self: ...
    @overload
    def __matmul__(self, other: VectorLike) -> P: ...
    def __matmul__(self, other: Any) -> Any:
        is_rotation = composes(self.form, self.form.space, other)
        value: Any = other
        return self.compose(value) if is_rotation else self.rotate(value)


@dataclass(frozen=True, eq=False)
class RotationMatrix:
    """The matrix of a rotation that is being traced: it multiplies, as :class:`Rotation` does."""

    rotation: Rotation[Any]
    transposed: bool = False
    __array_ufunc__ = None  # NumPy's arrays leave products to it

    @property
    def T(self) -> RotationMatrix:
        """The transpose."""
        return RotationMatrix(self.rotation, not self.transposed)

    def transpose(self) -> RotationMatrix:
        """The same as ``T``."""
        return self.T

    def __matmul__(self, other: RotationMatrix | VectorLike) -> Any:
        if isinstance(other, RotationMatrix):
            return RotationMatrix(self._element() @ other._element())
        return self.rotation.unrotate(other) if self.transposed else self.rotation.rotate(other)

    def __rmatmul__(self, v: VectorLike) -> Any:
        return self.T @ v

    def _element(self) -> Any:
        return self.rotation.inverse() if self.transposed else self.rotation

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NoReturn:
        refuse(self.rotation, "turn the matrix of {} into a NumPy array")
