"""The Galilean group as 5 x 5 matrices [[R, v, p], [0, 1, t], [0, 0, 1]]: ``expm``, closed-form logarithm."""

from __future__ import annotations

from .extended import column_of, rotation_of
from .logarithms import PRINCIPAL, Branch, log_se3, space_turn
from .matrix import Matrix, Number, Vector, add, cross, expm, length, matvec, mp, scale, skew, sub, transpose


def event(R: Matrix, p: Vector, v: Vector, t: Vector) -> Matrix:
    """[[R, v, p], [0, 1, t], [0, 0, 1]]; t has one number."""
    top = tuple((*row, u, x) for row, u, x in zip(R, v, p, strict=True))
    z, one = mp.zero, mp.one
    return (*top, (z, z, z, one, t[0]), (z, z, z, z, one))


def inverse(T: Matrix) -> Matrix:
    """(R^T, -R^T (p - v t), -R^T v, -t)."""
    back, v, p, t = transpose(rotation_of(T)), column_of(T, 3), column_of(T, 4), T[3][4]
    return event(back, matvec(back, sub(scale(t, v), p)), scale(-mp.one, matvec(back, v)), (-t,))


def exp(d: Vector) -> Matrix:
    """Of [[W, nu, rho], [0, 0, iota], [0, 0, 0]] in units of velocity and position that fit the size of W."""
    W, rho, nu, iota = skew(d[:3]), d[3:6], d[6:9], d[9]
    k, m = _units(length(d[:3]), length(rho), length(nu), abs(iota))
    top = tuple((*row, k * u, m * x) for row, u, x in zip(W, nu, rho, strict=True))
    z = mp.zero
    T = expm((*top, (z, z, z, z, iota * m / k), (z, z, z, z, z)))
    return event(rotation_of(T), scale(1 / m, column_of(T, 4)), scale(1 / k, column_of(T, 3)), (iota,))


def _units(angle: Number, rho: Number, nu: Number, iota: Number) -> tuple[Number, Number]:
    """Factors of velocities and positions that leave no entry of the matrix larger than the angle."""
    if not angle:
        return mp.one, mp.one
    k = angle / nu if nu else mp.one
    bounds = [angle / rho] if rho else []
    bounds += [k * angle / iota] if iota else []
    return k, min(bounds, default=mp.one)


#: Below this angle (1 - (a/2) cot(a/2)) / a is a/12 to 60 digits.
_SMALL = mp.mpf(10) ** -20


def log(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(phi, V^-1 p - t K nu, nu = V^-1 v, t), K nu = nu / 2 - (1 - (a/2) cot(a/2))/a u x nu, phi = a u."""
    near = branch.near
    R, t = rotation_of(T), T[3][4]
    turn = space_turn(R)
    angle = turn.chosen(near and near[:3], flip=branch.flip)
    rho, nu = (_translation(T, c, near, part, branch) for c, part in ((4, slice(3, 6)), (3, slice(6, 9))))
    k = angle / 12 if abs(angle) < _SMALL else (1 - turn.stretch(angle)) / angle
    moved = sub(scale(mp.mpf(1) / 2, nu), scale(k, cross(turn.axis, nu)))
    return (*scale(angle, turn.axis), *add(rho, scale(-t, moved)), *nu, t)


def _translation(T: Matrix, c: int, near: Vector | None, part: slice, branch: Branch) -> Vector:
    """V^-1 of a column: as the translation of a pose with the same rotation."""
    pose = tuple((*row, x) for row, x in zip(rotation_of(T), column_of(T, c), strict=True))
    beside = None if near is None else (*near[:3], *near[part])
    return log_se3(pose, Branch(beside, None, branch.flip))[3:]
