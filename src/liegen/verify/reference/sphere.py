"""The unit sphere S2: GTSAM's tangent basis, and the exponential map along great circles."""

from __future__ import annotations

from .logarithms import PRINCIPAL, Branch, chosen_angle
from .matrix import Matrix, Vector, add, cross, dot, length, matvec, mp, normalised, scale, transpose


def basis(n: Vector, start: Vector | None = None) -> Matrix:
    """(b1, b2) at n: b1 along n x a, a the axis of the smallest |component| (ties x, y, z), b2 = n x b1.

    ``start`` chooses the axis instead of n, so that the basis does not jump under small steps from ``start``.
    """
    chooser = start or n
    k = min(range(3), key=lambda i: abs(chooser[i]))
    b1 = normalised(cross(n, tuple(mp.one if i == k else mp.zero for i in range(3))))
    return (b1, cross(n, b1))


def retract(n: Vector, d: Vector, branch: Branch = PRINCIPAL) -> Vector:
    """The point at the distance |d| [rad] along the great circle in the direction d."""
    size = length(d)
    if not size:
        return n
    along = matvec(transpose(basis(n, branch.start)), scale(1 / size, d))
    return add(scale(mp.cos(size), n), scale(mp.sin(size), along))


def local(n: Vector, m: Vector, branch: Branch = PRINCIPAL) -> Vector:
    """The angle between both, in the direction of m seen from n; (pi, 0) at the antipode."""
    seen = matvec(basis(n, branch.start), m)
    sine = length(seen)
    direction = scale(1 / sine, seen) if sine else (mp.one, mp.zero)
    angle = mp.atan2(sine, dot(n, m))
    return scale(chosen_angle(angle, direction, branch.near, flip=False), direction)
