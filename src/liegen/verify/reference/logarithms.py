"""Logarithms of rotations and poses as closed forms of their matrices, with a choice of the branch.

The angle comes from atan2 of sine (antisymmetric part) and cosine (trace), so it is right from 1e-300 to pi.
Beyond a quarter turn the axis comes from the symmetric part, where it is well defined up to its sign, and the
antisymmetric part gives the sign. A proof by ``expm(log T) = T`` is in the tests.
"""

from __future__ import annotations

from dataclasses import dataclass

from .matrix import Element, Matrix, Number, Vector, add, cross, dot, length, mp, normalised, scale, sub

#: Angles that are closer to pi than this take the other branch when ``Branch.flip`` is set.
AMBIGUOUS = 1e-6


@dataclass(frozen=True)
class Branch:
    """Which of the logarithms to take.

    ``near``: the one nearest to this tangent vector. ``start``: the point whose tangent basis to use (S2).
    ``flip``: without ``near``, the other one where the angle is within ``AMBIGUOUS`` of pi.
    """

    near: Element = None
    start: Element = None
    flip: bool = False


PRINCIPAL = Branch()


def chosen_angle(angle: Number, axis: Vector, near: Vector | None, *, flip: bool) -> Number:
    """``angle`` in [0, pi] about ``axis``, plus the multiple of 2 pi that the branch asks for."""
    if near is not None:
        turns = (dot(axis, near) - angle) / (2 * mp.pi)
        return angle + 2 * mp.pi * mp.nint(turns) if mp.isfinite(turns) else angle
    return angle - 2 * mp.pi if flip and mp.pi - angle < AMBIGUOUS else angle


@dataclass(frozen=True)
class Turn:
    """A rotation by ``angle`` in [0, pi] about the unit vector ``axis`` (0 at the identity)."""

    axis: Vector
    sine: Number
    cosine: Number

    @property
    def angle(self) -> Number:
        """The angle [rad]."""
        return mp.atan2(self.sine, self.cosine)

    def chosen(self, near: Vector | None, *, flip: bool) -> Number:
        """The angle of the branch."""
        return chosen_angle(self.angle, self.axis, near, flip=flip)

    def stretch(self, angle: Number) -> Number:
        """(angle/2) cot(angle/2), the same cotangent for every branch of the angle; 1 at the identity."""
        c, s = self.cosine, self.sine
        if c <= 0:
            return angle / 2 * s / (1 - c)
        return angle / 2 * (1 + c) / s if s else mp.one


def plane_turn(R: Matrix) -> Turn:
    """The turn of a 2 x 2 rotation matrix; its axis has one component, +1 or -1."""
    c, s = R[0][0], R[1][0]
    return Turn((-mp.one if s < 0 else mp.one,), abs(s), c)


def space_turn(R: Matrix) -> Turn:
    """The turn of a 3 x 3 rotation matrix."""
    half = scale(mp.mpf(0.5), (R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]))
    sine, cosine = length(half), (R[0][0] + R[1][1] + R[2][2] - 1) / 2
    if cosine < 0:
        return Turn(_axis_beyond_quarter_turn(R, cosine, half), sine, cosine)
    return Turn(scale(1 / sine, half) if sine else (mp.zero,) * 3, sine, cosine)


def _axis_beyond_quarter_turn(R: Matrix, cosine: Number, half: Vector) -> Vector:
    """From (R + R^T)/2 - cos I = (1 - cos) u u^T: its column with the largest diagonal entry."""
    k = max(range(3), key=lambda i: R[i][i])
    column = tuple((R[i][k] + R[k][i]) / 2 - (cosine if i == k else 0) for i in range(3))
    axis = normalised(column)
    return scale(-mp.one, axis) if dot(axis, half) < 0 else axis


def log_so2(R: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(angle,)."""
    turn = plane_turn(R)
    return scale(turn.chosen(branch.near, flip=branch.flip), turn.axis)


def log_so3(R: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """Rotation vector."""
    turn = space_turn(R)
    return scale(turn.chosen(branch.near, flip=branch.flip), turn.axis)


def log_se2(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(V^-1 t, angle) with V = sin(a)/a I + (1 - cos(a))/a J and so V^-1 = (a/2) cot(a/2) I - (a/2) J."""
    (a, b, x), (c, d, y), _ = T
    turn = plane_turn(((a, b), (c, d)))
    size = turn.chosen(branch.near and branch.near[2:], flip=branch.flip)
    angle, k = size * turn.axis[0], turn.stretch(size)
    return (k * x + angle / 2 * y, k * y - angle / 2 * x, angle)


def log_se3(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(phi, V^-1 t), V^-1 t = t - phi x t / 2 + (1 - (a/2) cot(a/2)) u x (u x t), phi = a u."""
    R, t = tuple(row[:3] for row in T[:3]), tuple(row[3] for row in T[:3])
    turn = space_turn(R)
    angle = turn.chosen(branch.near and branch.near[:3], flip=branch.flip)
    across = cross(turn.axis, t)
    bend = scale(1 - turn.stretch(angle), cross(turn.axis, across))
    return (*scale(angle, turn.axis), *add(sub(t, scale(angle / 2, across)), bend))
