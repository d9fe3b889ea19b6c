"""The unit sphere S2 in space: closed forms on unit vectors.

Tangent basis at n: with the coordinate axis a whose component of n is smallest (ties x, y, z),
b1 = (n x a) / |n x a| and b2 = n x b1, as GTSAM's Unit3. The chart is the exponential map of the sphere.
"""

from __future__ import annotations

from typing import NamedTuple

from liegen.algebra import Scalar, algebra_of, atan2, fabs, le, lt, select, sqrt
from liegen.algebra.linear import Chain, Matrix, Vector, cross, dot, matmul, matvec, scale, transpose
from liegen.coefficients import stumpff

from .form import Blocks, Coords, ManifoldForm, Rule
from .rn_form import ROUNDING, direction_or_zero, length


def _both(a: Scalar, b: Scalar) -> Scalar:
    return algebra_of(a, b).functions["and"](a, b)


def _axis(n: Coords) -> tuple[Scalar, Scalar]:
    """Conditions: the axis is x; the axis is x or y."""
    x, y, z = (fabs(c) for c in n)
    first = _both(le(x, y), le(x, z))
    return first, le(y, z)


def _pick(n: Coords, x: Scalar, y: Scalar, z: Scalar) -> Scalar:
    """The value that belongs to the axis of n."""
    first, second = _axis(n)
    return select(first, x, select(second, y, z))


def basis(n: Coords) -> Matrix:
    """(b1, b2) as rows, 2 x 3."""
    x, y, z = n
    c = (_pick(n, 0.0, -z, y), _pick(n, z, 0.0, -x), _pick(n, -y, x, 0.0))
    b1 = scale(1 / sqrt(dot(c, c)), c)
    return (b1, cross(n, b1))


class _Polar(NamedTuple):
    """A point m seen from n: y = B(n) m, its direction u, the angle, and the angle over its sine."""

    y: Vector
    u: Vector
    sine: Scalar
    cosine: Scalar
    angle: Scalar
    ratio: Scalar


def _polar(n: Coords, m: Coords) -> _Polar:
    y = matvec(basis(n), m)
    cosine = dot(n, m)
    sine = length(y)
    opposite = lt(cosine, 0)
    # behind x a sine that is but rounding has no direction: where 1 + sine/32 rounds to 1
    size = select(opposite, 1.0, 0.0)
    near = le(size + sine * ROUNDING, size)  # not so if NaN
    u = direction_or_zero(y)
    u = (select(near, 1.0, u[0]), select(near, 0.0, u[1]))
    angle = atan2(sine, cosine)
    # at the antipode there is no Jacobian: 1/0
    ratio = select(near, 1.0, angle) / select(near, select(opposite, 0.0, 1.0), sine)
    return _Polar(y, u, sine, cosine, angle, ratio)


class S2Form(ManifoldForm):
    """Directions in space."""

    name = "S2"
    storage = ("x", "y", "z")
    tangent = ("b1 [rad]", "b2 [rad]")
    note = (
        "S2: stored unit vector; tangent: two angles [rad] in the basis at x; x.retract(d) = exponential map"
    )

    def retract(self, x: Coords, d: Coords) -> Vector:
        """cos(t) x + sin(t)/t B^T d with t = |d|."""
        c0, c1 = stumpff(dot(d, d), 1)
        v = matvec(transpose(basis(x)), d)
        return tuple(c0 * p + c1 * q for p, q in zip(x, v, strict=True))

    def local(self, x: Coords, y: Coords) -> Vector:
        """The angle between both, along the direction of y in the basis at x; (pi, 0) at the antipode."""
        polar = _polar(x, y)
        return scale(polar.angle, polar.u)

    def lift(self, x: Coords) -> Matrix:
        """The basis: ``local`` has a kink in its formula, not in its value, where both directions agree."""
        return basis(x)

    def local_blocks(self) -> Rule:
        """By y: moves along and across; by x: the same with the turn of the basis at x."""
        return _local_blocks

    def direction_blocks(self) -> Rule:
        """d(v/|v|)/dv = B / |v| in the basis at the result."""
        return lambda n, v: (_direction_block(n, v),)


def _direction_block(n: Coords, v: Coords) -> Chain:
    k = 1 / length(v)
    return (tuple(scale(k, row) for row in basis(n)),)


def _local_blocks(_: Coords, x: Coords, y: Coords) -> Blocks:
    p = _polar(x, y)
    Bx, By = basis(x), basis(y)
    # moving y: dy = Bx By^T d, dcosine = x^T By^T d
    moved = matmul(Bx, transpose(By))
    slope = matvec(By, x)
    # moving x by d: the basis follows and turns about x by k d1, k = -(a.x)/|x x a|
    s = _pick(x, x[0], x[1], x[2])
    k = -s / sqrt(_pick(x, *(_squares(x))))
    turned = ((k * p.y[1] - p.cosine, 0), (-k * p.y[0], -p.cosine))
    return (_along_across(p, turned, p.y),), (_along_across(p, moved, slope),)


def _squares(n: Coords) -> Vector:
    """|n x a|^2 for each axis."""
    x, y, z = (c * c for c in n)
    return (y + z, x + z, x + y)


def _along_across(p: _Polar, dy: Matrix, dcosine: Coords) -> Matrix:
    """Rows of d(angle u) from dy and dcosine: u dangle + ratio (I - u u^T) dy."""
    along = matvec(transpose(dy), p.u)
    dangle = tuple(p.cosine * a - p.sine * c for a, c in zip(along, dcosine, strict=True))
    v = (-p.u[1], p.u[0])
    across = scale(p.ratio, matvec(transpose(dy), v))
    return tuple(tuple(p.u[i] * a + v[i] * b for a, b in zip(dangle, across, strict=True)) for i in range(2))
