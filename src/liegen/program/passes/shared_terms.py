"""Sums and products of many operands share their parts, whatever the order in which they were written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from liegen.program.program import Program, Requirement
from liegen.program.rewrite import Builder

from .dead_code import dead
from .nary import Pairs, Term
from .orientation import Node
from .sign_sharing import signed, signs

#: Longest sum or product that is taken apart.
LONGEST = 24


def terms(program: Program) -> Program:
    """a b c and a b d share a b, a + b + c and a + b - d share a + b, a b + c + a d becomes a (b + d) + c.

    Sums and products change their order, so values change by rounding of the terms. What is exact stays
    together: a difference of inputs or constants, and what is scaled by a select. If nothing is gained the
    program is returned.
    """
    program = dead(program)
    work = Work(program)
    if not work.improve():
        return program
    found = work.emitted()
    if found.operations >= program.operations and _settled(found) < _settled(program):
        found = signs(found)  # only negations are in the way
    return found if found.operations < program.operations else program


def _settled(program: Program) -> int:
    """Operations without negations."""
    return program.operations - program.op_counts().get("neg", 0)


class Work:
    """The nodes of a program, those of ``groups`` as sums and products of many operands."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.nodes, _, self.place = signed(program)
        self.results = [self.place[i] for indices in program.results for i in indices]
        self.conditions = [self.place[r.condition][0] for r in program.requirements]
        self.uses = [0] * len(self.nodes)
        for node in self.nodes:
            for a in node.args:
                self.uses[a] += 1
        for n in (*[n for n, _ in self.results], *self.conditions):
            self.uses[n] += 1
        leaves = [not node.args for node in self.nodes]
        selects = [node.op == "select" for node in self.nodes]
        # what is exact stays whole, and what keeps others from overflow
        self.sums = self.flat("add", lambda a, b: leaves[a] and leaves[b])
        self.products = self.flat("mul", lambda a, b: selects[a] or selects[b])

    def flat(self, op: str, whole: Callable[[int, int], bool]) -> dict[int, list[Term]]:
        """Node -> its operands, inner sums (or products) with no other use taken apart."""
        found: dict[int, list[Term]] = {}
        uses = self.uses
        for n, node in enumerate(self.nodes):
            if node.op != op or whole(*node.args):
                continue
            own: list[Term] = []
            for a, s in zip(node.args, node.signs, strict=True):
                if a in found and uses[a] == 1 and len(own) + len(found[a]) < LONGEST:
                    inner = found.pop(a)
                    own += inner if s > 0 else [(b, -t) for b, t in inner]
                else:
                    own.append((a, s))
            found[n] = own
        return found

    def add(self, node: Node) -> int:
        """Append a node."""
        self.nodes.append(node)
        self.uses.append(0)
        return len(self.nodes) - 1

    def contractible(self, term: Term) -> bool:
        """Whether a term of a sum is a product with no other use."""
        return self.nodes[term[0]].op == "mul" and self.uses[term[0]] == 1

    def fused(self) -> int:
        """For how many pairs of a product and a sum one instruction can do, at most."""
        products = [(len(own), sum(map(self.contractible, own))) for own in self.sums.values()]
        return sum([n - (n == terms) for terms, n in products])

    def improve(self) -> bool:
        """Share pairs, then take out factors; return whether anything was found."""
        start = len(self.nodes)
        self.share(self.products, "mul")
        self.share(self.sums, "add")
        for n in list(self.sums):
            while self.distribute(n):
                pass
        return len(self.nodes) > start

    def share(self, groups: dict[int, list[Term]], op: str) -> None:
        """Make a node of each pair that several sums, or products, have."""
        pairs = Pairs(groups)
        while found := pairs.best():
            (a, b, relative), holders = found
            new = self.add(Node(op, 0.0, (a, b), (1, relative)))
            self.uses[new] = len(holders)
            pairs.replace((a, b, relative), holders, new)

    def distribute(self, n: int) -> bool:
        """Take the factor that most terms of a sum have out of them."""
        own = self.sums[n]
        if not self.common(own):
            return False
        holders: dict[int, list[int]] = {}
        for k, (m, _) in enumerate(own):
            if self.uses[m] == 1:
                for factor in dict.fromkeys([f for f, _ in self.products.get(m, ())]):
                    holders.setdefault(factor, []).append(k)
        factor, places = max(holders.items(), key=lambda item: len(item[1]))
        inner: list[Term] = []
        for k in places:
            m, s = own[k]
            rest = list(self.products.pop(m))
            rest.remove((factor, 1))
            if len(rest) == 1:
                inner.append((rest[0][0], s))
            else:
                self.products[m] = rest
                inner.append((m, s))
        total = self.add(Node("add", 0.0, (), ()))
        scaled = self.add(Node("mul", 0.0, (), ()))
        self.sums[total], self.products[scaled] = inner, [(factor, 1), (total, 1)]
        self.uses[total] = self.uses[scaled] = 1
        own[places[0]] = (scaled, 1)
        for k in reversed(places[1:]):
            del own[k]
        return True

    def common(self, own: list[Term]) -> bool:
        """Whether two terms of a sum, with no other use, have a factor in common."""
        seen: set[int] = set()
        for m, _ in own:
            if self.uses[m] == 1 and m in self.products:
                factors = {f for f, _ in self.products[m]}
                if not seen.isdisjoint(factors):
                    return True
                seen |= factors
        return False

    def operands(self, n: int) -> list[Term]:
        """What a node is made of now."""
        found = self.sums.get(n) or self.products.get(n)
        return found or list(zip(self.nodes[n].args, self.nodes[n].signs, strict=True))

    def emitted(self) -> Program:
        """The program of the changed nodes."""
        emission = _Emission(self)
        for root in (*self.conditions, *[n for n, _ in self.results]):
            emission.reach(root)
        flat = iter([emission.value(n, s) for n, s in self.results])
        results = [tuple([next(flat) for _ in own]) for own in self.program.results]
        return replace(
            self.program,
            code=tuple(emission.builder.code),
            results=tuple(results),
            requirements=tuple(
                Requirement(emission.index[c][0], r.message)
                for c, r in zip(self.conditions, self.program.requirements, strict=True)
            ),
        )


