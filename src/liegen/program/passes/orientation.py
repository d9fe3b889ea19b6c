"""Which values to compute, and which ones to compute negated, so that the fewest negations are left.

``d[n]`` says in which sign node n is at hand without a ``neg``: 1 as it is, -1 as its negative, 0 in either.
A difference is at hand in both, a sum in the sign of its operands, a product in the product of their signs,
constants in both. A node with several users must settle for one: its *choice*. Operations that need one
sign (square roots, outputs, arms that do not agree) *pay*: they demand the negative of an operand. The cost
is the number of nodes whose negative is demanded. The search flips one choice at a time, or makes one node
available in both signs, and updates only what depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from functools import partial
from heapq import heappop, heappush
from typing import Any, NamedTuple, cast

#: Sweeps over all choices; the search stops earlier when nothing is left to gain.
SWEEPS = 4


class Kind(IntEnum):
    """How the sign of a result depends on the signs of the operands."""

    LEAF = 0
    SUM = 1
    PRODUCT = 2
    ODD = 3
    EVEN = 4
    SIGNED = 5
    COMPARISON = 6
    SELECT = 7
    LOGIC = 8
    OUTPUT = 9


KINDS: Mapping[str, Kind] = {
    **dict.fromkeys(("input", "const"), Kind.LEAF),
    **dict.fromkeys(("add", "sub"), Kind.SUM),
    **dict.fromkeys(("mul", "div"), Kind.PRODUCT),
    **dict.fromkeys(("sin", "tan", "asin", "atan"), Kind.ODD),
    **dict.fromkeys(("cos", "abs"), Kind.EVEN),
    **dict.fromkeys(("sqrt", "exp", "log", "acos", "atan2"), Kind.SIGNED),
    **dict.fromkeys(("lt", "le"), Kind.COMPARISON),
    **dict.fromkeys(("and", "or", "not"), Kind.LOGIC),
    "select": Kind.SELECT,
    "out": Kind.OUTPUT,
}
_CONDITIONS = (Kind.COMPARISON, Kind.LOGIC)
#: They need their operands in one sign.
_DEMANDING = (Kind.SIGNED, Kind.OUTPUT)
#: Their sign does not depend on those of their operands.
_SETTLED = (Kind.LEAF, Kind.EVEN, Kind.SIGNED, Kind.COMPARISON, Kind.LOGIC, Kind.OUTPUT)


class Node(NamedTuple):
    """An operation on nodes, ``signs`` times ``args``; equal ones are one node."""

    op: str
    value: float
    args: tuple[int, ...]
    signs: tuple[int, ...]

    @property
    def kind(self) -> Kind:
        """How its sign depends on those of its operands."""
        return KINDS[self.op]


#: The fields of a node, which equal it.
Fields = tuple[str, float, tuple[int, ...], tuple[int, ...]]
#: A node of its fields, in two thirds of the time.
node_of: Callable[[Fields], Node] = partial(cast(Any, tuple).__new__, Node)


def orientations(
    nodes: Sequence[Node], given: Sequence[int], outputs: Sequence[tuple[int, int]]
) -> tuple[list[int], list[bool]]:
    """Return for each node the sign, 1 or -1, in which it is best computed, and whether both are worth it.

    ``given`` are the signs to begin with, ``outputs`` the (node, sign) pairs that must be at hand in the end.
    Deterministic.
    """
    search = _Search(nodes, given, outputs)
    search.improve()
    return search.assigned(), search.both[: len(nodes)]


#: What a move changed: a node, its d, its natural sign and what it paid before.
_Before = tuple[int, int, int, tuple[int, ...]]


class _Search:
    """``natural[n]``: d from the operands alone, 0 where that leaves it open. ``cost``: see above.

    ``matters[n]``: n pays, or a user does on whose sign that of n acts. ``near[n]`` counts the users that
    matter: a move of a node with none cannot lower the cost.
    """

    def __init__(
        self, nodes: Sequence[Node], given: Sequence[int], outputs: Sequence[tuple[int, int]]
    ) -> None:
        self.count = len(nodes)
        demands = sorted(set(outputs))
        self.nodes = [*nodes, *[Node("out", 0.0, (n,), (s,)) for n, s in demands]]
        self.kinds = [KINDS[node.op] for node in self.nodes]
        total = len(self.nodes)
        self.users: list[list[int]] = [[] for _ in range(total)]
        self.constant = [node.op == "const" for node in self.nodes]
        self.choice = [*given, *[1 for _ in demands]]
        for n, s in demands:
            self.choice[n] = s
        pinned: set[int] = set()
        for k, node in enumerate(self.nodes):
            for a in node.args:
                self.users[a].append(k)
            if node.op == "atan2":  # the sign of a zero matters on its cut
                pinned.add(node.args[0])
                self.choice[node.args[0]] = node.signs[0]
        kinds, users = self.kinds, self.users
        self.shared = [len(own) > 1 and not c for own, c in zip(users, self.constant, strict=True)]
        self.candidates = [k for k, s in enumerate(self.shared) if s and kinds[k] not in _CONDITIONS]
        self.fixed = [k in pinned or not node.args for k, node in enumerate(self.nodes)]
        self.both = [False] * total
        self.natural = [0] * total
        self.d = [0] * total
        self.pays: list[tuple[int, ...]] = [()] * total
        self.demand = [0] * total
        self.matters = [False] * total
        self.near = [0] * total
        self.cost = 0
        for k in range(total):
            self.visit(k)
        self.settle([k for k in range(total) if self.pays[k]])

    def sign_of(self, k: int) -> tuple[int, tuple[int, ...]]:
        """(sign in which a node is at hand, operands whose negative it demands); of no sum, of no product."""
        d, kind = self.d, self.kinds[k]
        op, _, args, signs = self.nodes[k]
        if kind in _DEMANDING:
            return 1, tuple([a for a, s in zip(args, signs, strict=True) if d[a] == -s])
        if kind == Kind.PRODUCT:  # a quotient: a second sign of the denominator would be a second reciprocal
            a, b = args
            return d[a] * ((self.natural[b] or self.choice[b]) if self.both[b] else d[b]), ()
        if kind == Kind.LEAF:
            return (0 if op == "const" else 1), ()
        if kind == Kind.ODD:
            return d[args[0]], ()
        if kind == Kind.SELECT:
            s, t = d[args[1]], d[args[2]] * signs[2]
            return (0, (args[2],)) if s * t < 0 else (s or t, ())
        if kind == Kind.COMPARISON:
            s, t = d[args[0]] * signs[0], d[args[1]] * signs[1]
            return 1, ((args[1],) if s * t < 0 else ())
        return 1, ()

    def visit(self, k: int) -> bool:
        """Bring node k up to date; return whether its users must follow."""
        d, node = self.d, self.nodes[k]
        if node.op == "mul":
            a, b = node.args
            sign, pays = d[a] * d[b], ()
        elif node.op == "add":
            a, b = node.args
            sign, pays = d[a] if d[a] == d[b] * node.signs[1] else 0, ()
        else:
            sign, pays = self.sign_of(k)
            if pays != self.pays[k]:
                self.pay(k, pays)
        self.natural[k] = sign
        if self.shared[k]:
            sign = 0 if self.both[k] else sign or self.choice[k]
        changed = sign != d[k]
        d[k] = sign
        return changed

    def pay(self, k: int, pays: tuple[int, ...]) -> None:
        """Let node k demand the negatives of these operands, and of no others."""
        demand = self.demand
        for a in self.pays[k]:
            demand[a] -= 1
            self.cost -= demand[a] == 0
        for a in pays:
            self.cost += demand[a] == 0
            demand[a] += 1
        self.pays[k] = pays

    def follow(self, k: int) -> list[_Before]:
        """Bring node k and what depends on it up to date; return what was there before."""
        d, natural, pays, users, visit = self.d, self.natural, self.pays, self.users, self.visit
        before: list[_Before] = []
        heap, last = [k], -1
        while heap:
            n = heappop(heap)
            if n != last:
                last = n
                before.append((n, d[n], natural[n], pays[n]))
                if visit(n):
                    for user in users[n]:
                        heappush(heap, user)
        return before

    def restore(self, before: list[_Before]) -> None:
        """Undo what :meth:`follow` did."""
        for n, d, natural, pays in before:
            self.d[n] = d
            self.natural[n] = natural
            if pays != self.pays[n]:
                self.pay(n, pays)

    def settle(self, stack: list[int]) -> None:
        """Bring ``matters`` and ``near`` up to date with what these nodes pay."""
        while stack:
            k = stack.pop()
            matters = bool(self.pays[k]) or (self.near[k] > 0 and self.kinds[k] not in _SETTLED)
            if matters != self.matters[k]:
                self.matters[k] = matters
                for a in self.nodes[k].args:
                    self.near[a] += 1 if matters else -1
                    if self.near[a] == matters:  # the first one, or the last one gone
                        stack.append(a)

    def flip(self, k: int) -> None:
        """Settle for the other sign."""
        self.choice[k] = -self.choice[k]

    def toggle(self, k: int) -> None:
        """Have the node at hand in both signs, or no longer."""
        self.both[k] = not self.both[k]
        self.cost += 1 if self.both[k] else -1

    def sweep(self, move: Callable[[int], None], candidates: Sequence[int]) -> bool:
        """Keep each move that lowers the cost, undo the others; return whether one was kept."""
        start = self.cost
        for k in candidates:
            if self.cost == 0:
                break
            if not self.near[k]:
                continue
            cost = self.cost
            move(k)
            before = self.follow(k)
            if self.cost < cost:
                self.settle([n for n, *_ in before])
            else:
                move(k)
                self.restore(before)
        return self.cost < start

    def improve(self) -> None:
        """Flip from the outputs to the inputs (the other way round ended higher), then try both signs."""
        for _ in range(SWEEPS):
            free = [k for k in reversed(self.candidates) if not self.fixed[k] and not self.natural[k]]
            if not self.sweep(self.flip, free) and not self.sweep(self.toggle, self.candidates):
                return

    def assigned(self) -> list[int]:
        """The sign of every node, free ones set by the one user that they have."""
        final = [d or choice for d, choice in zip(self.d, self.choice, strict=True)]
        for k, both in enumerate(self.both):
            if both:
                final[k] = self.natural[k] or self.choice[k]
        open_ = [d == 0 and len(users) == 1 for d, users in zip(self.d, self.users, strict=True)]
        for k, constant in enumerate(self.constant):
            if constant:
                open_[k] = False
        for k in sorted({self.users[a][0] for a, free in enumerate(open_) if free}, reverse=True):
            node = self.nodes[k]
            free = [open_[a] for a in node.args]
            fixed = [not self.constant[a] and not open_[a] for a in node.args]
            _assign(node, final, free, fixed, final[k])
        return final[: self.count]


def _assign(node: Node, final: list[int], free: list[bool], fixed: list[bool], want: int) -> None:
    """Set the signs of the free operands so that ``node`` costs nothing in the sign ``want``."""
    args, signs = node.args, node.signs
    held = [final[a] * s for a, s, stuck in zip(args, signs, fixed, strict=True) if stuck]
    if node.kind is Kind.PRODUCT:
        # one free operand takes what is missing, a second one stays as it is
        first = args[free.index(True)]
        for a, open_ in zip(args, free, strict=True):
            if open_:
                final[a] = 1
        final[first] = want * held[0] if held else want
        return
    if node.kind is Kind.COMPARISON:
        want = held[0] if held else 1
    elif node.kind in _DEMANDING:
        want = 1
    elif node.kind not in (Kind.SUM, Kind.SELECT, Kind.ODD):
        return
    for a, s, open_ in zip(args, signs, free, strict=True):
        if open_:
            final[a] = want * s
