"""A function in every preset, those that are the same for it taken together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from liegen.charts import PRESETS, form_chart
from liegen.errors import DefinitionError
from liegen.manifolds import ManifoldForm
from liegen.manifolds.form import RotationForm
from liegen.trace import Graph
from liegen.verify.draws import AnyFunction

SAME = "presets make no difference: each of its charts is the only one of its manifold"


@dataclass(frozen=True)
class Variant:
    """A function in a chart, and the presets that have this chart for all of its manifolds."""

    function: AnyFunction
    presets: tuple[str, ...]


@dataclass(frozen=True)
class Remark:
    """Presets that do not apply to a function, and why."""

    function: str
    presets: tuple[str, ...]
    reason: str


def variants(
    functions: Sequence[AnyFunction], presets: Iterable[str]
) -> tuple[tuple[Variant, ...], tuple[Remark, ...]]:
    """Every function in each chart that differs for it; where presets make no difference or do not exist."""
    found: list[Variant] = []
    remarks: list[Remark] = []
    names = tuple(presets)
    for function in functions:
        mine, said = _of_function(function, names)
        found += mine
        remarks += said
    return tuple(found), tuple(remarks)


def _of_function(function: AnyFunction, names: tuple[str, ...]) -> tuple[list[Variant], list[Remark]]:
    if function.chart is not None:
        reason = "the factor states its chart itself"
        return [Variant(function, names)], [Remark(function.name, names, reason)]
    charted: dict[Any, tuple[AnyFunction, list[str]]] = {}
    refused: dict[str, str] = {}
    for name in names:
        try:
            inside = function.in_chart(name)
            charted.setdefault(_key(inside.graph, name), (inside, []))[1].append(name)
        except DefinitionError as error:
            refused[name] = str(error).partition(f"{function.name}: ")[2] or str(error)
    found = [Variant(f, tuple(presets)) for f, presets in charted.values()]
    if refused:
        return found, [Remark(function.name, tuple(refused), next(iter(refused.values())))]
    if not _charted(function.graph):
        return found, [Remark(function.name, names, SAME)]
    return found, []


def _charted(graph: Graph) -> bool:
    """Whether any preset changes anything."""
    return any(_key(graph, name) != _key(graph, "gtsam") for name in PRESETS)


def _key(graph: Graph, name: str) -> tuple[Any, ...]:
    """What the preset says of each manifold whose chart the results depend on."""
    nodes = [n for n in graph.nodes() if n.operation.name in ("retract", "local")]
    forms = [p.manifold.form for p in graph.variables]
    forms += [node.manifold.form for _, node in graph.outputs] if forms else []
    forms += [n.operands[0].manifold.form for n in nodes]
    return tuple((form.name, _choice(form, name)) for form in forms)


def _choice(form: ManifoldForm, name: str) -> Any:
    """The choices that matter; None for the manifold's own chart."""
    if form.parts:
        return tuple(_choice(part, name) for part in form.parts)
    if form_chart(form, PRESETS[name]) is None:
        return None
    chart = PRESETS[name].chart(form)
    turn = (chart.side, chart.rotation, chart.scale)
    return turn if isinstance(form, RotationForm) else (*turn, chart.translation, _order(chart.order, form))


def _order(order: str, form: Any) -> str:
    return order if order != "own" else "rotation-first" if form.rotation_first else "translation-first"
