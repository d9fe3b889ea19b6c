"""Parameters whose leading numbers are tangent coordinates: calibrations of cameras."""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra.linear import Vector, eye, negate

from .form import Coords, ManifoldForm, Rule, Source


class AdditiveForm(ManifoldForm):
    """Stored numbers of which the first ``dim`` move by addition, the rest are fixed."""

    flat = True
    usual: tuple[Sequence[float], Sequence[float]]  # least and largest usual values, to draw samples from

    def retract(self, x: Coords, d: Coords) -> Vector:
        return (*(a + b for a, b in zip(x, d, strict=False)), *x[self.dim :])

    def local(self, x: Coords, y: Coords) -> Vector:
        return tuple(y[k] - x[k] for k in range(self.dim))

    def retract_blocks(self) -> Rule:
        return lambda _, _x, _d: ((eye(self.dim),), (eye(self.dim),))

    def local_blocks(self) -> Rule:
        minus = tuple(negate(row) for row in eye(self.dim))
        return lambda _, _x, _y: ((minus,), (eye(self.dim),))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        return [source.uniform(low, high) for low, high in zip(*self.usual, strict=True)]

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        """A small part of the usual values."""
        widths = [high - low for low, high in zip(*self.usual, strict=True)]
        return [source.uniform(-0.1, 0.1) * width for width in widths[: self.dim]]
