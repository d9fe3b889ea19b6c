"""SO(2): closed forms on (cos, sin)."""

from __future__ import annotations

from liegen.algebra import atan2, cos, sin
from liegen.algebra.linear import Chain, Matrix, Vector

from .form import Coords, RotationForm


class SO2Form(RotationForm):
    """Rotations of the plane, the unit circle."""

    name = "SO2"
    storage = ("c", "s")
    tangent = ("angle [rad]",)
    note = "SO2: stored (cos, sin); tangent: angle [rad]; x.retract(d) = x exp(d)"
    space = 2

    def identity(self) -> Vector:
        return (1, 0)

    def compose(self, a: Coords, b: Coords) -> Vector:
        (c, s), (u, v) = a, b
        return (c * u - s * v, s * u + c * v)

    def inverse(self, a: Coords) -> Vector:
        return (a[0], -a[1])

    def exp(self, d: Coords) -> Vector:
        return (cos(d[0]), sin(d[0]))

    def log(self, a: Coords) -> Vector:
        return (atan2(a[1], a[0]),)

    def adjoint(self, a: Coords) -> Chain:
        return (((1,),),)

    def Jr(self, d: Coords) -> Matrix:
        return ((1,),)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        return ((1,),)

    def matrix(self, a: Coords) -> Matrix:
        c, s = a
        return ((c, -s), (s, c))

    def rotate(self, a: Coords, v: Coords) -> Vector:
        (c, s), (x, y) = a, v
        return (c * x - s * y, s * x + c * y)

    def generator(self, v: Coords) -> Matrix:
        return ((-v[1],), (v[0],))
