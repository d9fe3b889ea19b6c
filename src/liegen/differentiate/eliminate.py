"""The product of local Jacobians along a graph, by elimination of its inner vertices.

Forward mode eliminates in the order of the graph, reverse mode against it; other orders are possible. Each is
correct, they differ in the number of operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from liegen.algebra.linear import Chain, Matrix, matadd, product

Edges = Mapping[tuple[int, int], Chain]
#: Picks the order in which inner vertices are eliminated.
Order = Callable[[Sequence[int], Edges], Sequence[int]]


def forward(inner: Sequence[int], _: Edges) -> Sequence[int]:
    """From the parameters to the outputs."""
    return list(inner)


def reverse(inner: Sequence[int], _: Edges) -> Sequence[int]:
    """From the outputs to the parameters."""
    return list(inner)[::-1]


ORDERS: Mapping[str, Order] = {"reverse": reverse, "forward": forward}


def eliminate(edges: Edges, inner: Sequence[int], order: Order) -> dict[tuple[int, int], Matrix]:
    """Jacobians of the remaining vertices: {(from, to): matrix}."""
    graph: dict[tuple[int, int], Chain] = dict(edges)
    for v in order(inner, edges):
        into = [(a, b) for a, b in graph if b == v]
        out = [(a, b) for a, b in graph if a == v]
        left = {e: _shared(graph.pop(e), into) for e in out}
        right = {e: _shared(graph.pop(e), out) for e in into}
        for (_, to), outer in left.items():
            for (source, _), inner_chain in right.items():
                accumulate(graph, (source, to), (*outer, *inner_chain))
    return {edge: product(chain) for edge, chain in graph.items()}


def _shared(chain: Chain, users: Iterable[object]) -> Chain:
    """Multiply out what several products will use."""
    return (product(chain),) if len(list(users)) > 1 else chain


def accumulate(graph: dict[tuple[int, int], Chain], edge: tuple[int, int], chain: Chain) -> None:
    """Add a path: parallel edges are summed."""
    if edge in graph:
        chain = (matadd(product(graph[edge]), product(chain)),)
    graph[edge] = chain
