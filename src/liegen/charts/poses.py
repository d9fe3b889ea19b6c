"""Charts of poses: coordinates, local blocks, and the map of a Jacobian's columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from liegen.algebra.linear import (
    Chain,
    Matrix,
    Vector,
    add,
    beside,
    eye,
    matmul,
    matscale,
    matvec,
    negate,
    product,
    stacked,
    sub,
    transpose,
    zeros,
)
from liegen.manifolds.form import Blocks, Compute, Coords, PoseForm, Rule

from .chart import Chart
from .contract import FormChart, negated
from .rotations import RotationChart


@dataclass(frozen=True)
class PoseChart(FormChart):
    """What charts of poses share: the order of the tangent's coordinates."""

    form: PoseForm
    chart: Chart
    note: str = ""

    @property
    def turning(self) -> RotationChart:
        """The chart of the rotation."""
        return RotationChart(self.form.rotation, self.chart)

    @property
    def rotation_first(self) -> bool:
        """Whether the rotation's coordinates come first."""
        own = self.form.rotation_first
        return own if self.chart.order == "own" else self.chart.order == "rotation-first"

    def in_order(self, rotation: Matrix, translation: Matrix) -> tuple[Matrix, Matrix]:
        """Columns or rows of both parts in the chart's order."""
        return (rotation, translation) if self.rotation_first else (translation, rotation)

    def parts(self, d: Coords) -> tuple[Vector, Vector]:
        """Coordinates of the rotation and of the translation."""
        n = self.form.rotation.dim if self.rotation_first else self.form.rotation.space
        first, second = tuple(d[:n]), tuple(d[n:])
        return (first, second) if self.rotation_first else (second, first)

    def to_own(self, rotation: Matrix, translation: Matrix) -> Matrix:
        """diag(rotation, translation): rows in the group's order, columns in the chart's."""
        form = self.form
        dim, space = form.rotation.dim, form.rotation.space
        turn = beside(*self.in_order(rotation, zeros(dim, space)))
        move = beside(*self.in_order(zeros(space, dim), translation))
        return stacked(*form.in_order(turn, move))

    def from_own(self, rotation: Matrix, translation: Matrix) -> Matrix:
        """diag(rotation, translation): rows in the chart's order, columns in the group's."""
        return transpose(self.to_own(transpose(rotation), transpose(translation)))


@dataclass(frozen=True)
class CoupledChart(PoseChart):
    """x exp(E d) or exp(E d) x: E orders the coordinates and scales those of the rotation."""

    @property
    def left(self) -> bool:
        """Whether the exponential stands on the left."""
        return self.chart.side == "left"

    @property
    def E(self) -> Matrix:
        """From the chart's coordinates to the group's."""
        n, m = self.form.rotation.dim, self.form.rotation.space
        return self.to_own(matscale(self.chart.scale, eye(n)), eye(m))

    @property
    def E_inv(self) -> Matrix:
        """From the group's coordinates to the chart's."""
        n, m = self.form.rotation.dim, self.form.rotation.space
        return self.from_own(matscale(self.turning.map.down, eye(n)), eye(m))

    def retract(self, x: Coords, d: Coords) -> Vector:
        """The product x exp(E d) or exp(E d) x."""
        moved = self.form.exp(matvec(self.E, d))
        return self.form.compose(moved, x) if self.left else self.form.compose(x, moved)

    def local(self, x: Coords, y: Coords) -> Vector:
        """E^-1 log(x^-1 y) or E^-1 log(y x^-1)."""
        form = self.form
        turned = form.compose(y, form.inverse(x)) if self.left else form.between(x, y)
        return matvec(self.E_inv, form.log(turned))

    def retract_blocks(self) -> Rule:
        """Right: Ad(exp)^-1, Jr E; left: I, Ad(x^-1) Jr E."""

        def blocks(_: Coords, x: Coords, d: Coords) -> Blocks:
            form, own = self.form, matvec(self.E, d)
            by_d: Chain = (form.Jr(own), self.E)
            if self.left:
                return (eye(form.dim),), (*form.adjoint_inverse(x), *by_d)
            return form.adjoint_inverse(form.exp(own)), by_d

        return blocks

    def local_between(self) -> tuple[Compute, Rule] | None:
        """E^-1 times the group's own, for the right side."""
        known = None if self.left else self.form.local_between()
        if known is None:
            return None
        own_value: Any = known[0]
        own_rule: Any = known[1]

        def value(z: Coords, x: Coords, y: Coords) -> Vector:
            return matvec(self.E_inv, own_value(z, x, y))

        def blocks(r: Coords, z: Coords, x: Coords, y: Coords) -> Blocks:
            chains: tuple[Chain, ...] = own_rule(matvec(self.E, r), z, x, y)
            return tuple([(self.E_inv, *chain) for chain in chains])

        return value, blocks

    def local_blocks(self) -> Rule:
        """Right: -E^-1 Jl^-1, E^-1 Jr^-1; left: -d/dy, E^-1 Jr^-1 Ad(x)."""

        def blocks(r: Coords, x: Coords, y: Coords) -> Blocks:
            form, own = self.form, matvec(self.E, r)
            if self.left:
                by_y: Chain = (self.E_inv, form.Jr_inv(own, principal=True), *form.adjoint(x))
                return negated(by_y), by_y
            by_x: Chain = (self.E_inv, form.Jl_inv(own, principal=True))
            return negated(by_x), (self.E_inv, form.Jr_inv(own, principal=True))

        return blocks

    def columns(self, x: Coords) -> Chain:
        """Either E or Ad(x^-1) E."""
        return (*self.form.adjoint_inverse(x), self.E) if self.left else (self.E,)

    def rows(self, x: Coords) -> Chain:
        """Either E^-1 or E^-1 Ad(x)."""
        return (self.E_inv, *self.form.adjoint(x)) if self.left else (self.E_inv,)