class _Emission:
    """Instructions of the nodes; ``index`` has for a node its instruction and in which sign that has it."""

    def __init__(self, work: Work) -> None:
        self.work = work
        self.builder = Builder()
        self.index: dict[int, Term] = {}

    def reach(self, root: int) -> None:
        """Emit a node after everything that it needs."""
        index = self.index
        stack = [root]
        while stack:
            n = stack[-1]
            if n in index:
                stack.pop()
                continue
            own = self.work.operands(n)
            missing = [m for m, _ in reversed(own) if m not in index]
            if missing:
                stack += missing
            else:
                stack.pop()
                index[n] = self.emit(n, own)

    def value(self, n: int, s: int) -> int:
        """The instruction that is s times the node."""
        i, t = self.index[n]
        node = self.work.nodes[n]
        if s == t:
            return i
        return self.builder.const(-node.value) if node.op == "const" else self.builder.share("neg", (i,))

    def emit(self, n: int, own: list[Term]) -> Term:
        """The node's own operations."""
        node = self.work.nodes[n]
        if not own:
            return self.builder.share(node.op, (), node.value), 1
        if node.op == "add":
            return _sum(self.builder, [(i, s * t) for s, (i, t) in [(s, self.index[m]) for m, s in own]])
        if n in self.work.products:
            i, sign = self.index[own[0][0]]
            for m, _ in own[1:]:
                j, t = self.index[m]
                i, sign = self.builder.share("mul", (i, j)), sign * t
            return i, sign
        return self.builder.share(node.op, tuple([self.value(m, s) for m, s in own])), 1


def _sum(builder: Builder, own: list[Term]) -> Term:
    """The sum from left to right, begun with the first term that is added; negative if there is none."""
    sign = 1 if any(s > 0 for _, s in own) else -1
    first = next(k for k, (_, s) in enumerate(own) if s == sign)
    total = own[first][0]
    for i, s in (*own[:first], *own[first + 1 :]):
        total = builder.share("add" if s == sign else "sub", (total, i))
    return total, sign
