"""A graph in other charts: pure rewriting, everything but ``local`` and ``retract`` stays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from liegen.charts import GTSAM, Chart, Preset, form_chart, has_charts, preset
from liegen.errors import DefinitionError
from liegen.manifolds import Node, Operation

from .graph import Graph, Parameter, topological

#: A chart for everything, by name or as a value, or charts by variable.
ChartLike = str | Chart | Preset | Mapping[str, str | Chart | Preset]


def in_charts(graph: Graph, chart: ChartLike | None) -> Graph:
    """The same factor with ``local`` and ``retract``, columns and rows in other charts.

    One chart is that of everything; a mapping gives charts to the columns of single variables, the rest
    stays in GTSAM's. Manifolds without such a chart (vectors, S2, calibrations) keep their own. Raises
    DefinitionError for a chart that does not exist, and in a mapping for what is no variable or has no
    charts.
    """
    if chart is None:
        return graph
    what = f"{graph.site}: {graph.name}"
    common = common_chart(chart, what)
    single = not isinstance(chart, Mapping)
    own = {} if single else {name: preset(c, f"{what}: chart of {name!r}") for name, c in chart.items()}
    variables = {p.name: p for p in graph.variables}
    for name in own:
        _refuse_other(name, variables, what)
    try:
        for form in (n.manifold.form for n in graph.nodes()):
            form_chart(form, common)
        parameters = tuple(_parameter(p, own.get(p.name, common)) for p in graph.parameters)
        return replace(_rewritten(graph, common), parameters=parameters, chart=common)
    except DefinitionError as error:
        raise DefinitionError(f"{what}: {error}") from None


def common_chart(chart: ChartLike | None, what: str) -> Preset:
    """The chart of ``local`` and ``retract``: GTSAM's where none, or only those of variables, are stated."""
    return GTSAM if chart is None or isinstance(chart, Mapping) else preset(chart, what)


def _refuse_other(name: str, variables: Mapping[str, Parameter], what: str) -> None:
    if name not in variables:
        raise DefinitionError(
            f"{what}: chart={{{name!r}: ...}} names no variable; there are {', '.join(variables)}"
        )
    form = variables[name].manifold.form
    if not has_charts(form):
        raise DefinitionError(
            f"{what}: {name!r} is {form.name}, which has only its own chart; charts exist for SO2, SE2, "
            "SO3, SE3 and products of these"
        )


def _parameter(p: Parameter, chart: Preset) -> Parameter:
    form_chart(p.manifold.form, chart)  # refuses what does not exist
    return replace(p, chart=chart)


def _rewritten(graph: Graph, chart: Preset) -> Graph:
    moved: dict[int, Node] = {}
    stated = [node for s in graph.singular for node in s.zeros]
    for node in topological([*graph.nodes(), *stated]):
        operation, operands = _operation(node, chart), tuple(moved[id(n)] for n in node.operands)
        same = operation is node.operation and all(
            a is b for a, b in zip(operands, node.operands, strict=True)
        )
        moved[id(node)] = node if same else Node(operation, operands, node.site)
    return replace(
        graph,
        outputs=tuple((name, moved[id(node)]) for name, node in graph.outputs),
        domain=tuple(replace(d, condition=moved[id(d.condition)]) for d in graph.domain),
        singular=tuple(replace(s, zeros=tuple(moved[id(n)] for n in s.zeros)) for s in graph.singular),
        calls=(),  # of use to the check of frames only, which has been
    )


def _operation(node: Node, chart: Preset) -> Operation:
    """``local`` and ``retract`` in a chart carry it as their parameter."""
    old = node.operation
    if old.name not in ("local", "retract"):
        return old
    found = form_chart(node.operands[0].manifold.form, chart)
    if found is None:
        return old
    value = found.local if old.name == "local" else found.retract
    blocks = found.local_blocks() if old.name == "local" else found.retract_blocks()
    return Operation(old.name, old.result, value, blocks, old.show, (chart,))
