"""The layouts of the reference, in high precision: by the rotation nearest to a matrix and its quaternion.

Independent of liegen's layouts: a matrix becomes a rotation by Newton's iteration R <- (R + R^-T) / 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .matrix import Element, Matrix, Number, Vector, mp, normalised, transpose
from .spaces import load_so3, space_of, store_so3

if TYPE_CHECKING:
    from liegen.layouts import Layout, Stored
    from liegen.manifolds import ManifoldForm, Value

#: Dimension of the vectors that the rotation turns, and how many scalars follow it.
_KINDS = {
    "SO2": (2, 0), "SE2": (2, 2), "SO3": (3, 0), "SE3": (3, 3), "SE23": (3, 6), "NavState": (3, 6),
    "Gal3": (3, 7),
}  # fmt: skip


def load(manifold: type[Value], coords: Sequence[float], stored: Stored | None = None) -> Element:
    """The element that stored floats stand for, at the working precision; nothing is rounded."""
    numbers = tuple(mp.mpf(float(c)) for c in coords)
    return space_of(manifold).load(own_numbers(manifold.form, numbers, stored))


def store(
    manifold: type[Value],
    element: Element,
    stored: Stored | None = None,
    like: Sequence[float] | None = None,
) -> Vector:
    """The stored numbers of an element; of q and -q those nearer to ``like``, or with w >= 0."""
    form = manifold.form
    near = None if like is None else own_numbers(form, tuple(mp.mpf(float(c)) for c in like), stored)
    own = space_of(manifold).store(element, None if near is None else [float(x) for x in near])
    return stored_numbers(form, own, stored)


def own_numbers(form: ManifoldForm, x: Vector, stored: Stored | None) -> Vector:
    """The manifold's own numbers."""
    if stored is None:
        return x
    if form.parts:
        pieces: list[Number] = []
        for part in form.parts:
            n = count(part, stored)
            pieces, x = [*pieces, *own_numbers(part, x[:n], stored)], x[n:]
        return tuple(pieces)
    if form.name not in _KINDS:
        return x
    (n, k), layout = _KINDS[form.name], stored.layout(form)
    if _is_whole(form, layout):
        rows = _matrix(x, n + (layout.pose == "4x4"), n + 1, layout)
        return (*_own_rotation(tuple(row[:n] for row in rows[:n])), *(row[n] for row in rows[:n]))
    q, rest = _split(form, x, k, layout)
    return (*_rotation(q, n, layout), *rest)


def stored_numbers(form: ManifoldForm, x: Vector, stored: Stored | None) -> Vector:
    """The other way round."""
    if stored is None:
        return x
    if form.parts:
        pieces: list[Number] = []
        for part in form.parts:
            pieces, x = [*pieces, *stored_numbers(part, x[: part.size], stored)], x[part.size :]
        return tuple(pieces)
    if form.name not in _KINDS:
        return x
    (n, k), layout = _KINDS[form.name], stored.layout(form)
    m = len(x) - k
    q, t = x[:m], x[m:]
    if _is_whole(form, layout):
        rows = tuple((*row, e) for row, e in zip(_rotation_matrix(q), t, strict=True))
        return _flat((*rows, (mp.zero,) * n + (mp.one,)) if layout.pose == "4x4" else rows, layout)
    kept = {
        "xyzw": lambda: q,
        "cos-sin": lambda: q,
        "wxyz": lambda: (q[3], *q[:3]),
        "angle": lambda: (mp.atan2(q[1], q[0]),),
        "matrix": lambda: _flat(_rotation_matrix(q), layout),
    }[_kind(n, layout)]()
    return (*t, *kept) if _translation_first(form, layout) else (*kept, *t)


def count(form: ManifoldForm, stored: Stored) -> int:
    """How many numbers are stored."""
    own = (mp.one,) * form.size
    return len(stored_numbers(form, own, stored))


def _is_whole(form: ManifoldForm, layout: Layout) -> bool:
    return form.name in ("SE2", "SE3") and layout.pose != "parts"


def _kind(n: int, layout: Layout) -> str:
    return layout.rotation if n == 3 else layout.plane


def _translation_first(form: ManifoldForm, layout: Layout) -> bool:
    return form.name in ("SE2", "SE3") and layout.first == "translation"


def _split(form: ManifoldForm, x: Vector, k: int, layout: Layout) -> tuple[Vector, Vector]:
    """The numbers of the rotation and the others."""
    if _translation_first(form, layout):
        return x[k:], x[:k]
    return x[: len(x) - k], x[len(x) - k :]


def _rotation(x: Vector, n: int, layout: Layout) -> Vector:
    kind = _kind(n, layout)
    if kind == "matrix":
        return _own_rotation(_matrix(x, n, n, layout))
    if kind == "angle":
        return (mp.cos(x[0]), mp.sin(x[0]))
    return (*x[1:], x[0]) if kind == "wxyz" else x


def _matrix(x: Vector, rows: int, columns: int, layout: Layout) -> Matrix:
    if layout.order == "column":
        return transpose(tuple(tuple(x[rows * j : rows * j + rows]) for j in range(columns)))
    return tuple(tuple(x[columns * i : columns * i + columns]) for i in range(rows))


def _flat(rows: Matrix, layout: Layout) -> Vector:
    return tuple(x for row in (transpose(rows) if layout.order == "column" else rows) for x in row)


def _rotation_matrix(q: Vector) -> Matrix:
    if len(q) == 4:
        return load_so3(q)
    c, s = normalised(q)
    return ((c, -s), (s, c))


def _own_rotation(matrix: Matrix) -> Vector:
    """The group's own numbers of the rotation that is nearest to a matrix."""
    if len(matrix) == 2:
        (a, b), (c, d) = matrix
        return normalised((a + d, c - b))
    for _ in range(40):
        inverse: list[list[Number]] = (mp.matrix([list(row) for row in matrix]) ** -1).tolist()
        nearer = tuple(tuple((matrix[i][j] + inverse[j][i]) / 2 for j in range(3)) for i in range(3))
        moved = max(abs(nearer[i][j] - matrix[i][j]) for i in range(3) for j in range(3))
        matrix = nearer
        if moved < mp.eps**0.5:  # it converges quadratically: the next step would change nothing
            return store_so3(matrix, None)
    return (mp.nan,) * 4
