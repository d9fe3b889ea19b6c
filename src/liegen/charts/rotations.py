"""Charts of rotations: coordinates, local blocks, and the map of a Jacobian's columns."""

from __future__ import annotations

from dataclasses import dataclass

from liegen.algebra.linear import Chain, Vector, eye, matscale, transpose
from liegen.manifolds.form import Blocks, Coords, RotationForm, Rule

from .chart import Chart
from .contract import FormChart, negated
from .rotation_maps import MAPS, RotationMap


@dataclass(frozen=True)
class RotationChart(FormChart):
    """R' = R m(k d) or m(k d) R."""

    form: RotationForm
    chart: Chart
    note: str = ""

    @property
    def map(self) -> RotationMap:
        """The map m(k d)."""
        return MAPS[self.chart.rotation](self.form, self.chart.scale)

    @property
    def left(self) -> bool:
        """Whether the rotation stands on the left; in the plane both sides are the same."""
        return self.chart.side == "left" and self.form.space == 3

    def turned(self, x: Coords, y: Coords) -> Vector:
        """The rotation from x to y: x^-1 y, or y x^-1."""
        return self.form.compose(y, self.form.inverse(x)) if self.left else self.form.between(x, y)

    def retract(self, x: Coords, d: Coords) -> Vector:
        """R m(k d) or m(k d) R."""
        moved = self.map.rotation(d)
        return self.form.compose(moved, x) if self.left else self.form.compose(x, moved)

    def local(self, x: Coords, y: Coords) -> Vector:
        """Coordinates of R_x^T R_y or of R_y R_x^T."""
        return self.map.vector(self.turned(x, y))

    def retract_blocks(self) -> Rule:
        """Right: d/dx = m^T, d/dd = slope; left: d/dx = I, d/dd = R^T slope."""

        def blocks(_: Coords, x: Coords, d: Coords) -> Blocks:
            slope, turn = self.map.slope(d), self.form.matrix
            if self.left:
                return (eye(self.form.dim),), (transpose(turn(x)), slope)
            return self.form.adjoint_inverse(self.map.rotation(d)), (slope,)

        return blocks

    def local_blocks(self) -> Rule:
        """Right: d/dy = slope^-1, d/dx = -slope^-T; left: d/dy = -d/dx = slope^-T R_y = slope^-1 R_x."""

        def blocks(r: Coords, x: Coords, y: Coords) -> Blocks:
            slope = self.map.slope_inv(r, self.turned(x, y))
            if self.left:
                by_y = (transpose(slope), self.form.matrix(y))
                return negated((slope, self.form.matrix(x))), by_y
            return negated((transpose(slope),)), (slope,)

        return blocks

    def columns(self, x: Coords) -> Chain:
        """Either k I or k R^T."""
        turn = transpose(self.form.matrix(x)) if self.left else eye(self.form.dim)
        return (matscale(self.chart.scale, turn),)

    def rows(self, x: Coords) -> Chain:
        """Either I/k or R/k."""
        return (matscale(self.map.down, self.form.matrix(x) if self.left else eye(self.form.dim)),)
