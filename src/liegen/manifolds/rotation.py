"""``Rotation``: what rotations of the plane and of space have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Generic, NoReturn, Self, TypeVar, overload

from numpy.typing import NDArray

from liegen.algebra.linear import eye, matvec, negated, transpose
from liegen.errors import DefinitionError

from .form import Blocks, Coords, RotationForm
from .group import Group, composes, tangent_class
from .node import Operation, apply, called, here, refuse
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
        products of such, and the entries ``[i, j]``, rows ``[i]`` and columns ``[:, j]``.
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

    def __getitem__(self, index: Any) -> Any:
        """An entry ``[i, j]``, a row ``[i]`` or ``[i, :]``, a column ``[:, j]``.

        Raises DefinitionError for any other index: larger blocks are no vectors.
        """
        given: tuple[Any, ...] = index if index.__class__ is tuple else (index,)
        row, column = given if len(given) == 2 else (given[0] if len(given) == 1 else None, slice(None))
        n, whole = self.rotation.form.space, slice(None)
        picked = [k for k in (row, column) if k != whole]
        if not picked or not all(type(k) is int and -n <= k < n for k in picked):
            raise DefinitionError(
                f"{here()}: the matrix of {called(self.rotation)} has the entries [i, j] with i, j from 0 to "
                f"{n - 1}, the rows [i] and the columns [:, j]; write a block as several of them"
            )
        axes: Any = eye(n)
        if row == whole:
            return self @ [float(x) for x in axes[column]]
        entries = self.T @ [float(x) for x in axes[row]]
        return entries if column == whole else entries[column]

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
