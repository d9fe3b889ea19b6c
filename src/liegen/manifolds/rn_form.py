"""R^n as a group under addition."""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra import Scalar, fabs, le, lt, select, sqrt
from liegen.algebra.linear import Chain, Matrix, Vector, dot, eye, negate, scale

from .form import Coords, GroupForm, Source

_TINY, _HUGE, _SHIFT = 2.0**-900, 2.0**900, 2.0**600
#: Less than 32 half units in the last place of a size are rounding: ``size + x * ROUNDING`` is ``size``.
ROUNDING = 2.0**-5


class RForm(GroupForm):
    """Vectors with n components; every chart is the identity."""

    flat = True

    def __init__(self, n: int) -> None:
        self.name = f"R{n}"
        self.storage = tuple("xyz"[:n]) if n <= 3 else tuple(f"v{i}" for i in range(n))
        self.tangent = self.storage
        self.note = f"R{n}: stored as it is; tangent: the same; x.retract(d) = x + d"

    def identity(self) -> Vector:
        return (0,) * self.dim

    def compose(self, a: Coords, b: Coords) -> Vector:
        return tuple(x + y for x, y in zip(a, b, strict=True))

    def inverse(self, a: Coords) -> Vector:
        return negate(a)

    def between(self, a: Coords, b: Coords) -> Vector:
        return tuple(y - x for x, y in zip(a, b, strict=True))

    def exp(self, d: Coords) -> Vector:
        return tuple(d)

    def log(self, a: Coords) -> Vector:
        return tuple(a)

    def adjoint(self, a: Coords) -> Chain:
        return (eye(self.dim),)

    def adjoint_inverse(self, a: Coords) -> Chain:
        return (eye(self.dim),)

    def Jr(self, d: Coords) -> Matrix:
        return eye(self.dim)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        return eye(self.dim)

    def matrix(self, a: Coords) -> Matrix:
        """The translation as a homogeneous matrix."""
        rows = tuple((*row, x) for row, x in zip(eye(self.dim), a, strict=True))
        return (*rows, (0,) * self.dim + (1,))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        """Vectors of the plane and of space are positions; others are weights, pixels, biases."""
        return source.vector(self.dim, spread=spread if self.dim in (2, 3) else 1.0).tolist()

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        return source.vector(self.dim, offset).tolist()


def scaled_length(v: Coords) -> tuple[Vector, Scalar, Scalar]:
    """(w, |w|, 1/k) with w = k v and k a power of two that keeps |w|^2 from under- and overflow."""
    square = dot(v, v)
    small, large = lt(square, _TINY), lt(_HUGE, square)
    w = scale(select(small, _SHIFT, select(large, 1 / _SHIFT, 1.0)), v)
    return w, sqrt(dot(w, w)), select(small, 1 / _SHIFT, select(large, _SHIFT, 1.0))


def length(v: Coords) -> Scalar:
    """|v|, right to rounding for components from 1e-320 to 1e300."""
    if len(v) == 1:
        return fabs(v[0])
    _, n, back = scaled_length(v)
    return n * back


def direction(v: Coords) -> Vector:
    """v / |v|; not a number at 0."""
    w, n, _ = scaled_length(v)
    return scale(1 / n, w)


def direction_or_zero(v: Coords) -> Vector:
    """v / |v|, and 0 at 0: the gradient of ``length``, the mean over all directions at the kink."""
    if len(v) == 1:
        return (select(lt(v[0], 0), -1.0, select(lt(0, v[0]), 1.0, 0.0)),)
    w, n, _ = scaled_length(v)
    return scale(1 / select(lt(0, n), n, 1.0), w)  # n is 0 only where w is


def direction_or_rounding(v: Coords, size: Scalar) -> Vector:
    """v / |v|, and 0 where v is but the rounding of differences between numbers of this ``size``.

    That is where size + |v|/32 rounds to size, in whatever precision: below 32 units of the rounding.
    """
    if len(v) == 1:
        near = le(size + fabs(v[0]) * ROUNDING, size)
        return (select(near, 0.0, select(lt(v[0], 0), -1.0, v[0] / fabs(select(near, 1.0, v[0])))),)
    w, n, back = scaled_length(v)
    near = le(size + n * back * ROUNDING, size)
    return scale(select(near, 0.0, 1 / select(near, 1.0, n)), w)
