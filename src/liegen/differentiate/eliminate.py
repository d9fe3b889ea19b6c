"""The product of local Jacobians along a graph, by elimination of its inner vertices.

Forward mode eliminates in the order of the graph, reverse mode against it; Markowitz' rule takes the vertex
with the cheapest products first. A chain of factors can be multiplied out in several ways as well. All are
correct, their numbers of operations differ.
Griewank, Walther, Evaluating Derivatives (2008), section 9.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from liegen.algebra.linear import (
    Chain,
    Matrix,
    Numbers,
    Once,
    Remembered,
    matadd,
    product,
    product_from_left,
    product_from_right,
)

#: (from, to) -> the derivative of ``to`` by ``from``, as a product of factors.
Edges = Mapping[tuple[int, int], Numbers]
Ends = dict[int, Numbers]
#: From the inner vertices, in the graph's order, that in which they are eliminated, decided as it goes.
Order = Callable[["Elimination", Sequence[int]], Iterable[int]]


@dataclass(frozen=True)
class Strategy:
    """In which order inner vertices are eliminated, and how chains are multiplied."""

    order: Order
    multiply: Callable[[Numbers, Once], Matrix]
    unshared: bool = False  # whether a chain that several products use is multiplied out in each of them


def forward(graph: Elimination, inner: Sequence[int]) -> Iterable[int]:
    """From the parameters to the outputs."""
    return inner


def reverse(graph: Elimination, inner: Sequence[int]) -> Iterable[int]:
    """From the outputs to the parameters."""
    return reversed(inner)


def markowitz(graph: Elimination, inner: Sequence[int]) -> Iterator[int]:
    """The vertex with the fewest scalar products first, the last of equal ones."""
    place = {v: -k for k, v in enumerate(inner)}
    heap = [(graph.cost(v), k, v) for v, k in place.items()]
    heapify(heap)
    while heap:
        cost, _, v = heappop(heap)
        if v not in place or cost != graph.cost(v):
            continue  # eliminated already, or here again with another cost
        del place[v]
        around = [*graph.into.get(v, ()), *graph.out.get(v, ())]
        yield v
        for n in around:
            if n in place:
                heappush(heap, (graph.cost(n), place[n], n))


def scalars_first(graph: Elimination, inner: Sequence[int]) -> Iterable[int]:
    """Functions of one number of one number are composed first, the rest goes from outputs to parameters."""

    def scalar(v: int) -> bool:
        around = (v, *graph.into.get(v, ()), *graph.out.get(v, ()))
        return all(graph.numbers(n) == 1 for n in around)

    first = {v: None for v in inner if scalar(v)}
    return *first, *(v for v in reversed(inner) if v not in first)


#: From the left a few rows meet one sparse factor after the other, and share what they have in common: SE(3)
#: between takes 427 operations this way, 472 from the right. Of strategies that come to the
#: same count the first one is taken.
STRATEGIES: Mapping[str, Strategy] = {
    "reverse": Strategy(reverse, product_from_left),
    "reverse, from the right": Strategy(reverse, product_from_right),
    "reverse, cheapest first": Strategy(reverse, product),
    "scalars first": Strategy(scalars_first, product_from_left),
    "forward": Strategy(forward, product),
    "forward, from the left": Strategy(forward, product_from_left),
    "Markowitz": Strategy(markowitz, product_from_left),
    "Markowitz, from the right": Strategy(markowitz, product_from_right),
    "forward, unshared": Strategy(forward, product_from_right, unshared=True),
}


class Elimination:
    """A graph from which vertices are taken one by one."""

    def __init__(self, edges: Edges, strategy: Strategy, once: Once) -> None:
        self.strategy = strategy
        self.once = once
        self.into: dict[int, Ends] = {}
        self.out: dict[int, Ends] = {}
        self.rows: dict[int, int] = {}  # of all edges out of a vertex
        self.columns: dict[int, int] = {}  # of all edges into a vertex
        for (a, b), chain in edges.items():
            self.add(a, b, chain)

    def add(self, a: int, b: int, chain: Numbers) -> None:
        """Add a path from a to b: parallel edges are summed."""
        ends = self.out.setdefault(a, {})
        if b in ends:
            chain = (self.once(matadd, self.multiplied(ends[b]), self.multiplied(chain)),)
        else:
            self.rows[a] = self.rows.get(a, 0) + len(chain[0])
            self.columns[b] = self.columns.get(b, 0) + len(chain[-1][0])
        self.into.setdefault(b, {})[a] = ends[b] = chain

    def numbers(self, v: int) -> int:
        """How many the vertex has; 0 for a parameter."""
        return max((len(chain[0]) for chain in self.into.get(v, {}).values()), default=0)

    def cost(self, v: int) -> int:
        """About how many scalar products the elimination of v takes, dense blocks taken for granted."""
        return self.rows.get(v, 0) * self.columns.get(v, 0)

    def remove(self, v: int) -> None:
        """Eliminate v: every way through it becomes an edge."""
        into, out = self.into.pop(v, {}), self.out.pop(v, {})
        for a, chain in into.items():
            del self.out[a][v]
            self.rows[a] -= len(chain[0])
        for b, chain in out.items():
            del self.into[b][v]
            self.columns[b] -= len(chain[-1][0])
        left, right = self.shared(out, len(into)), self.shared(into, len(out))
        for b, outer in left.items():
            for a, inner in right.items():
                self.add(a, b, (*outer, *inner))

    def shared(self, ends: Ends, users: int) -> Ends:
        """Multiply out what several products will use."""
        if users < 2 or self.strategy.unshared:
            return ends
        return {n: (self.multiplied(chain),) for n, chain in ends.items()}

    def multiplied(self, chain: Numbers) -> Matrix:
        """The product of a chain."""
        return chain[0] if len(chain) == 1 else self.strategy.multiply(chain, self.once)


def eliminate(
    edges: Edges, inner: Sequence[int], strategy: Strategy, once: Once | None = None
) -> dict[tuple[int, int], Matrix]:
    """Jacobians of the remaining vertices: {(from, to): matrix}.

    With the same ``once`` strategies share the products that they have in common.
    """
    graph = Elimination(edges, strategy, once or Remembered({}))
    for v in strategy.order(graph, inner):
        graph.remove(v)
    return {(a, b): graph.multiplied(chain) for a, ends in graph.out.items() for b, chain in ends.items()}


def accumulate(edges: dict[tuple[int, int], Chain], edge: tuple[int, int], chain: Chain) -> None:
    """Add a local block: those of an operation that has one operand twice are summed."""
    if edge in edges:
        chain = (matadd(product_from_left(edges[edge]), product_from_left(chain)),)
    edges[edge] = chain
