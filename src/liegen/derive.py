"""The middle of the path: a graph becomes a ``Kernel``, the derived and optimised factor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from liegen.algebra.linear import Matrix
from liegen.differentiate import STRATEGIES, Expressions, expressions, jacobians
from liegen.kernel import Argument, Kernel, Output, PassCount
from liegen.manifolds import Manifold, ManifoldForm, MatrixValue, Vector
from liegen.program import Port, Program
from liegen.program.lower import lower
from liegen.program.passes import optimise
from liegen.trace import Graph, formula, jacobian_formulas


def derive(graph: Graph, *, in_place: bool = False) -> Kernel:
    """Differentiate, lower and optimise.

    Every strategy of elimination is tried; the program with the fewest operations after all passes is kept,
    the first among equals. ``in_place`` as in :class:`Kernel`.
    """
    values = expressions(graph)
    value, _ = optimise(lowered(graph, values, {}))
    candidates = [
        (name, *optimise(lowered(graph, values, jacobians(graph, values, strategy))))
        for name, strategy in STRATEGIES.items()
    ]
    name, best, rows = min(candidates, key=lambda c: c[1].operations)
    first = f"lower, {name} order" if any(p.variable for p in graph.parameters) else "lower"
    passes = (PassCount(first, rows[0][1]), *(PassCount(*row) for row in rows[1:]))
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
        in_place=in_place,
    )


def lowered(graph: Graph, values: Expressions, blocks: Mapping[tuple[str, str], Matrix]) -> Program:
    """The outputs of a graph, and the given Jacobians, as a program without any pass."""
    inputs = [(Port(name, (len(symbols),)), symbols) for name, symbols in values.inputs.items()]
    outputs = [
        (Port(name, node.manifold.form.shape), values.scalars[id(node)]) for name, node in graph.outputs
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
    return Output(name, form.name, form.storage, form.dim, form.shape)


def _conventions(graph: Graph) -> tuple[str, ...]:
    """A line for each manifold that occurs; vectors and matrices that are only results need none."""
    results = [
        node.manifold for _, node in graph.outputs if not issubclass(node.manifold, Vector | MatrixValue)
    ]
    parameters: list[Any] = [p for _, node in graph.outputs for p in node.operation.parameters]
    owners = [p for p in parameters if isinstance(p, type) and issubclass(p, Manifold)]
    forms = [m.form for m in (*owners, *(p.manifold for p in graph.parameters), *results)]
    return tuple({form.name: form.note for form in forms}.values())
