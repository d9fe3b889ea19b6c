"""Ways through a graph without a branch become one edge, where something cancels in their chain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from liegen.algebra.linear import Chain, is_structural, plain

from .cancel import cancelled
from .elements import Elements

Edges = Mapping[tuple[int, int], Chain]


def contracted(
    edges: Edges, inner: Sequence[int], elements: Elements
) -> tuple[Edges, tuple[int, ...]] | None:
    """The edges without the inner vertices that one edge leaves; None where nothing cancels."""
    found = dict(edges)
    kept: list[int] = []
    shorter = False
    for v in reversed(inner):
        into = [edge for edge in found if edge[1] == v]
        out = [edge for edge in found if edge[0] == v]
        made = {(a, b): (*found[v, b], *found[a, v]) for a, _ in into for _, b in out}
        if len(out) != 1 or any(edge in found for edge in made):
            kept.append(v)
            continue
        for edge, chain in made.items():
            found[edge] = cancelled(chain, elements)
            shorter = shorter or _entries(found[edge]) < _entries(chain)
        for edge in (*into, *out):
            del found[edge]
    return (found, tuple(reversed(kept))) if shorter else None


def _entries(chain: Chain) -> int:
    """How many numbers there are to multiply."""
    return sum(not is_structural(x) for m in plain(chain) for row in m for x in row)
