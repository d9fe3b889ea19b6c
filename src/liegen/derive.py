"""The middle of the path: a graph becomes a ``Kernel``, the derived and optimised factor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from liegen.algebra import Scalar
from liegen.algebra.linear import Matrix
from liegen.algebra.linear import Vector as Coordinates
from liegen.charts import GTSAM, Preset, form_chart
from liegen.choice import Way, entries, ranked
from liegen.differentiate import STRATEGIES, Expressions, expressions, fused, linearised, nested
from liegen.differentiate.local import symbols
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.layouts import OWN, Stored, storage
from liegen.manifolds import Manifold, ManifoldForm, MatrixValue, Vector
from liegen.names import jacobian_name
from liegen.noise import Weight, Weighting
from liegen.program import Port, Program
from liegen.program.lower import alone, lower
from liegen.program.passes import optimise
from liegen.program.rewrite import uncollected
from liegen.trace import Graph, Parameter, aligned, formula, jacobian_formulas, latex, latex_name, latex_rows

#: Orders whose counts are that close to the best one's are carried out: by this ratio, or this difference.
CLOSE, NEXT = 1.005, 2


@uncollected()
def derive(graph: Graph, weighting: Weighting | None = None, *, in_place: bool = False) -> Kernel:
    """Differentiate, whiten and weigh where ``weighting`` says so, lower and optimise.

    The orders of elimination are ranked by counting; of the best ones, with and without fused operations,
    the program with the fewest operations after all passes is kept, the first among equals. ``in_place`` as
    in :class:`Kernel`.
    """
    values = expressions(graph)
    ways = _ways(graph, values) if graph.variables else []
    begun = lowered(graph, values, {}, weighting, beside=entries(m for way in ways for m in way.blocks))
    value, rows = min(_values(graph, values, begun, weighting), key=lambda found: found[0].operations)
    name, best = "", value
    if ways:
        name, best, rows = min(_candidates(ways, begun, weighting), key=lambda c: c[1].operations)
    first = f"lower, {name} order" if name else "lower"
    passes = (PassCount(first, rows[0][1]), *(PassCount(*row) for row in rows[1:]))
    shown = unwhitened(graph) if weighting else graph
    return Kernel(
        name=graph.name,
        doc=graph.doc,
        site=graph.site,
        arguments=(
            *(_argument(p) for p in graph.parameters),
            *(_weight(w) for w in weights_of(graph, weighting)),
        ),
        outputs=tuple(_output(name, node.manifold.form, graph) for name, node in graph.outputs),
        formula=formula(shown),
        jacobian_formulas=jacobian_formulas(shown),
        conventions=_conventions(graph),
        value=value,
        jacobians=best,
        passes=passes,
        frames=graph.frames.lines if graph.frames.typed or "res" in dict(graph.outputs) else (),
        in_place=in_place,
        noise=noise_lines(graph, weighting),
    )


def _ways(graph: Graph, values: Expressions) -> list[Way]:
    """The local blocks as they are and without what cancels, fused and not, with products nested and not."""
    ways = [Way(graph, values, local) for local in linearised(graph, values)]
    inner = nested(graph)
    graphs = {id(g): g for g in (graph, fused(graph), inner, fused(inner))}
    for other in list(graphs.values())[1:]:
        shared = expressions(other, values)
        ways += [Way(other, shared, local) for local in linearised(other, shared)]
    return ways


def _values(
    graph: Graph, values: Expressions, begun: Program, weighting: Weighting | None
) -> Iterator[tuple[Program, tuple[tuple[str, int], ...]]]:
    """The programs of the values alone, with products as they are and nested, and their passes."""
    yield optimise(alone(begun))
    other = nested(graph)
    if other is not graph:
        yield optimise(lowered(other, expressions(other, values), {}, weighting))


def _candidates(
    ways: Sequence[Way], begun: Program, weighting: Weighting | None
) -> Iterator[tuple[str, Program, tuple[tuple[str, int], ...]]]:
    """The order, program and passes of each choice whose count is close to the best one's."""
    found = ranked(ways, begun)
    least = min(count for count, *_ in found)
    for count, way, name in found:
        if count <= max(CLOSE * least, least + NEXT):
            blocks = way.local.jacobians(STRATEGIES[name])
            yield name, *optimise(lowered(way.graph, way.values, blocks, weighting))


def weights_of(graph: Graph, weighting: Weighting | None) -> tuple[Weight, ...]:
    """The keywords that a weighting adds to a factor."""
    return weighting.weights(graph.outputs[0][1].manifold.form.dim) if weighting else ()


def unwhitened(graph: Graph) -> Graph:
    """The graph with its residual called ``r`` (with underscores where an argument is), to show formulas."""
    ((_, node),) = graph.outputs
    name = "r"
    while name in {p.name for p in graph.parameters}:
        name += "_"
    return replace(graph, outputs=((name, node),))


def noise_lines(graph: Graph, weighting: Weighting | None) -> tuple[str, ...]:
    """Noise, loss, mode, frame and formulas of a weighting."""
    if not weighting:
        return ()
    ((name, node),) = unwhitened(graph).outputs
    variables = [p.name for p in graph.variables]
    return weighting.lines(name, node.manifold.form.dim, variables, graph.frames.noise)


