"""Sums and products of many operands, and the pairs of operands that several of them have in common.

Hosangadi, Fallah, Kastner, Optimizing polynomial expressions by algebraic factorization and common
subexpression elimination, IEEE Trans. CAD 25(10), 2006: again and again the pair that most have.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import combinations

#: An operand and its sign, 1 or -1.
Term = tuple[int, int]
#: Two operands, the smaller one first, and the sign of the second relative to the first.
Pair = tuple[int, int, int]


def pairs_of(terms: list[Term]) -> Iterator[Pair]:
    """All pairs of different operands."""
    for (a, s), (b, t) in combinations(terms, 2):
        if a != b:
            yield (a, b, s * t) if a < b else (b, a, s * t)


@dataclass
class Pairs:
    """Which groups (sums, or products) hold which pairs; those that one alone ever holds are left out."""

    groups: dict[int, list[Term]]
    holders: dict[Pair, dict[int, None]] = field(default_factory=dict[Pair, dict[int, None]])
    heap: list[tuple[int, Pair]] = field(default_factory=list[tuple[int, Pair]])

    def __post_init__(self) -> None:
        counts = Counter([pair for terms in self.groups.values() for pair in set(pairs_of(terms))])
        self.holders.update({pair: {} for pair, count in counts.items() if count > 1})
        for group in self.groups:
            self.enter(group)

    def enter(self, group: int, new: int = -1) -> None:
        """Take note of a group's pairs; those with the operand ``new`` were not there before."""
        for pair in pairs_of(self.groups[group]):
            found = self.holders.setdefault(pair, {}) if pair[1] == new else self.holders.get(pair)
            if found is not None and group not in found:
                found[group] = None
                if len(found) > 1:
                    heappush(self.heap, (-len(found), pair))

    def leave(self, group: int) -> None:
        """Forget a group's pairs."""
        for pair in pairs_of(self.groups[group]):
            if pair in self.holders:
                self.holders[pair].pop(group, None)

    def best(self) -> tuple[Pair, list[int]] | None:
        """The pair that most groups have, at least two, and these groups; the smallest one among equals."""
        while self.heap:
            count, pair = self.heap[0]
            now = len(self.holders[pair])
            if now == -count:
                return pair, list(self.holders[pair])
            heappop(self.heap)
            if now > 1:
                heappush(self.heap, (-now, pair))
        return None

    def replace(self, pair: Pair, groups: list[int], new: int) -> None:
        """Put the operand ``new`` in the place of the pair."""
        a, b, relative = pair
        for group in groups:
            self.leave(group)
            terms = self.groups[group]
            at = _position(terms, a, b, relative)
            if at is not None:
                i, j = at
                sign = terms[i][1]
                first, last = min(i, j), max(i, j)
                terms[first] = (new, sign)
                del terms[last]
            self.enter(group, new)


def _position(terms: list[Term], a: int, b: int, relative: int) -> tuple[int, int] | None:
    """Where a group has the pair."""
    for i, (n, s) in enumerate(terms):
        if n == a:
            for j, (m, t) in enumerate(terms):
                if m == b and s * t == relative:
                    return i, j
    return None
