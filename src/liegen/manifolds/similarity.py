"""``Similarity``: what similarities of the plane and of space have in common; ``Sim2`` and ``Sim3``."""

from __future__ import annotations

from typing import Any, ClassVar, Generic, Self, TypeVar, overload

from liegen.algebra.linear import Matrix, beside, column, eye, matscale, negate, transpose, zeros
from liegen.algebra.linear import Vector as Coordinates
from liegen.errors import DefinitionError

from .form import Blocks, Coords
from .group import Group, composes, tangent_class
from .groups import SO2, SO3
from .node import Operation, Value, apply, called, here
from .part import part
from .rotation import Rotation
from .sim2_form import Sim2Form
from .sim3_form import Sim3Form
from .similarity_form import SimilarityForm
from .vector import R1, R2, R3, Vector, VectorLike, as_vector

Q = TypeVar("Q", bound="Rotation[Any]")
P = TypeVar("P", bound=Vector)


class Similarity(Group, Generic[Q, P]):
    """(R, t, s), x p = s R p + t, s > 0: rotation type Q, points P. ``@`` composes and moves a point.

    ``translation`` is the image of the origin, as in Sophus; GTSAM's Similarity2 and Similarity3 store t/s.
    Tangents are the same as theirs. A scale that is not positive has no logarithm (not a number).
    """

    __slots__ = ()
    form: ClassVar[SimilarityForm]  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class: ClassVar[type[Any]]

    def __new__(cls, rotation: Q, translation: VectorLike, scale: VectorLike = 1.0) -> Self:
        """From a rotation, a translation [m] and a scale."""
        value: Any = rotation
        where = f"{cls.__name__}(rotation, translation, scale)"
        if not isinstance(value, cls.rotation_class):
            raise DefinitionError(
                f"{here()}: {where} needs a {cls.rotation_class.__name__}, "
                f"got {called(value) if isinstance(value, Value) else type(value).__name__}"
            )
        t, s = as_vector(translation, cls.form.space, where), as_vector(scale, 1, where)

        def blocks(_: Coords, q: Coords, _t: Coords, k: Coords) -> Blocks:
            """The rotation moves alone, the translation and the scale as the body sees them."""
            r = 1 / k[0]
            back = matscale(r, transpose(cls.form.rotation.matrix(q)))
            parts = (eye(cls.form.rotation.dim), back, ((r,),))
            return tuple((transpose(_placed(cls.form, i, transpose(m))),) for i, m in enumerate(parts))

        operation = Operation("similarity", cls, _join, blocks, cls.__name__ + "({0}, {1}, {2})")
        return apply(operation, cls, rotation, t, s)

    @property
    def rotation(self) -> Q:
        """R, the orientation of the body in the world."""
        form = self.form
        rows = _placed(form, 0, eye(form.rotation.dim))
        return part(
            self, "rotation", self.rotation_class, slice(form.rotation.size), lambda _r, _x: ((rows,),)
        )

    @property
    def translation(self) -> P:
        """t, the position of the body's origin in the world [m]."""
        form = self.form

        def blocks(_: Coords, x: Coords) -> Blocks:
            return ((form.linear(x), _placed(form, 1, eye(form.space))),)

        made: Any = tangent_class(form.space)
        return part(self, "translation", made, slice(form.rotation.size, -1), blocks)

    @property
    def scale(self) -> R1:
        """s, the length in the world of a unit of the body."""
        form = self.form

        def blocks(_: Coords, x: Coords) -> Blocks:
            return ((_placed(form, 2, ((form.scale_of(x),),)),),)

        return part(self, "scale", R1, slice(form.size - 1, form.size), blocks)

    def transform_from(self, p: VectorLike) -> P:
        """s R p + t: a point of the body in the world."""
        form = self.form

        def blocks(_: Coords, x: Coords, p: Coords) -> Blocks:
            return (form.linear(x), _moving(form, p)), (form.linear(x),)

        return self._point("transform_from", form.act, blocks, p)

    def transform_to(self, p: VectorLike) -> P:
        """R^T (p - t) / s: a point of the world in the body."""
        form = self.form

        def blocks(q: Coords, x: Coords, _: Coords) -> Blocks:
            back = transpose(form.rotation.matrix(form.rotation_of(x)))
            return (tuple(negate(row) for row in _moving(form, q)),), (matscale(1 / form.scale_of(x), back),)

        return self._point("transform_to", form.act_inverse, blocks, p)

    def _point(self, name: str, value: Any, blocks: Any, p: VectorLike) -> Any:
        result, space = tangent_class(self.form.space), self.form.space
        operation = Operation(name, result, value, blocks, f"{{0}}.{name}({{1}})")
        return apply(operation, result, self, as_vector(p, space, f"{self.form.name}.{name}"))

    @overload
    def __matmul__(self, other: Self) -> Self: ...
    @overload
    def __matmul__(self, other: VectorLike) -> P: ...
    def __matmul__(self, other: Any) -> Any:
        is_group = composes(self.form, self.form.space, other)
        value: Any = other
        return self.compose(value) if is_group else self.transform_from(value)


def _join(q: Coords, t: Coords, s: Coords) -> Coordinates:
    return (*q, *t, *s)


def _placed(form: SimilarityForm, k: int, block: Matrix) -> Matrix:
    """The block in the columns of rotation (0), translation (1) or scale (2), zeros elsewhere."""
    rows = len(block)
    sizes = (form.rotation.dim, form.space, 1)
    parts = [block if i == k else zeros(rows, n) for i, n in enumerate(sizes)]
    return beside(*form.in_order(*parts))


def _moving(form: SimilarityForm, p: Coords) -> Matrix:
    """d(exp(d) p)/dd at 0."""
    return beside(*form.in_order(form.rotation.generator(p), eye(form.space), column(p)))


class Sim2(Similarity[SO2, R2]):
    """A similarity of the plane."""

    __slots__ = ()
    form: ClassVar[Sim2Form] = Sim2Form()  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class = SO2


class Sim3(Similarity[SO3, R3]):
    """A similarity of space."""

    __slots__ = ()
    form: ClassVar[Sim3Form] = Sim3Form()  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class = SO3
