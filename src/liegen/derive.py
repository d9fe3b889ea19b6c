"""The middle of the path: a graph becomes a ``Kernel``, the derived and optimised factor."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from liegen.algebra.linear import Matrix
from liegen.differentiate import ORDERS, Expressions, expressions, jacobians
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.manifolds import ManifoldForm
from liegen.program import Port, Program
from liegen.program.lower import lower
from liegen.program.passes import optimise
from liegen.trace import Graph, formula


def derive(graph: Graph) -> Kernel:
    """Differentiate, lower and optimise.

    Every order of elimination is tried; the program with the fewest operations after all passes is kept, the
    first among equals.
    """
    values = expressions(graph)
    value, _ = optimise(lowered(graph, values, {}))
    candidates = [
        (order, *optimise(lowered(graph, values, jacobians(graph, values, rule))))
        for order, rule in ORDERS.items()
    ]
    order, best, rows = min(candidates, key=lambda c: c[1].operations)
    raw = lowered(graph, values, jacobians(graph, values, ORDERS[order])).operations
    passes = (PassCount(f"derived ({order})", raw), *(PassCount(*row) for row in rows))
    return Kernel(
        name=graph.name,
        doc=graph.doc,
        site=graph.site,
        arguments=tuple(_argument(p.name, p.manifold.form, variable=p.variable) for p in graph.parameters),
        outputs=tuple(_output(name, node.manifold.form) for name, node in graph.outputs),
        formula=formula(graph),
        jacobian_formulas=(),
        conventions=_conventions([p.manifold.form for p in graph.parameters]
                                 + [node.manifold.form for _, node in graph.outputs]),
        value=value,
        jacobians=best,
        passes=passes,
    )  # fmt: skip


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


def _conventions(forms: Iterable[ManifoldForm]) -> tuple[str, ...]:
    notes = {form.name: form.note for form in forms}
    return tuple(notes.values())
