"""The middle of the path: a graph becomes a ``Kernel``, the derived and optimised factor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from liegen.algebra.linear import Matrix
from liegen.algebra.linear import Vector as Coordinates
from liegen.charts import GTSAM, form_chart
from liegen.differentiate import STRATEGIES, Expressions, expressions, jacobians
from liegen.differentiate.local import symbols
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.manifolds import Manifold, ManifoldForm, MatrixValue, Vector
from liegen.noise import Weight, Weighting
from liegen.program import Port, Program
from liegen.program.lower import lower
from liegen.program.passes import optimise
from liegen.trace import Graph, formula, jacobian_formulas


def derive(graph: Graph, weighting: Weighting | None = None, *, in_place: bool = False) -> Kernel:
    """Differentiate, whiten and weigh where ``weighting`` says so, lower and optimise.

    Every strategy of elimination is tried; the program with the fewest operations after all passes is kept,
    the first among equals. ``in_place`` as in :class:`Kernel`.
    """
    values = expressions(graph)
    value, _ = optimise(lowered(graph, values, {}, weighting))
    candidates = [
        (name, *optimise(lowered(graph, values, jacobians(graph, values, strategy), weighting)))
        for name, strategy in STRATEGIES.items()
    ]
    name, best, rows = min(candidates, key=lambda c: c[1].operations)
    first = f"lower, {name} order" if any(p.variable for p in graph.parameters) else "lower"
    passes = (PassCount(first, rows[0][1]), *(PassCount(*row) for row in rows[1:]))
    shown = unwhitened(graph) if weighting else graph
    return Kernel(
        name=graph.name,
        doc=graph.doc,
        site=graph.site,
        arguments=(
            *(_argument(p.name, p.manifold.form, variable=p.variable) for p in graph.parameters),
            *(_weight(w) for w in weights_of(graph, weighting)),
        ),
        outputs=tuple(_output(name, node.manifold.form) for name, node in graph.outputs),
        formula=formula(shown),
        jacobian_formulas=jacobian_formulas(shown),
        conventions=_conventions(graph),
        value=value,
        jacobians=best,
        passes=passes,
        frames=graph.frames.lines if graph.frames.typed else (),
        in_place=in_place,
        noise=noise_lines(graph, weighting),
    )


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
    ((name, _),) = unwhitened(graph).outputs
    variables = [p.name for p in graph.parameters if p.variable]
    return weighting.lines(name, variables, graph.frames.noise)


def lowered(
    graph: Graph,
    values: Expressions,
    blocks: Mapping[tuple[str, str], Matrix],
    weighting: Weighting | None = None,
) -> Program:
    """The outputs of a graph, and the given Jacobians, weighed, as a program without any pass."""
    given = weight_symbols(graph, weighting)
    scalars: dict[str, Coordinates] = {name: values.scalars[id(node)] for name, node in graph.outputs}
    if weighting:
        ((name, residual),) = scalars.items()
        scalars[name], blocks = weighting.apply(given, residual, blocks)
    outputs = [(Port(name, node.manifold.form.shape), scalars[name]) for name, node in graph.outputs]
    outputs += [
        (Port(f"{name}_D_{variable}", (len(m), len(m[0]))), tuple(x for row in m for x in row))
        for (name, variable), m in blocks.items()
    ]
    return lowered_outputs(graph, values, given, outputs)


def weight_symbols(graph: Graph, weighting: Weighting | None) -> dict[str, Coordinates]:
    """Fresh SX scalars of the keywords that a weighting adds."""
    return {w.name: symbols(f"{w.name}_", w.size) for w in weights_of(graph, weighting)}


def lowered_outputs(
    graph: Graph,
    values: Expressions,
    given: Mapping[str, Coordinates],
    outputs: Sequence[tuple[Port, Coordinates]],
) -> Program:
    """Expressions in a graph's scalars, and in the keywords ``given``, as a program without any pass."""
    arguments = {**values.inputs, **given}
    inputs = [(Port(name, (len(coords),)), coords) for name, coords in arguments.items()]
    domain = [(values.scalars[id(d.condition)][0], d.message) for d in graph.domain]
    return lower(graph.name, inputs, outputs, domain)


def _argument(name: str, form: ManifoldForm, *, variable: bool) -> Argument:
    return Argument(name, form.name, form.storage, form.dim, variable)


def _weight(weight: Weight) -> Argument:
    storage = tuple("_".join(map(str, place)) for place in np.ndindex(weight.shape))
    return Argument(weight.name, "numbers", storage, 0, False, weight.shape, weight.meaning)


def _output(name: str, form: ManifoldForm) -> Output:
    return Output(name, form.name, form.storage, form.dim, form.shape)


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
    used = [(m.form, GTSAM) for m in owners]
    used += [(p.manifold.form, p.chart) for p in graph.parameters]
    used += [(m.form, graph.chart) for m in results]
    used += [
        (node.operands[0].manifold.form, graph.chart)
        for node in graph.nodes()
        if graph.chart is not GTSAM and node.operation.name in ("local", "retract")
    ]
    parts = [(part, preset) for form, preset in used for part in _with_parts(form)]
    charts = [(form, form_chart(form, preset)) for form, preset in parts]
    return tuple(dict.fromkeys(form.note if chart is None else chart.note for form, chart in charts))
