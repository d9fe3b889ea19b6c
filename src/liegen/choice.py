"""Which order of elimination to take: each is carried out on scalars that only count."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from liegen.algebra import Scalar
from liegen.algebra.linear import Chain, Matrix, is_structural
from liegen.differentiate import STRATEGIES, Expressions, Linearised
from liegen.program import Port
from liegen.program.lower import lower
from liegen.program.passes.dead_code import dead
from liegen.program.passes.orientation import Kind
from liegen.program.passes.sign_sharing import Key, signed
from liegen.trace import Graph

#: An order is given up where its products are more than so many times those of the best one so far.
SLACK = 1.5


class TooManyError(Exception):
    """More operations than another order takes."""


@dataclass(frozen=True, slots=True)
class Counted:
    """A scalar that stands for ``sign`` times a node; equal operations are one node."""

    ledger: Ledger
    node: int
    sign: int

    def __mul__(self, other: Any) -> Counted:
        one, two = self, self.ledger.scalar(other)
        ids = (one.node, two.node) if one.node < two.node else (two.node, one.node)
        return Counted(self.ledger, self.ledger.share(("mul", 0.0, ids, (1, 1))), one.sign * two.sign)

    __rmul__ = __mul__

    def __add__(self, other: Any) -> Counted:
        one, two = self, self.ledger.scalar(other)
        if one.node > two.node:
            one, two = two, one
        key = ("add", 0.0, (one.node, two.node), (1, one.sign * two.sign))
        return Counted(self.ledger, self.ledger.share(key), one.sign)

    __radd__ = __add__

    def __neg__(self) -> Counted:
        return Counted(self.ledger, self.node, -self.sign)

    def __sub__(self, other: Any) -> Counted:
        return self + -self.ledger.scalar(other)

    def __rsub__(self, other: Any) -> Counted:
        return self.ledger.scalar(other) + -self


@dataclass
class Ledger:
    """All nodes so far: each by its operation, and its operands."""

    index: dict[Key, int]
    operands: list[tuple[int, ...]]
    leaves: list[bool]
    most: float
    roots: list[int] = field(default_factory=list[int])

    def share(self, key: Key) -> int:
        """The node of an operation, counted if it is new."""
        found = self.index.get(key)
        if found is None:
            if len(self.operands) > self.most:
                raise TooManyError
            found = self.index[key] = len(self.operands)
            self.operands.append(key[2])
            self.leaves.append(key[0] == "const")
        return found

    def scalar(self, x: Any) -> Counted:
        """A number as a node."""
        if isinstance(x, Counted):
            return x
        return Counted(self, self.share(("const", abs(float(x)), (), ())), -1 if x < 0 else 1)

    def copy(self, most: float) -> Ledger:
        """The same nodes, to go on from."""
        return Ledger(dict(self.index), list(self.operands), list(self.leaves), most, self.roots)

    def count(self, roots: Sequence[int]) -> int:
        """Operations that the given nodes, and the graph's own outputs, need."""
        needed = [False] * len(self.operands)
        for n in (*self.roots, *roots):
            needed[n] = True
        for n in range(len(needed) - 1, -1, -1):
            if needed[n]:
                for a in self.operands[n]:
                    needed[a] = True
        return sum([used and not leaf for used, leaf in zip(needed, self.leaves, strict=True)])


def ranked(graph: Graph, values: Expressions, local: Linearised) -> list[tuple[int, str]]:
    """The strategies with the operations that they take (up to negations), fewest first.

    Left out are those that give the same count as one before, and those that take far more.
    """
    base, edges = _begun(graph, values, local)
    counting = Linearised(edges, local.inner, local.wanted)
    found: dict[int, str] = {}
    best = float("inf")
    start = len(base.operands)
    for name, strategy in STRATEGIES.items():
        ledger = base.copy(start + SLACK * best)
        # scalars carry their ledger: those of the edges are made for this one
        own = {edge: tuple(_moved(m, ledger) for m in chain) for edge, chain in edges.items()}
        try:
            blocks = Linearised(own, counting.inner, counting.wanted).jacobians(strategy)
        except TooManyError:
            continue
        best = min(best, len(ledger.operands) - start)
        entries = [x for m in blocks.values() for row in m for x in row if isinstance(x, Counted)]
        found.setdefault(ledger.count([x.node for x in entries]), name)
    return sorted(found.items())


def _begun(
    graph: Graph, values: Expressions, local: Linearised
) -> tuple[Ledger, Mapping[tuple[int, int], Chain]]:
    """The outputs and all entries of local blocks as nodes; the blocks on these."""
    outputs = [x for _, node in graph.outputs for x in values.scalars[id(node)]]
    outputs += [values.scalars[id(d.condition)][0] for d in graph.domain]
    entries = [x for chain in local.edges.values() for m in chain for row in m for x in row]
    entries = [x for x in entries if not is_structural(x)]
    inputs = [(Port(name, (len(coords),)), coords) for name, coords in values.inputs.items()]
    wanted = [(Port("o", (len(outputs),)), outputs), (Port("e", (len(entries),)), entries)]
    program = dead(lower(graph.name, inputs, wanted))
    nodes, place = signed(program)
    index: dict[Key, int] = {(n.op, n.value, n.args, n.signs): k for k, n in enumerate(nodes)}
    ledger = Ledger(index, [n.args for n in nodes], [n.kind is Kind.LEAF for n in nodes], float("inf"))
    ledger.roots = [place[i][0] for i in program.results[0]]
    found = iter([Counted(ledger, *place[i]) for i in program.results[1]])

    def counted(m: Matrix) -> Matrix:
        return tuple(tuple([x if is_structural(x) else next(found) for x in row]) for row in m)

    return ledger, {edge: tuple([counted(m) for m in chain]) for edge, chain in local.edges.items()}


def _moved(m: Matrix, ledger: Ledger) -> Matrix:
    def entry(x: Scalar) -> Scalar:
        return x if is_structural(x) else Counted(ledger, x.node, x.sign)

    return tuple(tuple([entry(x) for x in row]) for row in m)
