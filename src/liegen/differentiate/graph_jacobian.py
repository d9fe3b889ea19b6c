"""Differentiating a graph at group level: scalars and Jacobians of its outputs as CasADi SX."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from liegen.algebra.casadi_backend import ca
from liegen.algebra.linear import Chain, Matrix, eye, product, zeros
from liegen.algebra.linear import Vector as Coordinates
from liegen.charts import Preset, form_chart
from liegen.manifolds import Leaf, Node
from liegen.trace import Graph, topological

from .eliminate import Edges, Strategy, accumulate, eliminate
from .local import local_blocks, symbols


@dataclass(frozen=True, eq=False)
class Expressions:
    """The graph on SX: symbols of each parameter, and the scalars of every node by its identity."""

    inputs: Mapping[str, Coordinates]
    scalars: Mapping[int, Coordinates]


def expressions(graph: Graph) -> Expressions:
    """Evaluate every node on fresh symbols of the parameters."""
    inputs = {p.name: symbols(f"{p.name}_", p.manifold.form.size) for p in graph.parameters}
    scalars: dict[int, Coordinates] = {id(p.node): inputs[p.name] for p in graph.parameters}
    for node in graph.nodes():
        if id(node) in scalars:
            continue
        operation = node.operation
        scalars[id(node)] = (
            tuple(ca.SX(float(c)) for c in operation.coords)
            if isinstance(operation, Leaf)
            else operation.value(*(scalars[id(n)] for n in node.operands))
        )
    return Expressions(inputs, scalars)


@dataclass(frozen=True, eq=False)
class Network:
    """The linear maps of a graph between its vertices.

    ``inner`` are the vertices between, in the graph's order; ``sources`` is where each variable begins, as a
    perturbation in its chart, ``sinks`` where each output ends.
    """

    edges: Edges
    inner: tuple[int, ...]
    sources: Mapping[str, int]
    sinks: Mapping[str, int]


def network(graph: Graph, values: Expressions, *, through_storage: bool = False) -> Network:
    """The local blocks of every node on a way from a variable to an output, and the charts at both ends."""
    variables = {id(p.node): p for p in graph.parameters if p.variable}
    active = _active(graph)
    edges: dict[tuple[int, int], Chain] = {}
    for node in graph.nodes():
        wanted = [id(n) in active for n in node.operands]
        if id(node) not in active or not any(wanted):
            continue
        blocks = local_blocks(
            node.operation,
            values.scalars[id(node)],
            [values.scalars[id(n)] for n in node.operands],
            [n.manifold for n in node.operands],
            wanted,
            through_storage=through_storage,
        )
        for n, chain in zip(node.operands, blocks, strict=True):
            if chain is not None:
                accumulate(edges, (id(n), id(node)), chain, product)
    # an output may feed others too: it ends at a vertex of its own
    sinks = {name: -k - 1 for k, (name, _) in enumerate(graph.outputs)}
    for name, node in graph.outputs:
        if id(node) in active:
            edges[id(node), sinks[name]] = _rows(node, graph.chart, values)
    # a variable in another chart begins at a vertex of its own, and its column map is one more factor
    sources = {v: v for v in variables}
    for k, (v, p) in enumerate(variables.items()):
        chart = form_chart(p.manifold.form, p.chart)
        if chart is not None and v in active:
            sources[v] = -k - 1 - len(sinks)
            edges[sources[v], v] = chart.columns(values.scalars[v])
    begun = {v for v, source in sources.items() if v == source}
    inner = tuple(id(n) for n in graph.nodes() if id(n) in active and id(n) not in begun)
    return Network(edges, inner, {p.name: sources[v] for v, p in variables.items()}, sinks)


def jacobians(
    graph: Graph, values: Expressions, strategy: Strategy, *, through_storage: bool = False
) -> dict[tuple[str, str], Matrix]:
    """Jacobian of each output by each variable, {(output, variable): matrix}."""
    net = network(graph, values, through_storage=through_storage)
    products = eliminate(net.edges, net.inner, strategy)
    return {
        (name, p.name): products.get((net.sources[p.name], net.sinks[name]))
        or zeros(node.manifold.form.dim, p.manifold.form.dim)
        for name, node in graph.outputs
        for p in graph.parameters
        if p.variable
    }


def _rows(node: Node, preset: Preset, values: Expressions) -> Chain:
    """From right perturbations of an output to its chart's coordinates."""
    chart = form_chart(node.manifold.form, preset)
    return (eye(node.manifold.form.dim),) if chart is None else chart.rows(values.scalars[id(node)])


def _active(graph: Graph) -> set[int]:
    """The vertices on a way from a variable to an output."""
    below = {id(p.node) for p in graph.parameters if p.variable}
    for node in graph.nodes():
        if any(id(n) in below for n in node.operands):
            below.add(id(node))
    above = {id(n) for n in topological([node for _, node in graph.outputs])}
    return below & above
