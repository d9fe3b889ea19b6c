"""The charts of the reference, on matrices: rotations by ``expm``, coordinates from the matrix logarithm.

Independent of liegen's charts: nothing here is a closed form of a quaternion, and no Jacobian is stated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .logarithms import Branch
from .matrix import Element, Matrix, Number, Vector, add, length, matmul, matvec, mp, scale, sub, transpose
from .products import product_space
from .spaces import GROUPS, GroupSpace, Space, pose, rotation_of, sized, space_of_form, translation_of

if TYPE_CHECKING:
    from liegen.charts import Chart, Preset
    from liegen.manifolds import ManifoldForm, Value

#: Name of the rotations, dimension of their tangent and of the vectors, whether the rotation is first.
_KINDS: Mapping[str, tuple[str, int, int, bool]] = {
    "SO2": ("SO2", 1, 2, True),
    "SO3": ("SO3", 3, 3, True),
    "SE2": ("SO2", 1, 2, False),
    "SE3": ("SO3", 3, 3, True),
}


def _stretched(v: Vector, size: Callable[[Number], Number]) -> Vector:
    """``v`` with its length changed; to first order all these maps are the identity."""
    n = length(v)
    return scale(size(n) / n, v) if n else v


#: By rotation map: from the length of the coordinates to the angle, and from the angle to the length.
_ANGLES: Mapping[str, tuple[Callable[[Number], Number], Callable[[Number], Number]]] = {
    "exp": (lambda n: n, lambda a: a),
    "cayley": (lambda n: 2 * mp.atan(n / 2), lambda a: 2 * mp.tan(a / 2)),
    "quaternion-vector": (
        lambda n: 2 * mp.asin(n / 2) if n <= 2 else mp.nan,
        lambda a: 2 * mp.sin(a / 2),
    ),
}


@dataclass(frozen=True)
class _Rotations:
    """Coordinates of rotations."""

    group: GroupSpace
    chart: Chart

    def rotation_vector(self, w: Vector) -> Vector:
        """The rotation vector of coordinates."""
        return _stretched(scale(self.chart.scale, w), _ANGLES[self.chart.rotation][0])

    def coordinates(self, phi: Vector) -> Vector:
        """The coordinates of a rotation vector."""
        return scale(mp.one / self.chart.scale, _stretched(phi, _ANGLES[self.chart.rotation][1]))

    def near(self, w: Vector) -> Vector:
        """A rotation vector near to those of w; half a turn where none has such coordinates."""
        phi = self.rotation_vector(w)
        return phi if mp.isfinite(length(phi)) else scale(mp.pi / length(w), w)

    def retract(self, R: Matrix, w: Vector) -> Matrix:
        """R turned about the body's axes (right) or the world's (left)."""
        turn = self.group.exp(self.rotation_vector(w))
        return matmul(turn, R) if self.chart.side == "left" else matmul(R, turn)

    def local(self, R: Matrix, S: Matrix, branch: Branch) -> Vector:
        """Coordinates of R^T S, or of S R^T."""
        turn = matmul(S, transpose(R)) if self.chart.side == "left" else matmul(transpose(R), S)
        near = None if branch.near is None else self.near(branch.near)
        return self.coordinates(self.group.log(turn, replace(branch, near=near)))


@dataclass(frozen=True)
class _Poses:
    """Coordinates of poses."""

    group: GroupSpace
    turning: _Rotations
    chart: Chart
    sizes: tuple[int, int]  # of rotation and translation
    own_first: bool

    @property
    def first(self) -> bool:
        """Whether the rotation comes first."""
        return self.own_first if self.chart.order == "own" else self.chart.order == "rotation-first"

    def parts(self, d: Vector, *, first: bool) -> tuple[Vector, Vector]:
        """Rotation and translation of a tangent vector."""
        n = self.sizes[0] if first else self.sizes[1]
        return (d[:n], d[n:]) if first else (d[n:], d[:n])

    def to_own(self, d: Vector) -> Vector:
        """Coupled coordinates in the order and scale of the group."""
        w, v = self.parts(d, first=self.first)
        w = scale(self.chart.scale, w)
        return (*w, *v) if self.own_first else (*v, *w)

    def retract(self, T: Matrix, d: Vector) -> Matrix:
        """The pose that d leads to."""
        if self.chart.translation == "coupled":
            moved = self.group.exp(self.to_own(d))
            return matmul(moved, T) if self.chart.side == "left" else matmul(T, moved)
        w, v = self.parts(d, first=self.first)
        R, t = rotation_of(T), translation_of(T)
        return pose(
            self.turning.retract(R, w), add(t, v if self.chart.translation == "world" else matvec(R, v))
        )

    def local(self, T: Matrix, U: Matrix, branch: Branch) -> Vector:
        """The coordinates that lead from T to U."""
        if self.chart.translation == "coupled":
            back = self.group.inverse(T)
            turn = matmul(U, back) if self.chart.side == "left" else matmul(back, U)
            near = None if branch.near is None else self.to_own(branch.near)
            w, v = self.parts(self.group.log(turn, replace(branch, near=near)), first=self.own_first)
            w = scale(mp.one / self.chart.scale, w)
        else:
            near = None if branch.near is None else self.parts(branch.near, first=self.first)[0]
            w = self.turning.local(rotation_of(T), rotation_of(U), replace(branch, near=near))
            v = sub(translation_of(U), translation_of(T))
            v = v if self.chart.translation == "world" else matvec(transpose(rotation_of(T)), v)
        return (*w, *v) if self.first else (*v, *w)


def space_in(manifold: type[Value], preset: Preset | None) -> Space:
    """The reference's entry for a manifold, with retract and local of the preset's chart; None: GTSAM's."""
    return _space_in(manifold.form, preset)


def _space_in(form: ManifoldForm, preset: Preset | None) -> Space:
    space, name = space_of_form(form), form.name
    if preset is not None and form.parts:
        return product_space(sized(form), [_space_in(part, preset) for part in form.parts])
    if preset is None or name not in _KINDS:
        return space
    kind, turn, move, first = _KINDS[name]
    chart = preset.chart(form)
    rotations = _Rotations(GROUPS[kind], chart)
    charted = rotations if name == kind else _Poses(GROUPS[name], rotations, chart, (turn, move), first)

    def retract(x: Element, d: Vector, _: Branch) -> Element:
        return charted.retract(x, d)

    return Space(space.dim, space.load, space.store, retract, charted.local)
