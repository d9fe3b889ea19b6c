"""Sign sharing: every value is known up to its sign, and negations move to where they cost nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from liegen.program.program import Program, Requirement
from liegen.program.rewrite import Builder

from .dead_code import dead
from .orientation import KINDS, Kind, Node, node_of, orientations


def signs(program: Program) -> Program:
    """Share values that differ by their sign, and leave as few negations as possible.

    a - b and b - a become one node, so do -(a b) and (-a) b, sin(-a) and -sin(a), -a < -b and b < a. Then
    every node gets an orientation (it or its negative is computed): a difference and a product with a
    constant can take either, sums and products take what their operands give. A local search picks those
    that need the fewest ``neg``; see :mod:`.orientation`. Rounding is symmetric, so values are equal bit for
    bit, but for the sign of zeros. The count never grows: if nothing is gained, the program is returned.
    """
    program = dead(program)
    nodes, given, place = signed(program)
    demanded = [place[i] for indices in program.results for i in indices]
    conditions = [place[r.condition][0] for r in program.requirements]
    oriented = _Emission(nodes, *orientations(nodes, given, demanded))
    results = iter([oriented.get(n, s) for n, s in demanded])
    found = Program(
        program.name,
        program.inputs,
        program.outputs,
        tuple(oriented.builder.code),
        tuple(tuple([next(results) for _ in indices]) for indices in program.results),
        tuple(
            Requirement(oriented.index[c], r.message)
            for c, r in zip(conditions, program.requirements, strict=True)
        ),
    )
    found = dead(found)
    return found if found.operations <= program.operations else program


def signed(program: Program) -> tuple[list[Node], list[int], list[tuple[int, int]]]:
    """The nodes of a program, the sign in which it has each, and each instruction as (node, sign)."""
    nodes: list[Node] = []
    given: list[int] = []
    index: dict[Node, int] = {}
    place: list[tuple[int, int]] = []
    zero = -1
    for op, args, value in program.code:
        if op == "neg":
            n, sign = place[args[0]]
            place.append((n, -sign))
            continue
        if args:
            name, ids, signs_, sign = _CANONICAL[op](op, [place[a] for a in args], zero)
            node = node_of((name, 0.0, ids, signs_))
        else:
            sign = -1 if value < 0 else 1
            node = Node(op, abs(value), (), ())
        found = index.setdefault(node, len(nodes))
        if found == len(nodes):
            nodes.append(node)
            given.append(sign if args else 1)
            if op == "const" and value == 0.0:
                zero = found
        place.append((found, sign))
    return nodes, given, place


_SAME, _OPPOSITE = (1, 1), (1, -1)
#: Operands as (node, sign).
_Known = list[tuple[int, int]]
_Canonical = tuple[str, tuple[int, ...], tuple[int, ...], int]


def _sum(op: str, known: _Known, zero: int) -> _Canonical:
    (a, s), (b, t) = known
    if op == "sub":
        t = -t
    if a > b:
        a, b, s, t = b, a, t, s
    return "add", (a, b), _SAME if s == t else _OPPOSITE, s


def _product(op: str, known: _Known, zero: int) -> _Canonical:
    (a, s), (b, t) = known
    return op, (b, a) if a > b and op == "mul" else (a, b), _SAME, s * t


def _odd(op: str, known: _Known, zero: int) -> _Canonical:
    ((a, s),) = known
    return op, (a,), (1,), s


def _even(op: str, known: _Known, zero: int) -> _Canonical:
    ((a, _),) = known
    return op, (a,), (1,), 1


def _as_is(op: str, known: _Known, zero: int) -> _Canonical:
    return op, tuple([a for a, _ in known]), tuple([s for _, s in known]), 1


def _comparison(op: str, known: _Known, zero: int) -> _Canonical:
    """-a < -b is b < a; of -a < b and -b < a the one that names the older node first."""
    (a, s), (b, t) = known
    s, t = (t if a == zero else s), (s if b == zero else t)
    if (s, t) == (-1, -1) or (s != t and a > b):
        a, b, s, t = b, a, -t, -s
    return op, (a, b), (s, t), 1


def _select(op: str, known: _Known, zero: int) -> _Canonical:
    (c, _), (a, s), (b, t) = known
    s, t = (t if a == zero else s), (s if b == zero else t)
    return op, (c, a, b), (1, 1, s * t), s


def _logic(op: str, known: _Known, zero: int) -> _Canonical:
    return op, tuple(sorted([a for a, _ in known])), tuple([s for _, s in known]), 1


_BY_KIND: Mapping[Kind, Callable[[str, _Known, int], _Canonical]] = {
    Kind.SUM: _sum, Kind.PRODUCT: _product, Kind.ODD: _odd, Kind.EVEN: _even, Kind.SIGNED: _as_is,
    Kind.COMPARISON: _comparison, Kind.SELECT: _select, Kind.LOGIC: _logic,
}  # fmt: skip
_CANONICAL = {op: _BY_KIND[kind] for op, kind in KINDS.items() if kind in _BY_KIND}


class _Emission:
    """Nodes as instructions.

    ``sign[n]`` tells whether n or its negative is computed, ``index[n]`` where; ``both[n]`` whether n is at
    hand in both signs, or is meant to be. Constants are, and count as computed as they are.
    """

    def __init__(self, nodes: Sequence[Node], wanted: Sequence[int], twofold: Sequence[bool]) -> None:
        self.nodes = nodes
        self.both = [two or node.op == "const" for two, node in zip(twofold, nodes, strict=True)]
        self.builder = Builder()
        self.index: list[int] = []
        self.sign: list[int] = []
        self.negative: dict[int, int] = {}
        for node, want in zip(nodes, wanted, strict=True):
            index, sign = _EMIT[node.op](self, node, want)
            self.index.append(index)
            self.sign.append(sign)

    def get(self, n: int, s: int) -> int:
        """The instruction that is s times node n; a negation is added if there is none yet."""
        return self.index[n] if self.sign[n] == s else self.opposite(n)

    def opposite(self, n: int) -> int:
        """The instruction that is the negative of what is computed for node n."""
        if n not in self.negative:
            node = self.nodes[n]
            constant = node.op == "const"
            self.negative[n] = (
                self.builder.const(-node.value) if constant else self.builder.share("neg", (self.index[n],))
            )
            self.both[n] = True
        return self.negative[n]

    def leaf(self, node: Node, want: int) -> tuple[int, int]:
        return self.builder.share(node.op, (), node.value + 0.0), 1

    def plain(self, node: Node, want: int) -> tuple[int, int]:
        """Operands in the sign that they are asked for in."""
        args = tuple([self.get(a, s) for a, s in zip(node.args, node.signs, strict=True)])
        return self.builder.share(node.op, args), 1

    def logic(self, node: Node, want: int) -> tuple[int, int]:
        return self.builder.share(node.op, tuple([self.index[a] for a in node.args])), 1

    def odd(self, node: Node, want: int) -> tuple[int, int]:
        (a,) = node.args
        return self.builder.share(node.op, (self.index[a],)), self.sign[a]

    def even(self, node: Node, want: int) -> tuple[int, int]:
        (a,) = node.args
        return self.builder.share(node.op, (self.index[a],)), 1

    def sum(self, node: Node, want: int) -> tuple[int, int]:
        (a, b), (_, rel) = node.args, node.signs
        s, t = want * self.sign[a], want * rel * self.sign[b]
        if s < 0 and t < 0:
            if self.both[a]:
                s = 1
            elif self.both[b]:
                t = 1
            else:
                want, s, t = -want, 1, 1
        # s, t: which of the two is added, which one subtracted
        x = self.get(a, want * s)
        y = self.get(b, want * rel * t)
        if s > 0:
            return self.builder.share("add" if t > 0 else "sub", (x, y)), want
        return self.builder.share("sub", (y, x)), want

    def product(self, node: Node, want: int) -> tuple[int, int]:
        a, b = node.args
        s, t = self.sign[a], self.sign[b]
        x, y = self.index[a], self.index[b]
        if s * t != want:
            if self.both[a]:
                s, x = -s, self.opposite(a)
            elif self.both[b] and (node.op == "mul" or self.nodes[b].op == "const"):
                t, y = -t, self.opposite(b)
        return self.builder.share(node.op, (x, y)), s * t

    def comparison(self, node: Node, want: int) -> tuple[int, int]:
        (a, b), (s, t) = node.args, node.signs
        known = [k * self.sign[n] for n, k in ((a, s), (b, t)) if not self.both[n]]
        if known and known[0] < 0:  # -a < -b is b < a
            return self.builder.share(node.op, (self.get(b, -t), self.get(a, -s))), 1
        return self.builder.share(node.op, (self.get(a, s), self.get(b, t))), 1

    def select(self, node: Node, want: int) -> tuple[int, int]:
        c, a, b = node.args
        rel = node.signs[2]
        known = [k * self.sign[n] for n, k in ((a, 1), (b, rel)) if not self.both[n]]
        if known and want not in known:
            want = -want
        args = (self.index[c], self.get(a, want), self.get(b, want * rel))
        return self.builder.share("select", args), want


_EMIT_KIND: Mapping[Kind, Callable[[_Emission, Node, int], tuple[int, int]]] = {
    Kind.LEAF: _Emission.leaf, Kind.SUM: _Emission.sum, Kind.PRODUCT: _Emission.product,
    Kind.ODD: _Emission.odd, Kind.EVEN: _Emission.even, Kind.SIGNED: _Emission.plain,
    Kind.COMPARISON: _Emission.comparison, Kind.SELECT: _Emission.select, Kind.LOGIC: _Emission.logic,
}  # fmt: skip
_EMIT = {op: _EMIT_KIND[kind] for op, kind in KINDS.items() if kind in _EMIT_KIND}
