"""``Gal3``: orientation, position, velocity and time of a body, an element of the Galilean group."""

from __future__ import annotations

from typing import ClassVar, Self

from liegen.algebra.linear import Vector as Coordinates
from liegen.algebra.linear import beside, column, eye, matvec, negate, stacked, transpose, zeros

from .extended import needs_rotation
from .form import Blocks, Coords
from .gal3_form import Gal3Form
from .group import Group
from .groups import SE3, SO3
from .node import Operation, apply
from .part import part
from .vector import R1, R3, VectorLike, as_vector


class Gal3(Group):
    """(R, p, v, t): orientation, position [m] and velocity [m/s] in the world, time [s]. ``@`` composes.

    x.compose(y) puts the event y after x: p = p_x + R_x p_y + v_x t_y.
    """

    __slots__ = ()
    form: ClassVar[Gal3Form] = Gal3Form()  # pyright: ignore[reportIncompatibleVariableOverride]

    def __new__(cls, rotation: SO3, position: VectorLike, velocity: VectorLike, time: VectorLike) -> Self:
        """From a rotation, a position [m], a velocity [m/s] and a time [s]."""
        where = f"{cls.__name__}(rotation, position, velocity, time)"
        needs_rotation(rotation, where)
        operation = Operation("event", cls, _join, _join_blocks, cls.__name__ + "({0}, {1}, {2}, {3})")
        p, v, t = as_vector(position, 3, where), as_vector(velocity, 3, where), as_vector(time, 1, where)
        return apply(operation, cls, rotation, p, v, t)

    @property
    def rotation(self) -> SO3:
        """R, the orientation of the body in the world."""
        return part(self, "rotation", SO3, slice(4), lambda _r, _x: ((eye(10)[:3],),))

    @property
    def position(self) -> R3:
        """p, the position of the body in the world [m]; it moves with the time too: dp = R rho + v iota."""

        def blocks(_: Coords, x: Coords) -> Blocks:
            return ((beside(zeros(3, 3), SO3.form.matrix(x[:4]), zeros(3, 3), column(x[7:10])),),)

        return part(self, "position", R3, slice(4, 7), blocks)

    @property
    def velocity(self) -> R3:
        """v, the velocity of the body in the world [m/s]."""
        rows = eye(10)[6:9]
        return part(self, "velocity", R3, slice(7, 10), lambda _, x: ((SO3.form.matrix(x[:4]), rows),))

    @property
    def time(self) -> R1:
        """t [s]."""
        return part(self, "time", R1, slice(10, 11), lambda _r, _x: ((eye(10)[9:],),))

    @property
    def pose(self) -> SE3:
        """(R, p), the pose of the body in the world."""

        def blocks(_: Coords, x: Coords) -> Blocks:
            drift = matvec(transpose(SO3.form.matrix(x[:4])), x[7:10])
            return ((beside(eye(6), zeros(6, 3), column((0, 0, 0, *drift))),),)

        return part(self, "pose", SE3, slice(7), blocks, "pose_of")

    def __matmul__(self, other: Self) -> Self:
        return self.compose(other)


def _join(q: Coords, p: Coords, v: Coords, t: Coords) -> Coordinates:
    return (*q, *p, *v, *t)


def _join_blocks(_: Coords, q: Coords, _p: Coords, v: Coords, _t: Coords) -> Blocks:
    """The rotation moves alone, vectors are seen from the body; where time moves the position stays."""
    Rt = transpose(SO3.form.matrix(q))
    z, none = zeros(3, 3), zeros(1, 3)
    drift = column((0, 0, 0, *negate(matvec(Rt, v)), 0, 0, 0, 1))
    turn = stacked(eye(3), z, z, none)
    return (turn,), (stacked(z, Rt, z, none),), (stacked(z, z, Rt, none),), (drift,)
