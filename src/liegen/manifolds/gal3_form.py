"""Gal(3), the Galilean group: closed forms on (quaternion, position, velocity, time), tangent alike.

The group of the matrices [[R, v, p], [0, 1, t], [0, 0, 1]]; SE_2(3) are its elements with t = 0. Reference:
J. Kelly, "All about the Galilean group SGal(3)" (2023), cited as "Kelly" (there the order of the tangent is
position, velocity, rotation, time). With c_k the Stumpff functions and D the coefficient of Jr^-1, with
V = I + c2 [phi]x + c3 [phi]x^2 and U = I / 2 + c3 [phi]x + c4 [phi]x^2, the exponential is
(V rho + iota U nu, V nu). V^-1 U = I / 2 - D [phi]x, so logarithm and inverse Jacobians need D and E alone.
"""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra import Scalar, lt, select
from liegen.algebra.linear import (
    Chain,
    Matrix,
    Vector,
    add,
    beside,
    block_diagonal,
    column,
    cross,
    dot,
    eye,
    matadd,
    matscale,
    matvec,
    negate,
    scale,
    skew,
    stacked,
    sub,
    transpose,
    zeros,
)
from liegen.coefficients import inverse_jacobian, stumpff

from . import dual
from .form import Coords, GroupForm, Source
from .so3_form import SO3Form, series

_POSITION, _VELOCITY = slice(4, 7), slice(7, 10)
_RHO, _NU = slice(3, 6), slice(6, 9)
_TINY = 2.0**-100


def _outer(a: Coords, b: Coords) -> Matrix:
    return tuple(scale(x, b) for x in a)


def _polynomial(phi: Coords, a: Scalar, b: Scalar, c: Scalar) -> Matrix:
    """a I + b [phi]x + c [phi]x^2."""
    k = a - c * dot(phi, phi)
    return matadd(matadd(matscale(k, eye(3)), matscale(b, skew(phi))), matscale(c, _outer(phi, phi)))


def _rows(rotation: Matrix, position: tuple[Matrix, Matrix, Matrix, Matrix], turn: Matrix) -> Matrix:
    """[[M, 0, 0, 0], position, [turn, 0, M, 0], [0, 0, 0, 1]], the pattern of all Jacobians and adjoints."""
    z, none = zeros(3, 3), zeros(3, 1)
    return stacked(
        beside(rotation, z, z, none),
        beside(*position),
        beside(turn, z, rotation, none),
        ((0,) * 9 + (1,),),
    )


