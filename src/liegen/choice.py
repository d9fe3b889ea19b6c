"""Which order of elimination to take: each is carried out on scalars that only count."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import compress
from operator import not_
from typing import Any

from liegen.algebra import Scalar
from liegen.algebra.linear import Matrix, Once, Remembered, Vector, is_structural
from liegen.differentiate import STRATEGIES, Expressions, Linearised
from liegen.program import Program
from liegen.program.passes.orientation import Fields
from liegen.program.passes.sign_sharing import signed
from liegen.trace import Graph

#: An order is given up where its products are more than so many times what the best one so far takes.
SLACK = 1.5


class TooManyError(Exception):
    """More operations than another order takes."""


class Counted:
    """A scalar that stands for ``sign`` times a node; equal operations are one node."""

    __slots__ = ("ledger", "node", "sign")

    def __init__(self, ledger: Ledger, node: int, sign: int) -> None:
        self.ledger, self.node, self.sign = ledger, node, sign

    def __mul__(self, other: Any) -> Counted:
        ledger = self.ledger
        two = other if isinstance(other, Counted) else ledger.scalar(other)
        a, b = self.node, two.node
        node = ledger.share(("mul", 0.0, (a, b) if a < b else (b, a), (1, 1)))
        return Counted(ledger, node, self.sign * two.sign)

    __rmul__ = __mul__

    def __add__(self, other: Any) -> Counted:
        ledger = self.ledger
        one, two = self, other if isinstance(other, Counted) else ledger.scalar(other)
        if one.node > two.node:
            one, two = two, one
        node = ledger.share(("add", 0.0, (one.node, two.node), (1, one.sign * two.sign)))
        return Counted(ledger, node, one.sign)

    __radd__ = __add__

    def __neg__(self) -> Counted:
        return Counted(self.ledger, self.node, -self.sign)

    def __sub__(self, other: Any) -> Counted:
        return self + -self.ledger.scalar(other)

    def __rsub__(self, other: Any) -> Counted:
        return self.ledger.scalar(other) + -self


@dataclass
class Ledger:
    """All nodes so far: each by its operation, its operands, and whether it costs nothing.

    The first ``begun`` ones are there from the start; ``least`` of the others took whoever took the fewest,
    no more than ``most`` nodes are made.
    """

    index: dict[Fields, int]
    operands: list[tuple[int, ...]]
    leaves: list[bool]
    begun: int
    least: float = float("inf")
    most: float = float("inf")

    def share(self, node: Fields) -> int:
        """The place of a node, counted if it is new."""
        found = self.index.setdefault(node, len(self.operands))
        if found == len(self.operands):
            if found > self.most:
                raise TooManyError
            self.operands.append(node[2])
            self.leaves.append(not node[2])
        return found

    def scalar(self, x: Any) -> Counted:
        """A number as a node."""
        if isinstance(x, Counted):
            return x
        return Counted(self, self.share(("const", abs(float(x)), (), ())), -1 if x < 0 else 1)

    def needed(self, blocks: Iterable[Matrix]) -> bytes:
        """For each node up to the last one that the entries of these matrices need 1 or 0."""
        found = bytearray(len(self.operands))
        for x in [x for m in blocks for row in m for x in row]:
            if isinstance(x, Counted):
                found[x.node] = 1
        for n in range(len(found) - 1, -1, -1):
            if found[n]:
                for a in self.operands[n]:
                    found[a] = 1
        return bytes(found).rstrip(b"\0")

    def count(self, needed: bytes) -> int:
        """Operations among these nodes."""
        return sum(compress(map(not_, self.leaves), needed))

    def taken(self, make: Callable[[], Iterable[Matrix]]) -> bytes | None:
        """The nodes that the matrices need which ``make`` multiplies out.

        None where that takes far more products than the best did: it is given up.
        """
        self.most = len(self.operands) + SLACK * self.least
        try:
            nodes = self.needed(make())
        except TooManyError:
            return None
        products = nodes.count(1, self.begun)
        if products > SLACK * self.least:
            return None
        self.least = min(self.least, products)
        return nodes


def entries(blocks: Iterable[Matrix]) -> list[Scalar]:
    """The entries of matrices on SX that are no structure: what :func:`opened` needs beside a program."""
    return [x for m in blocks for row in m for x in row if not is_structural(x)]


def opened(program: Program, blocks: Iterable[Matrix]) -> tuple[Ledger, list[Matrix]]:
    """The ledger of a program that has the entries of ``blocks`` beside it; these on counted scalars."""
    nodes, _, place = signed(program)
    ledger = Ledger(
        {node: k for k, node in enumerate(nodes)},
        [node.args for node in nodes],
        [not node.args for node in nodes],
        len(nodes),
    )
    found = iter([Counted(ledger, *place[i]) for i in program.results[-1]])
    return ledger, [
        tuple([tuple([x if is_structural(x) else next(found) for x in row]) for row in m]) for m in blocks
    ]


@dataclass(frozen=True, eq=False)
class Way:
    """A graph on SX, and its local blocks: as they are or without what cancels, fused or not."""

    graph: Graph
    values: Expressions
    local: Linearised

    @property
    def outputs(self) -> Vector:
        """The scalars of the graph's outputs and requirements."""
        nodes = [node for _, node in self.graph.outputs]
        conditions = [self.values.scalars[id(d.condition)][0] for d in self.graph.domain]
        return (*[x for node in nodes for x in self.values.scalars[id(node)]], *conditions)

    @property
    def blocks(self) -> list[Matrix]:
        """The outputs, and all factors of the local blocks."""
        return [(self.outputs,), *[m for chain in self.local.edges.values() for m in chain]]


def ranked(ways: Sequence[Way], program: Program) -> list[tuple[int, Way, str]]:
    """For each way the strategies with the operations that they take (up to negations), fewest first.

    All ways are on the same symbols; ``program`` has the entries of their blocks beside it. Left out are
    strategies that give the same count as one before, and those that take far more.
    """
    ledger, counted = opened(program, [m for way in ways for m in way.blocks])
    left = iter(counted)
    ranking: list[tuple[int, Way, str]] = []
    once = Remembered({})
    for way in ways:
        outputs = next(left)
        local = replace(
            way.local,
            edges={edge: tuple([next(left) for _ in chain]) for edge, chain in way.local.edges.items()},
        )
        found: dict[int, str] = {}
        for strategy in STRATEGIES:
            nodes = ledger.taken(partial(_multiplied, local, outputs, strategy, once))
            if nodes is not None:
                found.setdefault(ledger.count(nodes), strategy)
        ranking += [(count, way, strategy) for count, strategy in sorted(found.items())]
    return ranking


def _multiplied(local: Linearised, outputs: Matrix, strategy: str, once: Once) -> list[Matrix]:
    return [outputs, *local.jacobians(STRATEGIES[strategy], once).values()]
