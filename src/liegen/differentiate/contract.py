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
    into: dict[int, list[int]] = {}
    out: dict[int, list[int]] = {}
    for a, b in edges:
        into.setdefault(b, []).append(a)
        out.setdefault(a, []).append(b)
    kept: list[int] = []
    shorter = False
    for v in reversed(inner):
        ends, begins = out.get(v, []), into.get(v, [])
        if len(ends) != 1 or any((a, ends[0]) in found for a in begins):
            kept.append(v)
            continue
        (b,) = ends
        last = found.pop((v, b))
        into[b].remove(v)
        for a in begins:
            chain = (*last, *found.pop((a, v)))
            found[a, b] = cancelled(chain, elements)
            shorter = shorter or _shorter(found[a, b], chain)
            into[b].append(a)
            out[a].remove(v)
            out[a].append(b)
    return (found, tuple(reversed(kept))) if shorter else None


def _shorter(one: Chain, other: Chain) -> bool:
    """Whether a chain has fewer numbers than another one."""
    same = len(one) == len(other) and all(a is b for a, b in zip(one, other, strict=True))
    return not same and _entries(one) < _entries(other)


def _entries(chain: Chain) -> int:
    """How many numbers there are to multiply."""
    return sum([not is_structural(x) for m in plain(chain) for row in m for x in row])
