"""Which chart a manifold has in a preset, and a line that says so."""

from __future__ import annotations

from liegen.errors import DefinitionError
from liegen.manifolds import ManifoldForm
from liegen.manifolds.form import PoseForm, RotationForm
from liegen.manifolds.gal3_form import Gal3Form
from liegen.manifolds.product_form import ProductForm
from liegen.manifolds.se23_form import SE23Form
from liegen.manifolds.similarity_form import SimilarityForm

from .chart import Chart, Preset
from .contract import FormChart
from .poses import CoupledChart, SplitChart
from .presets import PRESETS
from .products import ProductChart
from .rotations import RotationChart


def form_chart(form: ManifoldForm, preset: Preset) -> FormChart | None:
    """The preset's chart of a manifold; None where it is the manifold's own: vectors, S2, calibrations too.

    Products have the charts of their parts. Raises DefinitionError where the chart does not exist for the
    manifold.
    """
    if isinstance(form, ProductForm):
        charts = tuple(form_chart(part, preset) for part in form.parts)
        return ProductChart(form, charts, form.note) if any(charts) else None
    if isinstance(form, SimilarityForm | SE23Form | Gal3Form):
        return _only_chart(form, preset)
    if not isinstance(form, RotationForm | PoseForm):
        return None
    chart = preset.chart(form)
    rotation = form if isinstance(form, RotationForm) else form.rotation
    if rotation.space == 2 and chart.rotation != "exp":
        raise DefinitionError(
            f"{form.name} has no chart with rotation={chart.rotation!r}; its rotation maps are: 'exp'"
        )
    turns = chart.rotation == "exp" and chart.scale == 1 and (chart.side == "right" or rotation.space == 2)
    if isinstance(form, RotationForm):
        return None if turns else RotationChart(form, chart, _note(form, preset, rotation_only=True))
    note = _note(form, preset, rotation_only=False)
    if chart.translation != "coupled":
        return SplitChart(form, chart, note)
    if chart.rotation != "exp":
        raise DefinitionError(
            f"{form.name} has no coupled chart with rotation={chart.rotation!r}; "
            "those with translation='body' and translation='world' exist, and 'coupled' with rotation='exp'"
        )
    own = "rotation-first" if form.rotation_first else "translation-first"
    same = chart.order in ("own", own) and chart.side == "right" and chart.scale == 1
    return None if same else CoupledChart(form, chart, note)


def has_charts(form: ManifoldForm) -> bool:
    """Whether the manifold, or a part of it, has more than one chart."""
    return isinstance(form, RotationForm | PoseForm) or any(map(has_charts, form.parts))


def _only_chart(form: ManifoldForm, preset: Preset) -> None:
    """GTSAM's alone; raises DefinitionError for what a preset means by another chart."""
    if preset.chart(form) != Chart():
        names = [repr(p.name) for p in PRESETS.values() if p.chart(form) == Chart()]
        own = form.note.rpartition("; ")[2]
        raise DefinitionError(
            f"{form.name} has no chart {preset.name!r}; the one that exists is {own}, chart "
            f"{' or '.join(names)}, with the tangent {', '.join(form.tangent)}"
        )


_MAPPED = {
    "exp": "exp({})",
    "cayley": "cayley({})",
    "quaternion-vector": "q({})",
}


def _note(form: RotationForm | PoseForm, preset: Preset, *, rotation_only: bool) -> str:
    """``SE3, chart g2o: stored ...; tangent: ...; retract: R' = ..., t' = ...``."""
    chart = preset.chart(form)
    stored = form.note.partition(": ")[2].partition(";")[0]
    angle = "d" if rotation_only else "w"
    scaled = f"{chart.scale} {angle}" if chart.scale != 1 else angle
    moved = _MAPPED[chart.rotation].format(scaled)
    step = f"{moved} R" if chart.side == "left" else f"R {moved}"
    meaning = {
        "exp": "",
        "cayley": "; cayley(a): the rotation by |a| = 2 tan(angle / 2)",
        "quaternion-vector": "; q(a): the rotation whose unit quaternion has the vector part a / 2",
    }[chart.rotation]
    if rotation_only:
        return f"{form.name}, chart {preset.name}: {stored}; tangent: d; retract: R' = {step}{meaning}"
    whole = isinstance(form, PoseForm) and form.rotation_first
    first = whole if chart.order == "own" else chart.order == "rotation-first"
    names = f"rotation {angle}, translation v [m]" if first else f"translation v [m], rotation {angle}"
    if chart.translation == "coupled":
        both = f"exp({scaled}, v)"
        step = f"{both} x" if chart.side == "left" else f"x {both}"
        return f"{form.name}, chart {preset.name}: {stored}; tangent: {names}; retract: {step}"
    place = "t + v" if chart.translation == "world" else "t + R v"
    return f"{form.name}, chart {preset.name}: {stored}; tangent: {names}; R' = {step}, t' = {place}{meaning}"
