"""All charts that a manifold may have: the presets, and every combination of the fields of a Chart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cache
from itertools import product
from typing import Any, get_args, get_type_hints

from liegen.charts import PRESETS, Chart, FormChart, Preset, form_chart
from liegen.errors import DefinitionError
from liegen.manifolds import ManifoldForm
from liegen.manifolds.form import PoseForm, RotationForm


@dataclass(frozen=True)
class Candidate:
    """A chart of a manifold, and the fields in which it differs from the factor's own."""

    preset: Preset
    chart: FormChart | None  # None: the manifold's own
    differing: tuple[tuple[str, Any], ...]  # field and its value
    named: bool  # whether it is the preset of a library

    @property
    def names(self) -> tuple[str, ...]:
        """The preset's name, if it is one."""
        return (self.preset.name,) if self.named else ()

    def size(self, phrases: int) -> float:
        """How large an explanation it is, told in so many phrases; that of a library is a smaller one."""
        return max(1.0, min(1.4, phrases) if self.named else 0.9 * phrases)

    @property
    def name(self) -> str:
        """The preset's name, or the Chart as it is written."""
        return self.preset.name


def order_in_words(order: Any) -> str:
    """Which part of a tangent comes before which."""
    return "translation before rotation" if order == "translation-first" else "rotation before translation"


def scale_in_words(scale: Any) -> str:
    """Which multiple of the angle the coordinates are."""
    return "half of" if scale == 2 else "twice"


@cache
def candidates(form: ManifoldForm, own: Preset) -> tuple[Candidate, ...]:
    """Presets first, then the combinations, those with fewer differences first."""
    charted = representative(form)
    if charted is None:
        return ()
    stated = resolved(own.chart(charted), charted)
    combined = [Preset(chart.description, chart, chart) for chart in _all_charts()]
    found: list[Candidate] = []
    seen: set[Chart] = set()
    for preset in (*PRESETS.values(), *combined):
        try:
            chart = form_chart(form, preset)
        except DefinitionError:
            continue
        other = resolved(preset.chart(charted), charted)
        if preset.name not in PRESETS and other in seen:
            continue
        seen.add(other)
        differing = tuple(
            (f.name, getattr(other, f.name))
            for f in fields(Chart)
            if getattr(other, f.name) != getattr(stated, f.name)
        )
        found.append(Candidate(preset, chart, differing, preset.name in PRESETS))
    return tuple(sorted(found, key=lambda c: (len(c.differing), not c.named)))


def representative(form: ManifoldForm) -> ManifoldForm | None:
    """The manifold itself, or the first part of a product that has several charts."""
    if isinstance(form, RotationForm | PoseForm):
        return form
    return next((r for part in form.parts if (r := representative(part)) is not None), None)


def resolved(chart: Chart, form: ManifoldForm) -> Chart:
    """The chart with only those choices that matter for the manifold."""
    if isinstance(form, PoseForm):
        own = "rotation-first" if form.rotation_first else "translation-first"
        order = own if chart.order == "own" else chart.order
        side = "right" if form.rotation.space == 2 and chart.translation != "coupled" else chart.side
        return Chart(side, chart.rotation, chart.scale, chart.translation, order)
    side = "right" if isinstance(form, RotationForm) and form.space == 2 else chart.side
    return Chart(side, chart.rotation, chart.scale)


def _all_charts() -> Iterator[Chart]:
    hints = get_type_hints(Chart)
    orders = ("own", "rotation-first", "translation-first")
    choices = [orders if f.name == "order" else get_args(hints[f.name]) for f in fields(Chart)]
    everything: Any = product(*choices)
    for values in everything:
        yield Chart(*values)