class Gal3Form(GroupForm):
    """Orientation, position, velocity and time of a body."""

    name = "Gal3"
    storage = ("qx", "qy", "qz", "qw", "x", "y", "z", "vx", "vy", "vz", "t")
    tangent = (
        "rx [rad]", "ry [rad]", "rz [rad]", "x [m]", "y [m]", "z [m]",
        "vx [m/s]", "vy [m/s]", "vz [m/s]", "t [s]",
    )  # fmt: skip
    note = (
        "Gal3: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z), time; "
        "tangent: rotation [rad], position [m], velocity [m/s], time [s]; x.retract(d) = x exp(d)"
    )
    quaternions = (0,)
    turns = True
    rotation = SO3Form()

    def identity(self) -> Vector:
        return (*self.rotation.identity(), *(0,) * 7)

    def compose(self, a: Coords, b: Coords) -> Vector:
        """(R_a R_b, p_a + R_a p_b + v_a t_b, v_a + R_a v_b, t_a + t_b) (Kelly, section 2)."""
        R = self.rotation.matrix(a[:4])
        p = add(add(a[_POSITION], matvec(R, b[_POSITION])), scale(b[10], a[_VELOCITY]))
        v = add(a[_VELOCITY], matvec(R, b[_VELOCITY]))
        return (*self.rotation.compose(a[:4], b[:4]), *p, *v, a[10] + b[10])

    def inverse(self, a: Coords) -> Vector:
        """(R^T, -R^T (p - v t), -R^T v, -t)."""
        q = self.rotation.inverse(a[:4])
        Rt = self.rotation.matrix(q)
        p = matvec(Rt, sub(scale(a[10], a[_VELOCITY]), a[_POSITION]))
        return (*q, *p, *negate(matvec(Rt, a[_VELOCITY])), -a[10])

    def between(self, a: Coords, b: Coords) -> Vector:
        """(R_a^T R_b, R_a^T (p_b - p_a - v_a (t_b - t_a)), R_a^T (v_b - v_a), t_b - t_a)."""
        q = self.rotation.inverse(a[:4])
        Rt, t = self.rotation.matrix(q), b[10] - a[10]
        p = matvec(Rt, sub(sub(b[_POSITION], a[_POSITION]), scale(t, a[_VELOCITY])))
        v = matvec(Rt, sub(b[_VELOCITY], a[_VELOCITY]))
        return (*self.rotation.compose(q, b[:4]), *p, *v, t)

    def exp(self, d: Coords) -> Vector:
        """(exp(phi), V rho + iota U nu, V nu, iota) (Kelly, section 5)."""
        phi, nu = d[:3], d[_NU]
        _, _, c2, c3, c4, _ = stumpff(dot(phi, phi), 5)
        V, across = series(phi, c2, c3), cross(phi, nu)
        bend = add(scale(c3, across), scale(c4, cross(phi, across)))
        moved = scale(d[9], add(scale(0.5, nu), bend))
        return (*self.rotation.exp(phi), *add(matvec(V, d[_RHO]), moved), *matvec(V, nu), d[9])

    def log(self, a: Coords) -> Vector:
        """(phi, V^-1 p - t (nu / 2 - D phi x nu), nu = V^-1 v, t)."""
        phi, t = self.rotation.log(a[:4]), a[10]
        D, _ = inverse_jacobian(dot(phi, phi))
        V = transpose(series(phi, 0.5, D))
        nu = matvec(V, a[_VELOCITY])
        moved = scale(t, sub(scale(0.5, nu), scale(D, cross(phi, nu))))
        return (*phi, *sub(matvec(V, a[_POSITION]), moved), *nu, t)

    def adjoint(self, a: Coords) -> Chain:
        """(I, p, v, t) times diag(R, R, R, 1) (Kelly, section 4)."""
        R, v, t = self.rotation.matrix(a[:4]), a[_VELOCITY], a[10]
        seen = sub(a[_POSITION], scale(t, v))
        return (self._translating(seen, v, -t, v), block_diagonal(R, R, R, ((1,),)))

    def adjoint_inverse(self, a: Coords) -> Chain:
        Rt, v = transpose(self.rotation.matrix(a[:4])), negate(a[_VELOCITY])
        return (
            block_diagonal(Rt, Rt, Rt, ((1,),)),
            self._translating(negate(a[_POSITION]), v, a[10], v),
        )

    def _translating(self, p: Coords, v: Coords, k: Scalar, drift: Coords) -> Matrix:
        """[[I], [[p]x, I, k I, drift], [[v]x, 0, I], [0, 0, 0, 1]]."""
        return _rows(eye(3), (skew(p), eye(3), matscale(k, eye(3)), column(drift)), skew(v))

    def Jr(self, d: Coords) -> Matrix:
        """Integral of Ad(exp(-s d)) over s from 0 to 1, with c_6 by its recurrence.

        Where c_6 loses digits its factor (phi.nu) phi phi^T is as small.
        """
        phi, rho, nu, t = d[:3], d[_RHO], d[_NU], d[9]
        s, m = dot(phi, phi), dot(phi, nu)
        _, _, c2, c3, c4, c5 = stumpff(s, 5)
        c6 = (1 - 24 * c4) / (24 * select(lt(s, _TINY), _TINY, s))
        slopes = (c3 - 2 * c4, 3 * c5 - c4)
        by_rho, by_nu = (dual.slope_of_series(phi, u, -c2, c3, *slopes) for u in (rho, nu))
        across = cross(phi, nu)
        k = m * (c4 * 0.5 - 2 * c5 + 2 * c6)
        bend = matadd(
            matadd(matscale(k * s - (c3 - c4) * m, eye(3)), skew(_plus(m * (c3 * 0.5 - c4), phi, -c3, nu))),
            matadd(
                _outer(phi, _plus(c4, nu, -k, phi)), _outer(_plus(c3 - 2 * c4, nu, slopes[1], across), phi)
            ),
        )
        drift = add(scale(-0.5, nu), sub(scale(c3, across), scale(c4, cross(phi, across))))
        M = series(phi, -c2, c3)
        F = _polynomial(phi, 0.5, c3 - c2, c3 - c4)
        return _rows(M, (matadd(by_rho, matscale(t, bend)), M, matscale(t, F), column(drift)), by_nu)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """Its inverse, in which every coefficient follows from D and E by s E = 1/4 - 3 D + s D^2."""
        phi, rho, nu, t = d[:3], d[_RHO], d[_NU], d[9]
        s = dot(phi, phi)
        D, E = inverse_jacobian(s, principal=principal)
        by_rho, by_nu = (dual.slope_of_series(phi, u, 0.5, D, 0, E) for u in (rho, nu))
        across = cross(phi, nu)
        k = dot(phi, nu) * D * (D + s * E)
        bend = matadd(skew(_plus(-D, nu, -k, phi)), _outer(scale(E, across), phi))
        drift = add(scale(0.5, nu), scale(D, across))
        M = series(phi, 0.5, D)
        F = matadd(matscale(-0.5, eye(3)), matscale(D - 0.25 - s * D * D, skew(phi)))
        return _rows(M, (matadd(by_rho, matscale(t, bend)), M, matscale(t, F), column(drift)), by_nu)

    def matrix(self, a: Coords) -> Matrix:
        """[[R, v, p], [0, 1, t], [0, 0, 1]]."""
        R = self.rotation.matrix(a[:4])
        top = tuple((*row, v, p) for row, v, p in zip(R, a[_VELOCITY], a[_POSITION], strict=True))
        return (*top, (0, 0, 0, 1, a[10]), (0, 0, 0, 0, 1))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        position = source.vector(3, spread=spread)
        return (*source.unit(4), *position, *source.vector(3), *source.vector(1))

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        moves = (source.vector(n, offset) for n in (3, 3, 1))
        return (*(source.unit(3) * angle), *(x for move in moves for x in move))


def _plus(a: Scalar, u: Coords, b: Scalar, v: Coords) -> Vector:
    """Return a u + b v."""
    return add(scale(a, u), scale(b, v))
