"""``S2``: directions in space."""

from __future__ import annotations

from typing import ClassVar, Self

from liegen.algebra.linear import transpose

from .group import Manifold
from .node import Operation, apply
from .rn_form import direction
from .s2_form import S2Form, basis
from .vector import R3, VectorLike, as_vector


class S2(Manifold):
    """A unit vector in space, with two tangent directions."""

    __slots__ = ()
    form: ClassVar[S2Form] = S2Form()  # pyright: ignore[reportIncompatibleVariableOverride]

    @classmethod
    def direction(cls, v: VectorLike) -> Self:
        """The direction of a 3-vector; not a number at 0."""
        operation = Operation("direction", cls, direction, cls.form.direction_blocks(), "S2.direction({0})")
        return apply(operation, cls, as_vector(v, 3, "S2.direction"))

    @property
    def vector(self) -> R3:
        """The unit vector."""
        operation = Operation(
            "vector", R3, lambda n: tuple(n), lambda _, n: ((transpose(basis(n)),),), "{0}.vector"
        )
        return apply(operation, R3, self)
