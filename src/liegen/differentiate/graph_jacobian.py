"""Differentiating a graph at group level: scalars and Jacobians of its outputs as CasADi SX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from liegen.algebra.casadi_backend import scalar
from liegen.algebra.linear import Chain, Matrix, Numbers, Once, eye, plain, stacked, transpose, zeros
from liegen.algebra.linear import Vector as Coordinates
from liegen.charts import Preset, form_chart
from liegen.manifolds import Leaf, Node
from liegen.trace import Graph, topological

from .contract import contracted
from .elements import elements
from .eliminate import Strategy, accumulate, eliminate
from .local import local_blocks, symbols
from .rounded import near_zero, size_of


@dataclass(frozen=True, eq=False)
class Expressions:
    """The graph on SX: symbols of what is stored of each parameter, and every node's scalars by identity."""

    inputs: Mapping[str, Coordinates]
    scalars: Mapping[int, Coordinates]


def expressions(graph: Graph, known: Expressions | None = None) -> Expressions:
    """Evaluate every node on fresh symbols of the parameters.

    Or on those of another graph of the same parameters, whose expressions are ``known``: the nodes that both
    graphs have keep their scalars.
    """
    inputs = known.inputs if known else _symbols(graph)
    scalars: dict[int, Coordinates] = (
        dict(known.scalars)
        if known
        else {
            id(p.node): p.storage.taken(inputs[p.name], normalise=graph.normalise) for p in graph.parameters
        }
    )
    for node in graph.nodes():
        if id(node) in scalars:
            continue
        operation = node.operation
        scalars[id(node)] = (
            tuple(scalar(float(c)) for c in operation.coords)
            if isinstance(operation, Leaf)
            else operation.value(*(scalars[id(n)] for n in node.operands))
        )
    return Expressions(inputs, scalars)


def _symbols(graph: Graph) -> dict[str, Coordinates]:
    return {p.name: symbols(f"{p.name}_", p.storage.size) for p in graph.parameters}


@dataclass(frozen=True, eq=False)
class Linearised:
    """The local blocks of a graph: its edges, the vertices to eliminate in order, and what is wanted.

    Chains are in numbers: no factor stands for a group element any more. ``wanted`` has for each
    (output, variable) the edges that are its Jacobian, one below the other, and their shapes.
    """

    edges: Mapping[tuple[int, int], Numbers]
    inner: tuple[int, ...]
    wanted: Mapping[tuple[str, str], tuple[tuple[tuple[int, int], tuple[int, int]], ...]]

    def jacobians(self, strategy: Strategy, once: Once | None = None) -> dict[tuple[str, str], Matrix]:
        """Jacobian of each output by each variable, {(output, variable): matrix}; see :func:`eliminate`."""
        products = eliminate(self.edges, self.inner, strategy, once)
        return {
            key: stacked(*[products.get(edge) or zeros(*shape) for edge, shape in parts])
            for key, parts in self.wanted.items()
        }


def jacobians(
    graph: Graph, values: Expressions, strategy: Strategy, *, through_storage: bool = False
) -> dict[tuple[str, str], Matrix]:
    """Jacobian of each output by each variable, {(output, variable): matrix}."""
    return linearised(graph, values, through_storage=through_storage)[0].jacobians(strategy)


def linearised(graph: Graph, values: Expressions, *, through_storage: bool = False) -> tuple[Linearised, ...]:
    """The local Jacobian blocks of all nodes between a variable and an output.

    Once as they are, and once without what cancels, if anything does.
    """
    variables = {id(p.node): p for p in graph.variables}
    active = _active(graph)
    edges: dict[tuple[int, int], Chain] = {}
    for node in graph.nodes():
        wanted = [id(n) in active for n in node.operands]
        if id(node) not in active or not any(wanted) or not node.manifold.form.dim:
            continue  # a condition has no derivative
        size = size_of(node, values.scalars) if node.operation.near_zero else None
        blocks = local_blocks(
            node.operation if size is None else near_zero(node.operation, size),
            values.scalars[id(node)],
            [values.scalars[id(n)] for n in node.operands],
            [n.manifold for n in node.operands],
            wanted,
            through_storage=through_storage,
        )
        for n, chain in zip(node.operands, blocks, strict=True):
            if chain is not None:
                accumulate(edges, (id(n), id(node)), chain)
    # an output may feed others too: it ends at a vertex of its own, a long one at several
    sinks: dict[str, list[tuple[int, int]]] = {name: [] for name, _ in graph.outputs}
    ends = 0
    for name, node in graph.outputs:
        for part in _parts(node):
            ends += 1
            sinks[name].append((-ends, sum(n.manifold.form.dim for n in part)))
            for n, chain in zip(part, _ends(part, graph.chart, values), strict=True):
                if id(n) in active:
                    accumulate(edges, (id(n), -ends), chain)
    # a variable in another chart begins at a vertex of its own, and its column map is one more factor
    sources = {v: v for v in variables}
    for k, (v, p) in enumerate(variables.items()):
        chart = form_chart(p.manifold.form, p.chart)
        if chart is not None and v in active:
            sources[v] = -k - 1 - ends
            edges[sources[v], v] = chart.columns(values.scalars[v])
    begun = {v for v, source in sources.items() if v == source}
    inner = tuple(id(n) for n in graph.nodes() if id(n) in active and id(n) not in begun)
    wanted = {
        (name, p.name): tuple(((sources[v], sink), (rows, p.manifold.form.dim)) for sink, rows in sinks[name])
        for name, _ in graph.outputs
        for v, p in variables.items()
    }
    shorter = contracted(edges, inner, elements(graph.nodes(), values.scalars))
    forms = [(edges, inner), *([shorter] if shorter else [])]
    return tuple(
        Linearised({edge: plain(chain) for edge, chain in found.items()}, left, wanted)
        for found, left in forms
    )


#: A stack with more rows than that is differentiated in parts, so that the work grows with its length.
MOST_ROWS = 12


def _parts(node: Node) -> list[list[Node]]:
    """The output itself, or the pieces of a long stack in groups."""
    if node.operation.name != "stack" or node.manifold.form.dim <= MOST_ROWS:
        return [[node]]
    groups: list[list[Node]] = []
    rows = MOST_ROWS
    for n in node.operands:
        if rows + n.manifold.form.dim > MOST_ROWS:
            groups.append([])
            rows = 0
        groups[-1].append(n)
        rows += n.manifold.form.dim
    return groups


def _ends(part: Sequence[Node], preset: Preset, values: Expressions) -> list[Chain]:
    """What leads from each piece of a part to the rows of the part."""
    if len(part) == 1:
        return [_rows(part[0], preset, values)]
    sizes = [n.manifold.form.dim for n in part]
    columns, starts = transpose(eye(sum(sizes))), [sum(sizes[:k]) for k in range(len(sizes))]
    return [(transpose(columns[s : s + n]),) for s, n in zip(starts, sizes, strict=True)]


def _rows(node: Node, preset: Preset, values: Expressions) -> Chain:
    """From right perturbations of an output to its chart's coordinates."""
    chart = form_chart(node.manifold.form, preset)
    return (eye(node.manifold.form.dim),) if chart is None else chart.rows(values.scalars[id(node)])


def _active(graph: Graph) -> set[int]:
    """The vertices on a way from a variable to an output."""
    below = {id(p.node) for p in graph.variables}
    for node in graph.nodes():
        if any(id(n) in below for n in node.operands):
            below.add(id(node))
    above = {id(n) for n in topological([node for _, node in graph.outputs])}
    return below & above
