"""Charts of products: every part in its own."""

from __future__ import annotations

from dataclasses import dataclass

from liegen.algebra.linear import Chain, Vector, eye
from liegen.manifolds.form import Coords, ManifoldForm, Rule
from liegen.manifolds.product_form import ProductForm, all_of, diagonal_chain, joined

from .contract import FormChart


@dataclass(frozen=True)
class ProductChart(FormChart):
    """Parts side by side; ``charts`` has None for a part that keeps its manifold's own chart."""

    form: ProductForm
    charts: tuple[FormChart | None, ...]
    note: str = ""

    @property
    def sides(self) -> tuple[FormChart | ManifoldForm, ...]:
        """What knows ``retract`` and ``local`` of each part."""
        return tuple(chart or form for chart, form in zip(self.charts, self.form.parts, strict=True))

    def retract(self, x: Coords, d: Coords) -> Vector:
        """Part by part."""
        moves = zip(self.sides, self.form.split(x), self.form.split_tangent(d), strict=True)
        return joined([side.retract(p, e) for side, p, e in moves])

    def local(self, x: Coords, y: Coords) -> Vector:
        """Part by part."""
        pairs = zip(self.sides, self.form.split(x), self.form.split(y), strict=True)
        return joined([side.local(p, q) for side, p, q in pairs])

    def retract_blocks(self) -> Rule | None:
        """Block diagonal."""
        known = all_of([side.retract_blocks() for side in self.sides])
        return self.form.retract_rule(known) if known else None

    def local_blocks(self) -> Rule | None:
        """Block diagonal."""
        known = all_of([side.local_blocks() for side in self.sides])
        return self.form.local_rule(known) if known else None

    def columns(self, x: Coords) -> Chain:
        """Block diagonal, with identities for parts in their own chart."""
        parts = zip(self.charts, self.form.parts, self.form.split(x), strict=True)
        return diagonal_chain([c.columns(p) if c else (eye(form.dim),) for c, form, p in parts])

    def rows(self, x: Coords) -> Chain:
        """Block diagonal, with identities for parts in their own chart."""
        parts = zip(self.charts, self.form.parts, self.form.split(x), strict=True)
        return diagonal_chain([c.rows(p) if c else (eye(form.dim),) for c, form, p in parts])
