"""Charts of rotations: coordinates, local blocks, and the map of a Jacobian's columns."""

from __future__ import annotations

from dataclasses import dataclass

from liegen.algebra.factors import Word
from liegen.algebra.linear import Chain, Matrix, Vector, eye, matscale, negated, transpose
from liegen.manifolds.form import Blocks, Coords, RotationForm, Rule

from .chart import Chart
from .contract import FormChart
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
            slope = self.map.slope(d)
            if self.left:
                return (eye(self.form.dim),), (*self.form.turned(x, inverse=True), slope)
            return self.form.Ad_inverse(self.map.rotation(d)), (slope,)

        return blocks

    def local_blocks(self) -> Rule:
        """Right: d/dy = slope^-1, d/dx = -slope^-T; left: d/dy = -d/dx = slope^-T R_y = slope^-1 R_x."""

        def blocks(r: Coords, x: Coords, y: Coords) -> Blocks:
            by_x, by_y = self.local_slopes(r, x, y)
            if self.left:
                return (negated((by_x, *self.form.turned(x))), (by_y, *self.form.turned(y)))
            return negated((by_x,)), (by_y,)

        return blocks

    def local_slopes(self, r: Coords, x: Coords, y: Coords) -> tuple[Matrix, Matrix]:
        """The slopes of ``local_blocks`` by x (without its sign) and by y, as seen by the chart's side."""
        slope = self.map.slope_inv(r, self.turned(x, y))
        return (slope, transpose(slope)) if self.left else (transpose(slope), slope)

    def word(self, x: Coords, *, inverse: bool = False) -> Word:
        """What turns the body's axes into those of the coordinates: R for left charts in space."""
        return (self.form.letter(x, inverse=inverse),) if self.left else ()

    def columns(self, x: Coords) -> Chain:
        """Either k I or k R^T."""
        scaled = matscale(self.chart.scale, eye(self.form.dim))
        return (*self.form.turned(x, inverse=True), scaled) if self.left else (scaled,)

    def rows(self, x: Coords) -> Chain:
        """Either I/k or R/k."""
        scaled = matscale(self.map.down, eye(self.form.dim))
        return (scaled, *self.form.turned(x)) if self.left else (scaled,)
