"""Gauss-Newton terms at group level: H = J^T J and g = J^T r, without the Jacobians of the variables.

Going from the residual to the variables, the first vertices are eliminated as Jacobians are, by products; at
some frontier H and g are formed of what is alive there, and the rest is eliminated by congruence: where
dv = B du, H_uu = B^T H_vv B, H_ua = B^T H_va and g_u = B^T g_v. For a between factor the frontier may be the
relative pose c = x^-1 y: there H_cc is H_yy, and H_xx = A^T H_yy A with A = -Ad(c^-1).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import accumulate, combinations_with_replacement, count

from liegen.algebra.linear import (
    Matrix,
    Vector,
    add,
    eye,
    is_identity,
    matadd,
    matmul,
    matvec,
    transpose,
    zeros,
)

from .graph_jacobian import Linearised


@dataclass(frozen=True, eq=False)
class Terms:
    """g by variable, and the blocks of H by pairs of variables in their order."""

    g: Mapping[str, Vector]
    H: Mapping[tuple[str, str], Matrix]


@dataclass(frozen=True, eq=False)
class Ladder:
    """The blocks below one output with one matrix an edge: factors of a chain have vertices between them.

    ``order`` are the vertices to eliminate, from the output to the variables; ``into`` says from where each
    comes, and by which matrix. ``sinks`` are where the output ends, with their rows; ``sources`` where each
    variable begins, with its dimension.
    """

    order: tuple[int, ...]
    into: Mapping[int, Mapping[int, Matrix]]
    sinks: Mapping[int, int]
    sources: Mapping[str, tuple[int, int]]

    @property
    def frontiers(self) -> tuple[int, ...]:
        """How many vertices may be eliminated before the terms are formed; of equal choices the last one.

        One edge alone leads to a vertex, and it is the identity: then the vertex makes no difference.
        """
        ways = Counter(source for below in self.into.values() for source in below)

        def same(vertex: int) -> bool:
            below = self.into[vertex]
            return len(below) == 1 and all(ways[u] == 1 and is_identity(B) for u, B in below.items())

        return (*[k for k, vertex in enumerate(self.order) if not same(vertex)], len(self.order))

    def entries(self, frontier: int) -> int:
        """About how many entries of blocks are made, structure included, where the terms are formed there."""
        alive = dict(self.sinks)
        rows, made = sum(self.sinks.values()), 0
        for k, vertex in enumerate(self.order):
            if k == frontier:
                made += sum(alive.values()) ** 2
            own = alive.pop(vertex, 0)
            for source, B in self.into[vertex].items():
                width = len(B[0])
                made += width * (rows if k < frontier else own + width + sum(alive.values()))
                alive[source] = width
        return made + (sum(alive.values()) ** 2 if frontier == len(self.order) else 0)

    def worth_trying(self, budget: int) -> tuple[int, ...]:
        """The frontiers, in order; of a long ladder the last ones, as many as take ``budget`` entries.

        The very last one is the Jacobian of all variables.
        """
        *others, last = self.frontiers
        kept, left = [last], budget
        for frontier in reversed(others):
            left -= self.entries(frontier)
            if left < 0:
                break
            kept.append(frontier)
        return tuple(reversed(kept))

    @property
    def blocks(self) -> tuple[Matrix, ...]:
        """The matrices of ``into``, in order."""
        return tuple(B for below in self.into.values() for B in below.values())

    def holding(self, blocks: Iterable[Matrix]) -> Ladder:
        """The same ladder with other matrices."""
        left = iter(blocks)
        into = {v: {source: next(left) for source in below} for v, below in self.into.items()}
        return replace(self, into=into)


def ladder(local: Linearised) -> Ladder:
    """The blocks of a graph with one output."""
    ends = [(variable, edge, shape) for (_, variable), p in local.wanted.items() for edge, shape in p]
    sinks = {edge[1]: shape[0] for _, edge, shape in ends}
    fresh = count(min((v for edge in local.edges for v in edge), default=0) - 1, -1)
    order: list[int] = []
    into: dict[int, dict[int, Matrix]] = {}
    for vertex in (*sinks, *reversed(local.inner)):
        order.append(vertex)
        into[vertex] = {}
        for source, chain in [(a, c) for (a, b), c in local.edges.items() if b == vertex]:
            below = [next(fresh) for _ in chain[1:]]
            for upper, lower, B in zip((vertex, *below), (*below, source), chain, strict=True):
                into.setdefault(upper, {})[lower] = B
            order += below
    return Ladder(tuple(order), into, sinks, {name: (edge[0], shape[1]) for name, edge, shape in ends})


def normal_terms(steps: Ladder, residual: Vector, weigh: Callable[[Matrix], Matrix], frontier: int) -> Terms:
    """The terms; the first ``frontier`` vertices are eliminated as Jacobians, the others by congruence.

    ``residual`` is the weighed one, ``weigh`` makes its Jacobians of those of the residual as it was.
    """
    jacobian = _selections(steps.sinks)
    for vertex in steps.order[:frontier]:
        jacobian = _product(jacobian, vertex, steps.into[vertex])
    weighed = {v: weigh(J) for v, J in jacobian.items()}
    square = Square(
        {v: matvec(transpose(J), residual) for v, J in weighed.items()},
        {(v, w): _gram(weighed[v], weighed[w], v == w) for v, w in combinations_with_replacement(weighed, 2)},
    )
    for vertex in steps.order[frontier:]:
        square = _congruence(square, vertex, steps.into[vertex])
    at = [(name, v, n) for name, (v, n) in steps.sources.items()]
    return Terms(
        {name: square.g.get(v, (0,) * n) for name, v, n in at},
        {
            (a, b): square.block(v, w) or zeros(m, n)
            for (a, v, m), (b, w, n) in combinations_with_replacement(at, 2)
        },
    )


def _selections(sinks: Mapping[int, int]) -> dict[int, Matrix]:
    """The derivative of the whole output by each part of it."""
    columns = transpose(eye(sum(sinks.values())))
    starts = accumulate(sinks.values(), initial=0)
    return {v: transpose(columns[s : s + n]) for (v, n), s in zip(sinks.items(), starts, strict=False)}


def _product(J: Mapping[int, Matrix], vertex: int, into: Mapping[int, Matrix]) -> dict[int, Matrix]:
    """The Jacobian of a vertex goes on to those that it depends on."""
    rest = {v: block for v, block in J.items() if v != vertex}
    if vertex not in J:
        return rest
    for source, B in into.items():
        found = matmul(J[vertex], B)
        rest[source] = matadd(rest[source], found) if source in rest else found
    return rest


@dataclass(frozen=True, eq=False)
class Square:
    """g and H of the vertices that are alive; each pair of vertices has one block, in either order."""

    g: Mapping[int, Vector]
    H: Mapping[tuple[int, int], Matrix]

    def block(self, v: int, w: int) -> Matrix | None:
        """H_vw, or None where it is zero."""
        if (v, w) in self.H:
            return self.H[v, w]
        return transpose(self.H[w, v]) if (w, v) in self.H else None


def _congruence(square: Square, vertex: int, into: Mapping[int, Matrix]) -> Square:
    """Put B du for the perturbation of a vertex in d^T H d / 2 + g^T d."""
    g = {v: x for v, x in square.g.items() if v != vertex}
    H = {pair: block for pair, block in square.H.items() if vertex not in pair}
    own = square.block(vertex, vertex)
    if own is None:
        return Square(g, H)
    beside = {a: block for a in g if (block := square.block(a, vertex)) is not None}
    for k, (u, B) in enumerate(into.items()):
        moved = matvec(transpose(B), square.g[vertex])
        g[u] = add(g[u], moved) if u in g else moved
        half = matmul(own, B)
        for w, C in list(into.items())[: k + 1]:
            _increase(H, w, u, _gram(C, half, u == w))
        for a, block in beside.items():
            found = matmul(block, B)
            _increase(H, a, u, _mirrored(matadd(found, transpose(found))) if a == u else found)
    return Square(g, H)


def _increase(H: dict[tuple[int, int], Matrix], v: int, w: int, block: Matrix) -> None:
    if (w, v) in H and v != w:
        v, w, block = w, v, transpose(block)
    H[v, w] = matadd(H[v, w], block) if (v, w) in H else block


def _gram(A: Matrix, B: Matrix, symmetric: bool) -> Matrix:
    """A^T B; of a symmetric product the upper half, mirrored."""
    product = matmul(transpose(A), B)
    return _mirrored(product) if symmetric else product


def _mirrored(A: Matrix) -> Matrix:
    """The upper half on both sides."""
    return tuple(tuple(A[min(i, j)][max(i, j)] for j in range(len(A))) for i in range(len(A)))
