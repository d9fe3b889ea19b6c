"""The groups that users name: SO2, SO3, SE2, SE3. A group's closed forms stand in its ``*_form`` file."""

from __future__ import annotations

from typing import ClassVar, Self

from liegen.algebra.linear import Matrix

from .form import Blocks, Coords
from .node import Operation, apply
from .pose import Pose
from .rn_form import direction, length
from .rotation import Rotation
from .s2 import S2
from .se2_form import SE2Form
from .se3_form import SE3Form
from .so2_form import SO2Form
from .so3_form import SO3Form
from .vector import R2, R3, VectorLike, as_vector


class SO2(Rotation[R2]):
    """A rotation of the plane; also a bearing in the plane."""

    __slots__ = ()
    form: ClassVar[SO2Form] = SO2Form()  # pyright: ignore[reportIncompatibleVariableOverride]

    @classmethod
    def direction(cls, v: VectorLike) -> Self:
        """The rotation that turns the x axis to the direction of ``v``; not a number at 0."""

        def blocks(x: Coords, v: Coords) -> Blocks:
            # the row first: seen from a body it is the direction's own turned by a right angle
            row: Matrix = ((-x[1], x[0]),)
            return ((((1 / length(v),),), row),)

        operation = Operation("direction", cls, direction, blocks, "SO2.direction({0})")
        return apply(operation, cls, as_vector(v, 2, "SO2.direction"))


class SO3(Rotation[R3]):
    """A rotation of space."""

    __slots__ = ()
    form: ClassVar[SO3Form] = SO3Form()  # pyright: ignore[reportIncompatibleVariableOverride]


class SE2(Pose[SO2, R2, SO2]):
    """A pose of the plane."""

    __slots__ = ()
    form: ClassVar[SE2Form] = SE2Form()  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class = SO2
    bearing_class = SO2


class SE3(Pose[SO3, R3, S2]):
    """A pose of space."""

    __slots__ = ()
    form: ClassVar[SE3Form] = SE3Form()  # pyright: ignore[reportIncompatibleVariableOverride]
    rotation_class = SO3
    bearing_class = S2
