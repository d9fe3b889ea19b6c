"""``Pose``: what poses of the plane and of space have in common. T_WB is the pose of body B in world W."""

from __future__ import annotations

from typing import Any, ClassVar, Generic, Self, TypeVar, overload

from liegen.algebra.linear import beside, eye, matvec, negated, stacked, sub, transpose, zeros
from liegen.errors import DefinitionError

from .form import Blocks, Coords, PoseForm
from .group import Group, Manifold, composes, tangent_class
from .node import Operation, Value, apply, called, here
from .rotation import Rotation
from .vector import R1, Vector, VectorLike, as_vector, norm

Q = TypeVar("Q", bound="Rotation[Any]")
P = TypeVar("P", bound=Vector)
B = TypeVar("B", bound=Manifold)


class Pose(Group, Generic[Q, P, B]):
    """A pose (R, t): rotation type Q, points P, bearings B. ``@`` composes with a pose and moves a point."""

    __slots__ = ()
    form: ClassVar[PoseForm]  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class: ClassVar[type[Any]]
    bearing_class: ClassVar[type[Any]]

    def __new__(cls, rotation: Q, translation: VectorLike) -> Self:
        """From a rotation and a translation [m]."""
        form = cls.form
        value: Any = rotation
        if not isinstance(value, cls.rotation_class):
            raise DefinitionError(
                f"{here()}: {cls.__name__}(rotation, translation) needs a {cls.rotation_class.__name__}, "
                f"got {called(value) if isinstance(value, Value) else type(value).__name__}"
                + ("; write the rotation first" if isinstance(translation, cls.rotation_class) else "")
            )
        t = as_vector(translation, form.rotation.space, f"{cls.__name__}(rotation, translation)")

        def blocks(_: Coords, q: Coords, _t: Coords) -> Blocks:
            """The rotation moves alone, the translation seen from the body."""
            space, dim = form.rotation.space, form.rotation.dim
            turn = form.in_order(eye(dim), zeros(space, dim))
            move = form.in_order(zeros(dim, space), eye(space))
            return (stacked(*turn),), (stacked(*move), *form.rotation.turned(q, inverse=True))

        return apply(Operation("pose", cls, form.join, blocks, cls.__name__ + "({0}, {1})"), cls, rotation, t)

    @property
    def rotation(self) -> Q:
        """R, the orientation of the body in the world."""
        form = self.form
        block = beside(*form.in_order(eye(form.rotation.dim), zeros(form.rotation.dim, form.rotation.space)))
        operation = Operation(
            "rotation", self.rotation_class, form.rotation_of, lambda _r, _x: ((block,),), "{0}.rotation"
        )
        return apply(operation, self.rotation_class, self)

    @property
    def translation(self) -> P:
        """t, the position of the body in the world [m]."""
        form = self.form

        def blocks(_: Coords, x: Coords) -> Blocks:
            space, dim = form.rotation.space, form.rotation.dim
            return ((*form.turned(x), beside(*form.in_order(zeros(space, dim), eye(space)))),)

        return self._point(
            Operation("translation", self._points, form.translation_of, blocks, "{0}.translation")
        )

    def transform_from(self, p: VectorLike) -> P:
        """R p + t: a point of the body in the world."""
        form = self.form

        def value(x: Coords, p: Coords) -> Any:
            moved = matvec(form.rotation.matrix(form.rotation_of(x)), p)
            return tuple(a + b for a, b in zip(moved, form.translation_of(x), strict=True))

        def blocks(_: Coords, x: Coords, p: Coords) -> Blocks:
            moved = matvec(form.rotation.matrix(form.rotation_of(x)), p)
            return (*form.turned(x), *form.lever(x, p, moved)), form.turned(x)

        return self._point(
            Operation("transform_from", self._points, value, blocks, "{0}.transform_from({1})"), p
        )

    def transform_to(self, p: VectorLike) -> P:
        """R^T (p - t): a point of the world in the body."""
        form = self.form

        def value(x: Coords, p: Coords) -> Any:
            return matvec(
                transpose(form.rotation.matrix(form.rotation_of(x))), sub(p, form.translation_of(x))
            )

        def blocks(q: Coords, x: Coords, p: Coords) -> Blocks:
            by_pose = negated(form.lever(x, q, sub(p, form.translation_of(x))))
            return by_pose, form.turned(x, inverse=True)

        return self._point(Operation("transform_to", self._points, value, blocks, "{0}.transform_to({1})"), p)

    def range(self, other: Self | VectorLike) -> R1:
        """Distance to a point or to another pose's position [m]; 0 with gradient 0 where both coincide."""
        return norm(self._position(other, "range") - self.translation)

    def bearing(self, other: Self | VectorLike) -> B:
        """Direction, seen from the body, of a point or of another pose's position."""
        return self.bearing_class.direction(self.transform_to(self._position(other, "bearing")))

    @property
    def _points(self) -> type[Vector]:
        return tangent_class(self.form.rotation.space)

    def _point(self, operation: Operation, *points: VectorLike) -> Any:
        where = f"{self.form.name}.{operation.name}"
        return apply(
            operation,
            operation.result,
            self,
            *(as_vector(p, self.form.rotation.space, where) for p in points),
        )

    def _position(self, other: Any, where: str) -> P:
        if isinstance(other, Pose) and other.form.name == self.form.name:  # pyright: ignore[reportUnknownMemberType]
            return other.translation  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
        point: Any = as_vector(other, self.form.rotation.space, f"{self.form.name}.{where}")
        return point

    @overload
    def __matmul__(self, other: Self) -> Self: ...
    @overload
    def __matmul__(self, other: VectorLike) -> P: ...
    def __matmul__(self, other: Any) -> Any:
        is_pose = composes(self.form, self.form.rotation.space, other)
        value: Any = other
        return self.compose(value) if is_pose else self.transform_from(value)
