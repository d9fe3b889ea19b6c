"""Rotations in other numbers than the group's own, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from liegen.algebra import Scalar, atan2, cos, lt, select, sin, sqrt
from liegen.algebra.linear import Matrix, Vector
from liegen.manifolds.form import Coords, RotationForm
from liegen.manifolds.turning import Turned

from .layout import Layout


@dataclass(frozen=True)
class Numbers:
    """A rotation in ``names``: ``read`` makes the group's own numbers of them, ``write`` them of those.

    ``matrix``: they are the entries of its matrix. ``exact``: ``read`` gives unit length always.
    """

    names: tuple[str, ...]
    text: str
    read: Callable[[Coords], Vector]
    write: Callable[[Coords], Vector]
    quaternion: bool = False
    matrix: bool = False
    exact: bool = False


def quaternion_of(R: Matrix) -> Vector:
    """The quaternion (x, y, z, w) of a rotation matrix, as accurate at half a turn as anywhere.

    4 q q^T is linear in R, and each row of it is q times four times one of its entries. The row with the
    largest diagonal entry is taken: that is at least 1, so nothing is lost and nothing divided by 0. Source:
    Shepperd, "Quaternion from rotation matrix" (1978).
    """
    (a, b, c), (d, e, f), (g, h, i) = R
    xy, xz, yz, xw, yw, zw = b + d, c + g, f + h, h - f, c - g, d - b
    less, more, lean, both = 1 - i, 1 + i, a - e, a + e
    xx, yy, zz, ww = less + lean, less - lean, more - both, more + both
    first = _larger((xx, xy, xz, xw, xx), (xy, yy, yz, yw, yy))
    other = _larger((xz, yz, zz, zw, zz), (xw, yw, zw, ww, ww))
    *row, pivot = _larger(first, other)
    k = 0.5 / sqrt(pivot)
    return tuple(k * x for x in row)


def _larger(one: Vector, other: Vector) -> Vector:
    """The one whose last entry is larger."""
    below = lt(one[-1], other[-1])
    return tuple(x if x is y else select(below, y, x) for x, y in zip(one, other, strict=True))


def _rows(numbers: Coords, n: int) -> Matrix:
    return tuple(tuple(numbers[n * k : n * k + n]) for k in range(n))


def _angle(a: Coords) -> Vector:
    return (cos(a[0]), sin(a[0]))


def _of_matrix(form: RotationForm, own: Callable[[Matrix], Vector], columns: bool) -> Numbers:
    n = form.space
    places = [n * j + i if columns else n * i + j for i in range(n) for j in range(n)]

    def read(x: Coords) -> Vector:
        R = _rows([x[k] for k in places], n)
        return Turned(own(R), R)

    def write(q: Coords) -> Vector:
        entries = [x for row in form.matrix(q) for x in row]
        return tuple(entries[k] for k in places)

    names = [f"r{i}{j}" for i in range(n) for j in range(n)]
    text = f"{n}x{n} rotation matrix" + (", column by column" if columns else "")
    return Numbers(tuple(names[k] for k in places), text, read, write, matrix=True)


def _space(form: RotationForm, columns: bool) -> Mapping[str, Numbers]:
    return {
        "xyzw": Numbers(form.storage, "unit quaternion (x, y, z, w)", tuple, tuple, quaternion=True),
        "wxyz": Numbers(
            ("qw", "qx", "qy", "qz"),
            "unit quaternion (w, x, y, z)",
            lambda x: (*x[1:4], x[0]),
            lambda q: (q[3], *q[:3]),
            quaternion=True,
        ),
        "matrix": _of_matrix(form, quaternion_of, columns),
    }


def _plane(form: RotationForm, columns: bool) -> Mapping[str, Numbers]:
    return {
        "cos-sin": Numbers(form.storage, "(cos, sin)", tuple, tuple),
        "angle": Numbers(("angle",), "angle [rad]", _angle, lambda x: (atan2(x[1], x[0]),), exact=True),
        "matrix": _of_matrix(form, lambda R: (R[0][0], R[1][0]), columns),
    }


def numbers(form: RotationForm, layout: Layout) -> Numbers:
    """The numbers of SO3 by the layout's ``rotation``, of SO2 by its ``plane``."""
    columns = layout.order == "column"
    return _space(form, columns)[layout.rotation] if form.space > 2 else _plane(form, columns)[layout.plane]


def unit(v: Coords) -> Vector:
    """v / |v|."""
    n: Scalar = sum((x * x for x in v[1:]), v[0] * v[0])
    k = 1 / sqrt(n)
    return tuple(k * x for x in v)
