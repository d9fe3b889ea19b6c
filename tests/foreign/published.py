"""Formulas, and Jacobians of them as they were published with one mistake, on NumPy alone.

Each mistake is one that a public report or a published code had; the formulas and the names are our own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from liegen import R1, R2, R3, SE2, SE3, SO3, Sim3, atan2, dot, exp, factor, norm, stack

Array = NDArray[np.float64]


def skew(v: Array) -> Array:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(q: Array) -> Array:
    return Rotation.from_quat(q[:4]).as_matrix()


def row(*blocks: Any) -> Array:
    return np.hstack([np.atleast_2d(b) for b in blocks])


def jr_inv(w: Array) -> Array:
    """Inverse right Jacobian of SO(3): I + W/2 + (1/a^2 - (1 + cos a) / (2 a sin a)) W^2."""
    a, W = np.linalg.norm(w), skew(w)
    if a < 1e-4:
        return np.eye(3) + W / 2 + W @ W / 12
    half = a / 2
    return np.eye(3) + W / 2 + (1 - half / np.tan(half)) / a**2 * (W @ W)


# the formulas


@factor
def gps_plane(x: SE2, *, z: R2):
    return x.translation - z


@factor
def gps_lever(T: SE3, *, z: R3, lever: R3):
    return T.transform_from(lever) - z


@factor
def pseudorange(T: SE3, b: R1, *, s: R3, lever: R3, z: R1):
    return norm(T.transform_from(lever) - s) + b - z


@factor
def pseudorange_sagnac(p: R3, b: R1, *, s: R3, z: R1):
    return norm(p - s) + 0.01 * (s[0] * p[1] - s[1] * p[0]) + b - z


@factor
def point_to_plane(T: SE3, *, E: SE3, p: R3, n: R3, d: R1):
    return dot(n, T.transform_from(E.transform_from(p))) + d


@factor
def edge(P: SO3, *, p: R3, a: R3, n: R3):
    return dot(n, P.inverse() @ (p - a))


@factor
def scaled_track(s: R1, *, v: R3, z: R3):
    return exp(s[0]) * v - z


@factor
def scaled_pose(S: Sim3, *, p: R3, z: R3):
    return S.transform_from(p) - z


@factor
def prior(x: SO3, *, z: SO3):
    return z.local(x)


@factor
def prior_vector(v: R3, *, z: R3):
    return z - v


@factor
def between_rotations(x: SO3, y: SO3, *, z: SO3):
    return z.local(x.between(y))


@factor
def between_similarities(x: Sim3, y: Sim3, *, z: Sim3):
    return z.local(x.between(y))


@factor
def relative(x: SO3, y: SO3):
    return x.between(y).log()


@factor
def range_bearing(x: R3, m: R2, *, z: R2):
    d = m - x[:2]
    return stack(norm(d), atan2(d[1], d[0]) - x[2]) - z


# the published functions


def moved(T: Array, p: Array) -> Array:
    return rotation(T) @ p + T[4:]


def log(R: Array) -> Array:
    return Rotation.from_matrix(R).as_rotvec()


def gps_without_rotation(x, z):
    return x[2:] - z, row(np.eye(2), np.zeros((2, 1)))


def lever_without_rotation(T, z, lever):
    return moved(T, lever) - z, row(-skew(lever), rotation(T))


def lever_with_the_wrong_sign(T, z, lever):
    return moved(T, lever) - z, row(rotation(T) @ skew(lever), rotation(T))


def lever_without_columns(T, z, lever):
    return moved(T, lever) - z, row(np.zeros((3, 3)), rotation(T))


def lever_in_the_world(T, z, lever):
    return moved(T, lever) - z, row(-rotation(T) @ skew(lever), np.eye(3))


def pseudorange_without_rotation_columns(T, b, s, lever, z):
    d = moved(T, lever) - s
    u = d / np.linalg.norm(d)
    return np.linalg.norm(d) + b - z, row(np.zeros((1, 3)), u @ rotation(T)), np.ones((1, 1))


def sagnac_without_its_derivative(p, b, s, z):
    d = p - s
    u = d / np.linalg.norm(d)
    r = np.linalg.norm(d) + 0.01 * (s[0] * p[1] - s[1] * p[0]) + b - z
    return r, u[None], np.ones((1, 1))


def plane_with_the_translation_of_the_world(T, E, p, n, d):
    inner = moved(E, p)
    R = rotation(T)
    wrong = rotation(E) @ p + T[4:]
    return n @ moved(T, inner) + d, row(-n @ R @ skew(wrong), n @ R)


def edge_with_skew_outside(P, p, a, n):
    R = rotation(P)
    return n @ R.T @ (p - a), (n @ R.T @ skew(p - a))[None]


def scale_without_its_factor(s, v, z):
    return np.exp(s[0]) * v - z, v[:, None]


def prior_with_the_wrong_sign(v, z):
    return z - v, np.eye(3)


def between_with_adjoint_only(x, y, z):
    b = between_similarities.jacobians(x, y, z=z)
    e = (Sim3.from_storage(x).between(Sim3.from_storage(y))).inverse().adjoint()
    return b["res"], -e, np.eye(7)


def left_in_one_right_in_the_other(x, y, z):
    X, Y, Z = rotation(x), rotation(y), rotation(z)
    r = log(Z.T @ X.T @ Y)
    J = jr_inv(r)
    return r, -J @ Y.T, J


def relative_from_the_left(x, y):
    X, Y = rotation(x), rotation(y)
    r = log(X.T @ Y)
    J = jr_inv(r)
    return r, -J @ Y.T @ X, J @ Y.T


def relative_with_the_left_jacobian(x, y):
    X, Y = rotation(x), rotation(y)
    r = log(X.T @ Y)
    return r, -jr_inv(r) @ Y.T @ X, jr_inv(-r)


def relative_without_jr(x, y):
    X, Y = rotation(x), rotation(y)
    return log(X.T @ Y), -Y.T @ X, np.eye(3)


def relative_without_adjoint(x, y):
    X, Y = rotation(x), rotation(y)
    r = log(X.T @ Y)
    return r, -jr_inv(r), jr_inv(r)


def relative_in_degrees(x, y):
    return tuple(np.degrees(a) for a in right_relative(x, y))


def right_relative(x, y):
    X, Y = rotation(x), rotation(y)
    r = log(X.T @ Y)
    return r, -jr_inv(r) @ Y.T @ X, jr_inv(r)


def relative_exchanged(x, y):
    r, by_x, by_y = right_relative(x, y)
    return r, by_y, by_x


def relative_transposed(x, y):
    r, by_x, by_y = right_relative(x, y)
    return r, by_x.T, by_y.T


def relative_of_the_inverse(x, y):
    return right_relative(Rotation.from_quat(x).inv().as_quat(), Rotation.from_quat(y).inv().as_quat())


def relative_by_wxyz(x, y):
    return right_relative(x[[1, 2, 3, 0]], y[[1, 2, 3, 0]])


def bearing_divided(x, m, z):
    d = m - x[:2]
    q = d @ d
    n = np.sqrt(q)
    J = np.array([[-d[0] / n, -d[1] / n, 0], [d[1] / q, -d[0] / q, -1 / q]])
    return np.array([n, np.arctan2(d[1], d[0]) - x[2]]) - z, J, -J[:, :2]


@dataclass(frozen=True)
class Published:
    """A function of a formula; for each wrong output words of the verdict, or of what explains as much."""

    formula: Any
    function: Callable[..., Any]
    words: dict[str, tuple[str, ...]]


def _of(formula: Any, function: Callable[..., Any], **words: str | tuple[str, ...]) -> Published:
    return Published(formula, function, {k: (w,) if isinstance(w, str) else w for k, w in words.items()})


PUBLISHED = (
    _of(gps_plane, gps_without_rotation, x=("in the world", "ceres")),
    _of(gps_lever, lever_without_rotation, T=("in the rotation columns", "the rotation of T is left out")),
    _of(gps_lever, lever_with_the_wrong_sign, T="the sign of the rotation columns is opposite"),
    _of(gps_lever, lever_without_columns, T="the rotation columns are 0: left out"),
    _of(gps_lever, lever_in_the_world, T=("in the world", "symforce")),
    _of(pseudorange, pseudorange_without_rotation_columns, T="the rotation columns are 0: left out"),
    _of(pseudorange_sagnac, sagnac_without_its_derivative,
        p="the derivative of 0.01 * (s[0] * p[1] - s[1] * p[0]) is left out"),
    _of(point_to_plane, plane_with_the_translation_of_the_world,
        T="the translation of T stands where the translation of E is right"),
    _of(edge, edge_with_skew_outside, P=("P is perturbed from the left, Exp(d) P", "R(P)^T is put in")),
    _of(scaled_track, scale_without_its_factor, s="divided by exp(s)"),
    _of(prior_vector, prior_with_the_wrong_sign, v="the sign is opposite"),
    _of(between_similarities, between_with_adjoint_only,
        x="Jr^-1(res) is missing", y="Jr^-1(res) is missing"),
    _of(between_rotations, left_in_one_right_in_the_other, x="x is perturbed from the left"),
    _of(relative, relative_from_the_left, y="y is perturbed from the left"),
    _of(relative, relative_with_the_left_jacobian, y="Jl^-1(res) stands where Jr^-1(res) is right"),
    _of(relative, relative_without_jr, x="Jr^-1(res) is missing", y="Jr^-1(res) is missing"),
    _of(relative, relative_without_adjoint, x="a factor Ad("),
    _of(relative, relative_in_degrees, res="degrees", x="degrees", y="degrees"),
    _of(relative, relative_exchanged,
        x="the Jacobian by y stands in its place", y="the Jacobian by x stands"),
    _of(relative, relative_transposed, x="transposed", y="transposed"),
    _of(relative, relative_of_the_inverse,
        res="the inverse of x and y is taken", x="the inverse of x and y is taken",
        y="the inverse of x and y is taken"),
    _of(relative, relative_by_wxyz, res="wxyz", x="wxyz", y="wxyz"),
    _of(range_bearing, bearing_divided, x="only entry [1, 2] (row 1, column 2, z)"),
)  # fmt: skip
