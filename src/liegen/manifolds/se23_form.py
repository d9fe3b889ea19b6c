"""SE_2(3), extended poses: closed forms on (quaternion, position, velocity), tangent in the same order.

The group of the matrices [[R, p, v], [0, I]]: two vectors that one rotation turns, each with the closed forms
that SE(3) has for its one. Sources: Barrau, Bonnabel, "The invariant extended Kalman filter as a stable
observer" (2017), section V; Brossard, Barrau, Chauchat, Bonnabel, "Associating uncertainty to extended poses
for on-manifold preintegration" (2022), section III (their order is rotation, velocity, position).
"""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra.linear import (
    Chain,
    Matrix,
    Vector,
    add,
    dot,
    matvec,
    negate,
    sub,
    transpose,
)
from liegen.coefficients import stumpff

from . import dual
from .form import Coords, GroupForm, Source
from .so3_form import SO3Form, series


class SE23Form(GroupForm):
    """Extended poses of space."""

    name = "SE23"
    storage = ("qx", "qy", "qz", "qw", "x", "y", "z", "vx", "vy", "vz")
    tangent = (
        "rx [rad]", "ry [rad]", "rz [rad]", "x [m]", "y [m]", "z [m]", "vx [m/s]", "vy [m/s]", "vz [m/s]",
    )  # fmt: skip
    note = (
        "SE23: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z); "
        "tangent: rotation [rad], position [m], velocity [m/s]; x.retract(d) = x exp(d)"
    )
    quaternions = (0,)
    turns = True
    rotation = SO3Form()

    def identity(self) -> Vector:
        return (*self.rotation.identity(), *(0,) * 6)

    def compose(self, a: Coords, b: Coords) -> Vector:
        """(R_a R_b, p_a + R_a p_b, v_a + R_a v_b)."""
        R = self.rotation.matrix(a[:4])
        p, v = (add(a[k], matvec(R, b[k])) for k in (_POSITION, _VELOCITY))
        return (*self.rotation.compose(a[:4], b[:4]), *p, *v)

    def inverse(self, a: Coords) -> Vector:
        """(R^T, -R^T p, -R^T v)."""
        q = self.rotation.inverse(a[:4])
        R = self.rotation.matrix(q)
        return (*q, *negate(matvec(R, a[_POSITION])), *negate(matvec(R, a[_VELOCITY])))

    def between(self, a: Coords, b: Coords) -> Vector:
        """(R_a^T R_b, R_a^T (p_b - p_a), R_a^T (v_b - v_a))."""
        q = self.rotation.inverse(a[:4])
        R = self.rotation.matrix(q)
        p, v = (matvec(R, sub(b[k], a[k])) for k in (_POSITION, _VELOCITY))
        return (*self.rotation.compose(q, b[:4]), *p, *v)

    def exp(self, d: Coords) -> Vector:
        """(exp(phi), V rho, V nu) with V = Jl(phi) = I + c2 [phi]x + c3 [phi]x^2."""
        phi = d[:3]
        c = stumpff(dot(phi, phi), 5)
        V = series(phi, c[2], c[3])
        return (*self.rotation.exp(phi), *matvec(V, d[3:6]), *matvec(V, d[6:]))

    def log(self, a: Coords) -> Vector:
        """(phi, V^-1 p, V^-1 v); V^-1 is the transpose of Jr^-1, which the Jacobians need too."""
        phi = self.rotation.log(a[:4])
        V = transpose(self.rotation.Jr_inv(phi, principal=True))
        return (*phi, *matvec(V, a[_POSITION]), *matvec(V, a[_VELOCITY]))

    def adjoint(self, a: Coords) -> Chain:
        return dual.adjoint(self.rotation.letter(a[:4]), a[_POSITION], a[_VELOCITY])

    def adjoint_inverse(self, a: Coords) -> Chain:
        return dual.adjoint_inverse(self.rotation.letter(a[:4]), a[_POSITION], a[_VELOCITY])

    def Jr(self, d: Coords) -> Matrix:
        return dual.Jr(d[:3], d[3:6], d[6:])

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        return dual.Jr_inv(d[:3], d[3:6], d[6:], principal=principal)

    def matrix(self, a: Coords) -> Matrix:
        """[[R, p, v], [0, I]], GTSAM's order of the columns."""
        R = self.rotation.matrix(a[:4])
        top = tuple((*row, p, v) for row, p, v in zip(R, a[_POSITION], a[_VELOCITY], strict=True))
        return (*top, (0, 0, 0, 1, 0), (0, 0, 0, 0, 1))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        return (*source.unit(4), *source.vector(3, spread=spread), *source.vector(3))

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        return (*(source.unit(3) * angle), *source.vector(3, offset), *source.vector(3, offset))


_POSITION, _VELOCITY = slice(4, 7), slice(7, 10)
