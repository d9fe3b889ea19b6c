"""Similarities as matrices [[s R, t], [0, 1]]: exponential by ``expm``, logarithm with complex numbers."""

from __future__ import annotations

from .logarithms import PRINCIPAL, Branch, plane_turn, space_turn
from .matrix import Matrix, Number, Vector, add, cross, dot, expm, length, matvec, mp, scale, sub, transpose


def similar(R: Matrix, t: Vector, s: Vector) -> Matrix:
    """[[s R, t], [0, 1]]; s has one number."""
    rows = tuple((*scale(s[0], row), x) for row, x in zip(R, t, strict=True))
    return (*rows, (mp.zero,) * len(t) + (mp.one,))


def translation_of(T: Matrix) -> Vector:
    """The translation."""
    return tuple(row[-1] for row in T[:-1])


def scale_of(T: Matrix) -> Number:
    """s, the length of the first column."""
    return length(tuple(row[0] for row in T[:-1]))


def rotation_of(T: Matrix) -> Matrix:
    """R."""
    k = 1 / scale_of(T)
    return tuple(scale(k, row[:-1]) for row in T[:-1])


def act_inverse(T: Matrix, p: Vector) -> Vector:
    """R^T (p - t) / s."""
    return scale(1 / scale_of(T), matvec(transpose(rotation_of(T)), sub(p, translation_of(T))))


def inverse(T: Matrix) -> Matrix:
    """(R^T, -R^T t / s, 1 / s)."""
    origin = act_inverse(T, (mp.zero,) * (len(T) - 1))
    return similar(transpose(rotation_of(T)), origin, (1 / scale_of(T),))


def exp(W: Matrix, rho: Vector, lam: Number) -> Matrix:
    """Of [[W + lam I, rho], [0, 0]]; rho enters linearly: it is scaled to the size of the rest meanwhile."""
    size, most = length(rho), max(abs(x) for row in (*W, (lam,)) for x in row)
    k = most / size if most and size else mp.one
    rows = tuple(
        (*(x + lam if i == j else x for j, x in enumerate(row)), k * rho[i]) for i, row in enumerate(W)
    )
    T = expm((*rows, (mp.zero,) * (len(rho) + 1)))
    shrunk = scale(1 / k, translation_of(T))
    return (*((*row[:-1], t) for row, t in zip(T[:-1], shrunk, strict=True)), T[-1])


def _quotient(z: Number) -> Number:
    """z / (e^z - 1), for complex z too; 1 at 0."""
    return z / mp.expm1(z) if z else mp.one


def log_sim2(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(z / (e^z - 1) t, angle, lam), z = lam + i angle."""
    turn = plane_turn(rotation_of(T))
    angle = turn.chosen(branch.near and branch.near[2:3], flip=branch.flip) * turn.axis[0]
    lam = mp.log(scale_of(T))
    v = _quotient(mp.mpc(lam, angle)) * mp.mpc(*translation_of(T))
    return (v.real, v.imag, angle, lam)


def log_sim3(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """As for the plane, across the axis; along it the real lam / (e^lam - 1)."""
    turn, t = space_turn(rotation_of(T)), translation_of(T)
    angle = turn.chosen(branch.near and branch.near[:3], flip=branch.flip)
    lam = mp.log(scale_of(T))
    along = scale(dot(turn.axis, t), turn.axis)
    aside, k = sub(t, along), mp.mpc(_quotient(mp.mpc(lam, angle)))
    bent = add(scale(k.real, aside), scale(k.imag, cross(turn.axis, aside)))
    return (*scale(angle, turn.axis), *add(scale(mp.mpf(_quotient(lam)), along), bent), lam)
