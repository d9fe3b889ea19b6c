"""Sign sharing: every value is known up to its sign, and negations move to where they cost nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from liegen.program.program import Program, Requirement
from liegen.program.rewrite import Builder

from .dead_code import dead
from .orientation import Kind, Node, orientations

_KINDS: Mapping[str, Kind] = {
    **dict.fromkeys(("input", "const"), Kind.LEAF),
    **dict.fromkeys(("add", "sub"), Kind.SUM),
    **dict.fromkeys(("mul", "div"), Kind.PRODUCT),
    **dict.fromkeys(("sin", "tan", "asin", "atan"), Kind.ODD),
    **dict.fromkeys(("cos", "abs"), Kind.EVEN),
    **dict.fromkeys(("sqrt", "exp", "log", "acos", "atan2"), Kind.SIGNED),
    **dict.fromkeys(("lt", "le"), Kind.COMPARISON),
    **dict.fromkeys(("and", "or", "not"), Kind.LOGIC),
    "select": Kind.SELECT,
}


def signs(program: Program) -> Program:
    """Share values that differ by their sign, and leave as few negations as possible.

    a - b and b - a become one node, so do -(a b) and (-a) b, sin(-a) and -sin(a), -a < -b and b < a. Then
    every node gets an orientation (it or its negative is computed): a difference and a product with a
    constant can take either, sums and products take what their operands give. A local search picks those
    that need the fewest ``neg``; see :mod:`.orientation`. Rounding is symmetric, so values are equal bit for
    bit, but for the sign of zeros. The count never grows: if nothing is gained, the program is returned.
    """
    program = dead(program)
    nodes, place = signed(program)
    demanded = [place[i] for indices in program.results for i in indices]
    conditions = [place[r.condition][0] for r in program.requirements]
    oriented = _Emission(nodes, *orientations(nodes, demanded))
    for k in range(len(nodes)):
        oriented.emit(k)
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


#: Operation, number, operands and their signs: what makes two nodes equal.
Key = tuple[str, float, tuple[int, ...], tuple[int, ...]]


def signed(program: Program) -> tuple[list[Node], list[tuple[int, int]]]:
    """The nodes of a program, equal ones shared, and each instruction as (node, sign)."""
    nodes: list[Node] = []
    index: dict[Key, int] = {}
    place: list[tuple[int, int]] = []
    zero = -1
    for ins in program.code:
        op, args = ins.op, [place[a] for a in ins.args]
        if op == "neg":
            place.append((args[0][0], -args[0][1]))
            continue
        kind = _KINDS[op]
        value, sign = abs(ins.value), -1 if ins.value < 0 else 1
        ids, signs_ = tuple([n for n, _ in args]), tuple([s for _, s in args])
        if kind is not Kind.LEAF:
            if op == "sub":
                op, signs_ = "add", (signs_[0], -signs_[1])
            op, ids, signs_, sign = _CANONICAL[kind](op, ids, signs_, zero)
        key = (op, value, ids, signs_)
        found = index.get(key)
        if found is None:
            found = index[key] = len(nodes)
            nodes.append(Node(kind, op, value, ids, signs_, 1 if kind is Kind.LEAF else sign))
            if op == "const" and value == 0.0:
                zero = found
        place.append((found, sign))
    return nodes, place


_Signs = tuple[int, ...]
_Canonical = tuple[str, tuple[int, ...], _Signs, int]


def _sum(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    (a, b), (s, t) = ids, signs_
    if a > b:
        a, b, s, t = b, a, t, s
    return op, (a, b), (1, s * t), s


def _product(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    if op == "mul" and ids[0] > ids[1]:
        ids = ids[::-1]
    return op, ids, (1, 1), signs_[0] * signs_[1]


def _odd(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    return op, ids, (1,), signs_[0]


def _even(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    return op, ids, (1,), 1


def _as_is(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    return op, ids, signs_, 1


def _comparison(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    """-a < -b is b < a; of -a < b and -b < a the one that names the older node first."""
    (a, b), (s, t) = ids, signs_
    s, t = (t if a == zero else s), (s if b == zero else t)
    if (s, t) == (-1, -1) or (s != t and a > b):
        a, b, s, t = b, a, -t, -s
    return op, (a, b), (s, t), 1


def _select(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    c, a, b = ids
    _, s, t = signs_
    s, t = (t if a == zero else s), (s if b == zero else t)
    return op, (c, a, b), (1, 1, s * t), s


def _logic(op: str, ids: tuple[int, ...], signs_: _Signs, zero: int) -> _Canonical:
    return op, (ids if op == "not" else tuple(sorted(ids))), signs_, 1


_CANONICAL: Mapping[Kind, Callable[[str, tuple[int, ...], _Signs, int], _Canonical]] = {
    Kind.SUM: _sum, Kind.PRODUCT: _product, Kind.ODD: _odd, Kind.EVEN: _even, Kind.SIGNED: _as_is,
    Kind.COMPARISON: _comparison, Kind.SELECT: _select, Kind.LOGIC: _logic,
}  # fmt: skip


@dataclass
class _Emission:
    """Nodes as instructions. ``sign[n]`` tells whether n or its negative is computed, ``index[n]`` where."""

    nodes: list[Node]
    wanted: list[int]
    twofold: list[bool]

    def __post_init__(self) -> None:
        self.builder = Builder()
        self.index: list[int] = []
        self.sign: list[int] = []
        self.negative: dict[int, int] = {}

    def constant(self, n: int) -> bool:
        return self.nodes[n].op == "const"

    def get(self, n: int, s: int) -> int:
        """The instruction that is s times node n; a negation is added if there is none yet."""
        if self.constant(n):
            return self.builder.const(s * self.nodes[n].value)
        if self.sign[n] == s:
            return self.index[n]
        if n not in self.negative:
            self.negative[n] = self.builder.share("neg", (self.index[n],))
        return self.negative[n]

    def emit(self, n: int) -> None:
        node = self.nodes[n]
        index, sign = _EMIT[node.kind](self, node, self.wanted[n])
        self.index.append(index)
        self.sign.append(sign)

    def now(self, n: int) -> int:
        """The sign in which n is at hand; constants are at hand in both."""
        return 1 if self.constant(n) else self.sign[n]

    def both(self, n: int) -> bool:
        """Whether n is at hand in both signs, or is meant to be."""
        return self.constant(n) or self.twofold[n] or n in self.negative

    def leaf(self, node: Node, want: int) -> tuple[int, int]:
        if node.op == "const":
            return self.builder.const(node.value), 1
        return self.builder.share(node.op, (), node.value), 1

    def plain(self, node: Node, want: int) -> tuple[int, int]:
        """Operands in the sign that they are asked for in."""
        args = tuple([self.get(a, s) for a, s in zip(node.args, node.signs, strict=True)])
        return self.builder.share(node.op, args), 1

    def logic(self, node: Node, want: int) -> tuple[int, int]:
        return self.builder.share(node.op, tuple([self.index[a] for a in node.args])), 1

    def odd(self, node: Node, want: int) -> tuple[int, int]:
        (a,) = node.args
        return self.builder.share(node.op, (self.get(a, self.now(a)),)), self.now(a)

    def even(self, node: Node, want: int) -> tuple[int, int]:
        (a,) = node.args
        return self.builder.share(node.op, (self.get(a, self.now(a)),)), 1

    def sum(self, node: Node, want: int) -> tuple[int, int]:
        (a, b), rel = node.args, node.signs[1]
        s, t = want * self.now(a), want * rel * self.now(b)
        if s < 0 and t < 0:
            if self.both(a):
                s = 1
            elif self.both(b):
                t = 1
            else:
                want, s, t = -want, 1, 1
        # s, t: which of the two is added, which one subtracted
        x = self.get(a, want if s > 0 else -want)
        y = self.get(b, want * rel if t > 0 else -want * rel)
        if s > 0:
            return self.builder.share("add" if t > 0 else "sub", (x, y)), want
        return self.builder.share("sub", (y, x)), want

    def product(self, node: Node, want: int) -> tuple[int, int]:
        a, b = node.args
        s, t = self.now(a), self.now(b)
        if s * t != want:
            if self.both(a):
                s = -s
            elif self.both(b) and (node.op == "mul" or self.constant(b)):
                t = -t
        return self.builder.share(node.op, (self.get(a, s), self.get(b, t))), s * t

    def comparison(self, node: Node, want: int) -> tuple[int, int]:
        (a, b), (s, t) = node.args, node.signs
        known = [k * self.now(n) for n, k in ((a, s), (b, t)) if not self.both(n)]
        if known and known[0] < 0:  # -a < -b is b < a
            return self.builder.share(node.op, (self.get(b, -t), self.get(a, -s))), 1
        return self.builder.share(node.op, (self.get(a, s), self.get(b, t))), 1

    def select(self, node: Node, want: int) -> tuple[int, int]:
        c, a, b = node.args
        rel = node.signs[2]
        known = [k * self.now(n) for n, k in ((a, 1), (b, rel)) if not self.both(n)]
        if known and want not in known:
            want = -want
        args = (self.index[c], self.get(a, want), self.get(b, want * rel))
        return self.builder.share("select", args), want


_EMIT: Mapping[Kind, Callable[[_Emission, Node, int], tuple[int, int]]] = {
    Kind.LEAF: _Emission.leaf, Kind.SUM: _Emission.sum, Kind.PRODUCT: _Emission.product,
    Kind.ODD: _Emission.odd, Kind.EVEN: _Emission.even, Kind.SIGNED: _Emission.plain,
    Kind.COMPARISON: _Emission.comparison, Kind.SELECT: _Emission.select, Kind.LOGIC: _Emission.logic,
}  # fmt: skip