@dataclass(frozen=True)
class SplitChart(PoseChart):
    """The rotation as a ``RotationChart``, the translation added to t: v in the world, R v in the body."""

    @property
    def world(self) -> bool:
        """Whether the translation's coordinates are along the world's axes."""
        return self.chart.translation == "world"

    def _split(self, x: Coords) -> tuple[Vector, Vector, Matrix]:
        q = self.form.rotation_of(x)
        return q, self.form.translation_of(x), self.form.rotation.matrix(q)

    def retract(self, x: Coords, d: Coords) -> Vector:
        """The rotation moved, and t + v or t + R v."""
        q, t, R = self._split(x)
        w, v = self.parts(d)
        return self.form.join(self.turning.retract(q, w), add(t, v if self.world else matvec(R, v)))

    def local(self, x: Coords, y: Coords) -> Vector:
        """The rotation's coordinates, and t_y - t_x or R_x^T (t_y - t_x)."""
        (q, t, R), (p, s, _) = self._split(x), self._split(y)
        w, v = self.turning.local(q, p), sub(s, t)
        move = v if self.world else matvec(transpose(R), v)
        return (*w, *move) if self.rotation_first else (*move, *w)

    def retract_blocks(self) -> Rule:
        """With z the result: d/dx of t' by R, t, and d/dv, seen from z by R_z^T."""

        def blocks(z: Coords, x: Coords, d: Coords) -> Blocks:
            form = self.form
            (q, _, R), (p, _, S), (w, v) = self._split(x), self._split(z), self.parts(d)
            turning: Any = self.turning.retract_blocks()
            by_q, by_w = turning(p, q, w)
            back = matmul(transpose(S), R)
            dim, space = form.rotation.dim, form.rotation.space
            swing = zeros(space, dim) if self.world else matmul(back, form.rotation.generator(v))
            turn = beside(*form.in_order(product(by_q), zeros(dim, space)))
            by_x = stacked(*form.in_order(turn, beside(*form.in_order(swing, back))))
            return (by_x,), (self.to_own(product(by_w), transpose(S) if self.world else back),)

        return blocks

    def local_blocks(self) -> Rule:
        """World: rows -R_x, R_y of the translation; body: with u the result [-G(u), -I] and R_x^T R_y."""

        def blocks(r: Coords, x: Coords, y: Coords) -> Blocks:
            form = self.form
            (q, _, R), (p, _, S), (w, u) = self._split(x), self._split(y), self.parts(r)
            turning: Any = self.turning.local_blocks()
            by_q, by_p = turning(w, q, p)
            dim, space = form.rotation.dim, form.rotation.space
            ((slope_x, *rest_x), (slope_y, *rest_y)) = by_q, by_p
            turn_x, turn_y = (rest[0] if rest else eye(dim) for rest in (rest_x, rest_y))
            none = zeros(space, dim)
            swing = none if self.world else _negative(form.rotation.generator(u))
            away = _negative(R) if self.world else _negative(eye(space))
            along = S if self.world else matmul(transpose(R), S)
            return (
                self._rows(slope_x, turn_x, swing, away),
                self._rows(slope_y, turn_y, none, along),
            )

        return blocks

    def _rows(self, slope: Matrix, turn: Matrix, swing: Matrix, move: Matrix) -> Chain:
        """diag(slope, I) [[turn, 0], [swing, move]], in the chart's and in the group's order."""
        form, (dim, space) = self.form, (self.form.rotation.dim, self.form.rotation.space)
        inner = stacked(
            *form.in_order(
                beside(*form.in_order(turn, zeros(dim, space))), beside(*form.in_order(swing, move))
            )
        )
        return self.from_own(slope, eye(space)), inner

    def columns(self, x: Coords) -> Chain:
        """diag(k I or k R^T, I or R^T)."""
        q, _, R = self._split(x)
        move = transpose(R) if self.world else eye(self.form.rotation.space)
        return (self.to_own(self.turning.columns(q)[0], move),)

    def rows(self, x: Coords) -> Chain:
        """diag(I/k or R/k, I or R)."""
        q, _, R = self._split(x)
        return (self.from_own(self.turning.rows(q)[0], R if self.world else eye(self.form.rotation.space)),)


def _negative(a: Matrix) -> Matrix:
    return tuple(negate(row) for row in a)
