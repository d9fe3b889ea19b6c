"""Parameters whose leading numbers are tangent coordinates: calibrations of cameras."""

from __future__ import annotations

from liegen.algebra.linear import Vector

from .form import Coords, ManifoldForm


class AdditiveForm(ManifoldForm):
    """Stored numbers of which the first ``dim`` move by addition, the rest are fixed."""

    def retract(self, x: Coords, d: Coords) -> Vector:
        return (*(a + b for a, b in zip(x, d, strict=False)), *x[self.dim :])

    def local(self, x: Coords, y: Coords) -> Vector:
        return tuple(y[k] - x[k] for k in range(self.dim))
