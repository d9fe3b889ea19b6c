"""The middle of the path: a graph becomes a ``Kernel``, the derived and optimised factor."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.algebra.linear import Matrix
from liegen.charts import GTSAM, form_chart
from liegen.differentiate import STRATEGIES, Expressions, expressions, jacobians
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.manifolds import ManifoldForm, Vector
from liegen.program import Port, Program
from liegen.program.lower import lower
from liegen.program.passes import optimise
from liegen.trace import Graph, formula, jacobian_formulas


def derive(graph: Graph) -> Kernel:
    """Differentiate, lower and optimise.

    Every strategy of elimination is tried; the program with the fewest operations after all passes is kept,
    the first among equals.
    """
    values = expressions(graph)
    value, _ = optimise(lowered(graph, values, {}))
    candidates = [
        (name, *optimise(lowered(graph, values, jacobians(graph, values, strategy))))
        for name, strategy in STRATEGIES.items()
    ]
    name, best, rows = min(candidates, key=lambda c: c[1].operations)
    passes = (PassCount(f"lower, {name} order", rows[0][1]), *(PassCount(*row) for row in rows[1:]))
    return Kernel(
        name=graph.name,
        doc=graph.doc,
        site=graph.site,
        arguments=tuple(_argument(p.name, p.manifold.form, variable=p.variable) for p in graph.parameters),
        outputs=tuple(_output(name, node.manifold.form) for name, node in graph.outputs),
        formula=formula(graph),
        jacobian_formulas=jacobian_formulas(graph),
        conventions=_conventions(graph),
        value=value,
        jacobians=best,
        passes=passes,
        frames=graph.frames.lines if graph.frames.typed else (),
    )


def lowered(graph: Graph, values: Expressions, blocks: Mapping[tuple[str, str], Matrix]) -> Program:
    """The outputs of a graph, and the given Jacobians, as a program without any pass."""
    inputs = [(Port(name, (len(symbols),)), symbols) for name, symbols in values.inputs.items()]
    outputs = [
        (Port(name, (node.manifold.form.size,)), values.scalars[id(node)]) for name, node in graph.outputs
    ]
    outputs += [
        (Port(f"{name}_D_{variable}", (len(m), len(m[0]))), tuple(x for row in m for x in row))
        for (name, variable), m in blocks.items()
    ]
    domain = [(values.scalars[id(d.condition)][0], d.message) for d in graph.domain]
    return lower(graph.name, inputs, outputs, domain)


def _argument(name: str, form: ManifoldForm, *, variable: bool) -> Argument:
    return Argument(name, form.name, form.storage, form.dim, variable)


def _output(name: str, form: ManifoldForm) -> Output:
    return Output(name, form.name, form.storage, form.dim)


def _conventions(graph: Graph) -> tuple[str, ...]:
    """A line for each manifold that occurs; vectors that are only results need none."""
    results = [node.manifold for _, node in graph.outputs if not issubclass(node.manifold, Vector)]
    used = [(p.manifold.form, p.chart) for p in graph.parameters]
    used += [(m.form, graph.chart) for m in results]
    used += [
        (node.operands[0].manifold.form, graph.chart)
        for node in graph.nodes()
        if graph.chart is not GTSAM and node.operation.name in ("local", "retract")
    ]
    charts = ((form, form_chart(form, preset)) for form, preset in used)
    return tuple(dict.fromkeys(form.note if chart is None else chart.note for form, chart in charts))
