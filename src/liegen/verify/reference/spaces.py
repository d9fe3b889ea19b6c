"""The manifolds of the reference, one entry each in a table: their storage, charts and group laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from . import extended, galilean, similarity, sphere
from .contract import GroupSpace, Space, Store
from .logarithms import Branch, log_se2, log_se3, log_so2, log_so3
from .matrix import (
    Matrix,
    Number,
    Vector,
    add,
    dot,
    expm,
    length,
    matmul,
    matvec,
    mp,
    normalised,
    scale,
    skew,
    sub,
    transpose,
)
from .products import product_group, product_space

if TYPE_CHECKING:
    from liegen.manifolds import ManifoldForm, Value


def _matrix_group(
    dim: int,
    load: Callable[[Vector], Matrix],
    store: Store,
    inverse: Callable[[Matrix], Matrix],
    exp: Callable[[Vector], Matrix],
    log: Callable[[Matrix, Branch], Vector],
) -> GroupSpace:
    """Products of elements are products of matrices; x.retract(d) = x exp(d), x.local(y) = log(x^-1 y)."""
    return GroupSpace(
        dim=lambda _: dim,
        load=load,
        store=store,
        retract=lambda x, d, _: matmul(x, exp(d)),
        local=lambda x, y, branch: log(matmul(inverse(x), y), branch),
        compose=matmul,
        inverse=inverse,
        exp=exp,
        log=log,
    )


def _as_stored(x: Vector, _: object) -> Vector:
    return x


def _load_so2(coords: Vector) -> Matrix:
    c, s = normalised(coords)
    return ((c, -s), (s, c))


def load_so3(q: Vector) -> Matrix:
    """Of the normalised quaternion (x, y, z, w)."""
    x, y, z, w = q
    n = dot(q, q)
    if not n:
        return ((mp.nan,) * 3,) * 3
    k = 2 / n
    return (
        (1 - k * (y * y + z * z), k * (x * y - w * z), k * (x * z + w * y)),
        (k * (x * y + w * z), 1 - k * (x * x + z * z), k * (y * z - w * x)),
        (k * (x * z - w * y), k * (y * z + w * x), 1 - k * (x * x + y * y)),
    )


def store_so3(R: Matrix, like: Sequence[float] | None) -> Vector:
    """The unit quaternion, from the row of its outer product 4 q q^T with the largest diagonal entry."""
    (a, b, c), (d, e, f), (g, h, i) = R
    rows = (
        (1 + a - e - i, b + d, c + g, h - f),
        (b + d, 1 + e - a - i, f + h, c - g),
        (c + g, f + h, 1 + i - a - e, d - b),
        (h - f, c - g, d - b, 1 + a + e + i),
    )
    q = normalised(rows[max(range(4), key=lambda k: rows[k][k])])
    side = q[3] if like is None else dot(q, _numbers(like[:4]))
    return scale(-mp.one, q) if side < 0 else q


def pose(R: Matrix, t: Vector) -> Matrix:
    """The homogeneous matrix [[R, t], [0, 1]]."""
    rows = tuple((*row, x) for row, x in zip(R, t, strict=True))
    return (*rows, (mp.zero,) * len(t) + (mp.one,))


def rotation_of(T: Matrix) -> Matrix:
    """The rotation block of a homogeneous matrix."""
    return tuple(row[:-1] for row in T[:-1])


def translation_of(T: Matrix) -> Vector:
    """The translation of a homogeneous matrix."""
    return tuple(row[-1] for row in T[:-1])


def _invert_pose(T: Matrix) -> Matrix:
    back = transpose(rotation_of(T))
    return pose(back, scale(-mp.one, matvec(back, translation_of(T))))


def _exp_pose(W: Matrix, angle: Number, v: Vector) -> Matrix:
    """The exponential of [[W, v], [0, 0]]; v enters linearly: it is scaled to the size of W meanwhile."""
    size = length(v)
    k = abs(angle) / size if angle and size else mp.one
    T = expm((*((*row, k * x) for row, x in zip(W, v, strict=True)), (mp.zero,) * (len(v) + 1)))
    return pose(rotation_of(T), scale(1 / k, translation_of(T)))


def _hat_so2(angle: Number) -> Matrix:
    return ((mp.zero, -angle), (angle, mp.zero))


def _turn_of(T: Matrix) -> Vector:
    R = similarity.rotation_of(T)
    return (R[0][0], R[1][0])


_SO2 = _matrix_group(
    1, _load_so2, lambda R, _: (R[0][0], R[1][0]), transpose, lambda d: expm(_hat_so2(d[0])), log_so2
)
_SO3 = _matrix_group(3, load_so3, store_so3, transpose, lambda d: expm(skew(d)), log_so3)
_SE2 = _matrix_group(
    3,
    lambda c: pose(_load_so2(c[:2]), c[2:]),
    lambda T, _: (T[0][0], T[1][0], *translation_of(T)),
    _invert_pose,
    lambda d: _exp_pose(_hat_so2(d[2]), d[2], d[:2]),
    log_se2,
)
_SE3 = _matrix_group(
    6,
    lambda c: pose(load_so3(c[:4]), c[4:]),
    lambda T, like: (*store_so3(rotation_of(T), like), *translation_of(T)),
    _invert_pose,
    lambda d: _exp_pose(skew(d[:3]), length(d[:3]), d[3:]),
    log_se3,
)
_SE23 = _matrix_group(
    9,
    lambda c: extended.extended(load_so3(c[:4]), c[4:7], c[7:]),
    lambda T, like: (
        *store_so3(extended.rotation_of(T), like), *extended.column_of(T, 3), *extended.column_of(T, 4),
    ),
    extended.inverse,
    extended.exp,
    extended.log,
)  # fmt: skip
_NAV_STATE = replace(
    _SE23,
    retract=extended.retract_componentwise,
    local=extended.local_componentwise,
)
_GAL3 = _matrix_group(
    10,
    lambda c: galilean.event(load_so3(c[:4]), c[4:7], c[7:10], c[10:]),
    lambda T, like: (
        *store_so3(extended.rotation_of(T), like),
        *extended.column_of(T, 4), *extended.column_of(T, 3), T[3][4],
    ),
    galilean.inverse,
    galilean.exp,
    galilean.log,
)  # fmt: skip
_SIM2 = _matrix_group(
    4,
    lambda c: similarity.similar(_load_so2(c[:2]), c[2:4], c[4:]),
    lambda T, _: (*_turn_of(T), *translation_of(T), similarity.scale_of(T)),
    similarity.inverse,
    lambda d: similarity.exp(_hat_so2(d[2]), d[:2], d[3]),
    similarity.log_sim2,
)
_SIM3 = _matrix_group(
    7,
    lambda c: similarity.similar(load_so3(c[:4]), c[4:7], c[7:]),
    lambda T, like: (
        *store_so3(similarity.rotation_of(T), like), *translation_of(T), similarity.scale_of(T),
    ),
    similarity.inverse,
    lambda d: similarity.exp(skew(d[:3]), d[3:6], d[6]),
    similarity.log_sim3,
)  # fmt: skip
#: R^n under addition; its exponential and logarithm are the identity.
_VECTORS = GroupSpace(
    dim=len,
    load=tuple,
    store=_as_stored,
    retract=lambda x, d, _: add(x, d),
    local=lambda x, y, _: sub(y, x),
    compose=add,
    inverse=lambda x: scale(-mp.one, x),
    exp=tuple,
    log=lambda x, _: x,
)
_S2 = Space(lambda _: 2, normalised, _as_stored, sphere.retract, sphere.local)
_CONDITION = Space(
    lambda _: 0, lambda c: bool(c[0]), lambda x, _: (x,), lambda x, _d, _: x, lambda _x, _y, _: ()
)


#: Results such as an adjoint; stored row by row, moved by addition.
_MATRICES = Space(
    dim=lambda m: len(m) * len(m[0]),
    load=tuple,
    store=lambda m, _: tuple(x for row in m for x in row),
    retract=lambda m, d, _: add(m, d),
    local=lambda m, n, _: sub(n, m),
)


def _leading(dim: int) -> Space:
    """Numbers of which the first ``dim`` move by addition and the rest stay: calibrations."""
    return Space(
        dim=lambda _: dim,
        load=tuple,
        store=_as_stored,
        retract=lambda x, d, _: (*add(x[:dim], d), *x[dim:]),
        local=lambda x, y, _: sub(y[:dim], x[:dim]),
    )


GROUPS: Mapping[str, GroupSpace] = {
    "SO2": _SO2,
    "SO3": _SO3,
    "SE2": _SE2,
    "SE3": _SE3,
    "SE23": _SE23,
    "NavState": _NAV_STATE,
    "Gal3": _GAL3,
    "Sim2": _SIM2,
    "Sim3": _SIM3,
    "R": _VECTORS,
}
SPACES: Mapping[str, Space] = {
    **GROUPS,
    "S2": _S2,
    "Cal3_S2": _leading(5),
    "Cal3DS2": _leading(9),
    "Cal3Bundler": _leading(3),
    "condition": _CONDITION,
    "matrix": _MATRICES,
}


def _key(form: ManifoldForm) -> str:
    """The name of the manifold; R1, R2, ... are all R, matrices of any size "matrix"."""
    name = form.name.rpartition(" ")[2]
    return "R" if name[:1] == "R" and name[1:].isdigit() else name


def space_of(manifold: type[Value]) -> Space:
    """The reference's entry for a manifold."""
    return space_of_form(manifold.form)


def group_of(manifold: type[Value]) -> GroupSpace:
    """The reference's entry for a group."""
    return _group(manifold.form)


def space_of_form(form: ManifoldForm) -> Space:
    """That of a form."""
    return (
        product_space(sized(form), list(map(space_of_form, form.parts))) if form.parts else SPACES[_key(form)]
    )


def _group(form: ManifoldForm) -> GroupSpace:
    return product_group(sized(form), list(map(_group, form.parts))) if form.parts else GROUPS[_key(form)]


def sized(form: ManifoldForm) -> list[tuple[int, int]]:
    """How many numbers each part of a product stores and moves."""
    return [(part.size, part.dim) for part in form.parts]


def _numbers(coords: Sequence[float]) -> Vector:
    return tuple(mp.mpf(float(c)) for c in coords)