def function_latex(graph: Graph, weighting: Weighting | None) -> str:
    """Residual and Jacobians in LaTeX, before noise and loss, and then what these make of them."""
    if not weighting:
        return latex(graph)
    shown = unwhitened(graph)
    variables = [latex_name(p.name) for p in graph.variables]
    return aligned((*latex_rows(shown), *weighting.latex_rows(latex_name(shown.outputs[0][0]), variables)))


def lowered(
    graph: Graph,
    values: Expressions,
    blocks: Mapping[tuple[str, str], Matrix],
    weighting: Weighting | None = None,
    *,
    beside: Sequence[Scalar] = (),
) -> Program:
    """The outputs of a graph, and the given Jacobians, weighed, as a program without any pass.

    ``beside`` as in :func:`lower`.
    """
    given = weight_symbols(graph, weighting)
    scalars: dict[str, Coordinates] = {name: values.scalars[id(node)] for name, node in graph.outputs}
    if weighting:
        ((name, residual),) = scalars.items()
        scalars[name], blocks = weighting.apply(given, residual, blocks)
    stored = {name: storage(node.manifold.form, graph.layout) for name, node in graph.outputs}
    outputs = [(Port(name, s.shape), s.write(scalars[name])) for name, s in stored.items()]
    outputs += [
        (Port(jacobian_name(name, variable), (len(m), len(m[0]))), tuple(x for row in m for x in row))
        for (name, variable), m in blocks.items()
    ]
    return lowered_outputs(graph, values, given, outputs, beside)


def weight_symbols(graph: Graph, weighting: Weighting | None) -> dict[str, Coordinates]:
    """Fresh SX scalars of the keywords that a weighting adds."""
    return {w.name: symbols(f"{w.name}_", w.size) for w in weights_of(graph, weighting)}


def lowered_outputs(
    graph: Graph,
    values: Expressions,
    given: Mapping[str, Coordinates],
    outputs: Sequence[tuple[Port, Coordinates]],
    beside: Sequence[Scalar] = (),
) -> Program:
    """Expressions in a graph's scalars, and in the keywords ``given``, as a program without any pass."""
    arguments = {**values.inputs, **given}
    inputs = [(Port(name, (len(coords),)), coords) for name, coords in arguments.items()]
    domain = [(values.scalars[id(d.condition)][0], d.message) for d in graph.domain]
    return lower(graph.name, inputs, outputs, domain, beside)


def _argument(p: Parameter) -> Argument:
    form, stored = p.manifold.form, p.storage
    given = p.default if not p.variable else None
    default = None if given is None else tuple(float(c) for c in stored.write(given.coords))
    return Argument(
        p.name, form.name, stored.names, form.dim, p.variable, default=default, shape=stored.shape
    )


def _weight(weight: Weight) -> Argument:
    storage = tuple("_".join(map(str, place)) for place in np.ndindex(weight.shape))
    return Argument(weight.name, "numbers", storage, 0, False, weight.meaning, shape=weight.shape)


def _output(name: str, form: ManifoldForm, graph: Graph) -> Output:
    stored = storage(form, graph.layout)
    return Output(name, form.name, stored.names, form.dim, shape=stored.shape)


def _with_parts(form: ManifoldForm) -> tuple[ManifoldForm, ...]:
    """A form and, if it is a product, the forms of its parts."""
    return (form, *(inner for part in form.parts for inner in _with_parts(part)))


def _conventions(graph: Graph) -> tuple[str, ...]:
    """A line for each manifold that occurs; vectors and matrices that are only results need none."""
    results = [
        node.manifold for _, node in graph.outputs if not issubclass(node.manifold, Vector | MatrixValue)
    ]
    parameters: list[Any] = [p for _, node in graph.outputs for p in node.operation.parameters]
    owners = [p for p in parameters if isinstance(p, type) and issubclass(p, Manifold)]
    used = [(m.form, GTSAM, OWN) for m in owners]
    used += [(p.manifold.form, p.chart, p.layout) for p in graph.parameters]
    used += [(m.form, graph.chart, graph.layout) for m in results]
    used += [
        (node.operands[0].manifold.form, graph.chart, graph.layout)
        for node in graph.nodes()
        if graph.chart is not GTSAM and node.operation.name in ("local", "retract")
    ]
    parts = [(part, preset, stored) for form, preset, stored in used for part in _with_parts(form)]
    lines = [_convention(form, preset, stored) for form, preset, stored in parts]
    unit = ("Arguments are normalised: quaternions, (cos, sin) and directions as they are read",)
    return tuple(dict.fromkeys((*lines, *unit * graph.normalise)))


def _convention(form: ManifoldForm, preset: Preset, stored: Stored) -> str:
    """The note of a manifold or of its chart, with what it is stored as."""
    chart, own = form_chart(form, preset), storage(form, stored)
    note = form.note if chart is None else chart.note
    before, _, rest = note.partition("stored ")
    _, _, after = rest.partition(";")
    return note if own.own else f"{before}stored {own.text} (layout {stored.name});{after}"
