"""Extended poses as 5 x 5 matrices [[R, p, v], [0, I]]: exponential by ``expm``, closed-form logarithm."""

from __future__ import annotations

from .logarithms import PRINCIPAL, Branch, log_se3, log_so3
from .matrix import Matrix, Number, Vector, add, expm, length, matmul, matvec, mp, scale, skew, sub, transpose


def extended(R: Matrix, p: Vector, v: Vector) -> Matrix:
    """[[R, p, v], [0, I]]."""
    top = tuple((*row, x, u) for row, x, u in zip(R, p, v, strict=True))
    return (*top, _unit(3), _unit(4))


def _unit(k: int) -> Vector:
    return tuple(mp.one if j == k else mp.zero for j in range(5))


def rotation_of(T: Matrix) -> Matrix:
    """R."""
    return tuple(row[:3] for row in T[:3])


def column_of(T: Matrix, k: int) -> Vector:
    """The upper three numbers of a column."""
    return tuple(row[k] for row in T[:3])


def inverse(T: Matrix) -> Matrix:
    """[[R^T, -R^T p, -R^T v], [0, I]]."""
    back = transpose(rotation_of(T))
    p, v = (scale(-mp.one, matvec(back, column_of(T, k))) for k in (3, 4))
    return extended(back, p, v)


def exp(d: Vector) -> Matrix:
    """Of [[W, p, v], [0, 0]]; p and v enter linearly: each is scaled to the size of W meanwhile."""
    W = skew(d[:3])
    ks = [_stretch(length(d[:3]), u) for u in (d[3:6], d[6:])]
    p, v = (scale(k, u) for k, u in zip(ks, (d[3:6], d[6:]), strict=True))
    top = tuple((*row, x, u) for row, x, u in zip(W, p, v, strict=True))
    T = expm((*top, (mp.zero,) * 5, (mp.zero,) * 5))
    p, v = (scale(1 / k, column_of(T, c)) for k, c in zip(ks, (3, 4), strict=True))
    return extended(rotation_of(T), p, v)


def _stretch(angle: Number, v: Vector) -> Number:
    size = length(v)
    return angle / size if angle and size else mp.one


def log(T: Matrix, branch: Branch = PRINCIPAL) -> Vector:
    """(phi, V^-1 p, V^-1 v): each vector as the translation of a pose with the same rotation."""
    near = branch.near
    logs: list[Vector] = []
    for k, part in ((3, slice(3, 6)), (4, slice(6, 9))):
        pose = tuple((*row, x) for row, x in zip(rotation_of(T), column_of(T, k), strict=True))
        beside = None if near is None else (*near[:3], *near[part])
        logs.append(log_se3(pose, Branch(beside, None, branch.flip)))
    return (*logs[0], *logs[1][3:])


def local_componentwise(x: Matrix, y: Matrix, branch: Branch) -> Vector:
    """GTSAM's NavState::localCoordinates: (Log(R_x^T R_y), R_x^T (p_y - p_x), R_x^T (v_y - v_x))."""
    back = transpose(rotation_of(x))
    near = None if branch.near is None else branch.near[:3]
    turn = log_so3(matmul(back, rotation_of(y)), Branch(near, None, branch.flip))
    moves = (matvec(back, sub(column_of(y, k), column_of(x, k))) for k in (3, 4))
    return (*turn, *(u for move in moves for u in move))


def retract_componentwise(x: Matrix, d: Vector, _: Branch) -> Matrix:
    """GTSAM's NavState::retract: (R Exp(w), p + R d_p, v + R d_v)."""
    R = rotation_of(x)
    p, v = (add(column_of(x, k), matvec(R, u)) for k, u in ((3, d[3:6]), (4, d[6:])))
    return extended(matmul(R, expm(skew(d[:3]))), p, v)
