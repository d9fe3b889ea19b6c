"""Extended poses: a rotation with a position and a velocity. T_WB holds those of body B in world W."""

from __future__ import annotations

from typing import Any, ClassVar, Self

from liegen.algebra.linear import Matrix, eye, stacked, transpose, zeros
from liegen.algebra.linear import Vector as Coordinates
from liegen.errors import DefinitionError

from .form import Blocks, Coords, Rule
from .group import Group
from .groups import SE3, SO3
from .nav_state_form import NavStateForm
from .node import Operation, Value, apply, called, here
from .part import part
from .se23_form import SE23Form
from .vector import R3, VectorLike, as_vector


def needs_rotation(rotation: object, where: str) -> None:
    """Raise DefinitionError unless it is an SO3."""
    if not isinstance(rotation, SO3):
        shown = called(rotation) if isinstance(rotation, Value) else type(rotation).__name__
        raise DefinitionError(f"{here()}: {where} needs an SO3, got {shown}")


class ExtendedPose(Group):
    """(R, p, v): orientation, position [m] and velocity [m/s] of a body in the world. ``@`` composes."""

    __slots__ = ()
    form: ClassVar[SE23Form]  # pyright: ignore[reportIncompatibleVariableOverride]

    def __new__(cls, rotation: SO3, position: VectorLike, velocity: VectorLike) -> Self:
        """From a rotation, a position [m] and a velocity [m/s]."""
        where = f"{cls.__name__}(rotation, position, velocity)"
        needs_rotation(rotation, where)
        operation = Operation("extended_pose", cls, _join, _join_blocks, cls.__name__ + "({0}, {1}, {2})")
        p, v = as_vector(position, 3, where), as_vector(velocity, 3, where)
        return apply(operation, cls, rotation, p, v)

    @property
    def rotation(self) -> SO3:
        """R, the orientation of the body in the world."""
        return part(self, "rotation", SO3, slice(4), lambda _r, _x: ((eye(9)[:3],),))

    @property
    def position(self) -> R3:
        """p, the position of the body in the world [m]."""
        return part(self, "position", R3, slice(4, 7), _turned(eye(9)[3:6]))

    @property
    def velocity(self) -> R3:
        """v, the velocity of the body in the world [m/s]."""
        return part(self, "velocity", R3, slice(7, 10), _turned(eye(9)[6:]))

    @property
    def pose(self) -> SE3:
        """(R, p), the pose of the body in the world."""
        return part(self, "pose", SE3, slice(7), lambda _r, _x: ((eye(9)[:6],),), "pose_of")

    def __matmul__(self, other: Self) -> Self:
        return self.compose(other)


def _turned(rows: Matrix) -> Rule:
    """A vector that moves in the body: dp = R d."""
    return lambda _, x: ((SO3.form.matrix(x[:4]), rows),)


def _join(q: Coords, p: Coords, v: Coords) -> Coordinates:
    return (*q, *p, *v)


def _join_blocks(_: Coords, q: Coords, _p: Coords, _v: Coords) -> Blocks:
    """The rotation moves alone, each vector seen from the body."""
    Rt, z = transpose(SO3.form.matrix(q)), zeros(3, 3)
    columns: tuple[Any, ...] = (stacked(eye(3), z, z), stacked(z, Rt, z), stacked(z, z, Rt))
    return tuple((c,) for c in columns)


class SE23(ExtendedPose):
    """An extended pose; ``retract`` is the group's exponential chart."""

    __slots__ = ()
    form: ClassVar[SE23Form] = SE23Form()  # pyright: ignore[reportIncompatibleVariableOverride]


class NavState(ExtendedPose):
    """An extended pose with the chart of GTSAM's NavState: each component moves on its own."""

    __slots__ = ()
    form: ClassVar[NavStateForm] = NavStateForm()  # pyright: ignore[reportIncompatibleVariableOverride]
