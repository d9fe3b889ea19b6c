"""Terms of printed Jacobians: numbers are multiplied out, like terms are added, zeros are left out."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

from liegen.manifolds import Leaf, Node

from .graph import Graph
from .notation import Block, Part

#: Heads whose blocks depend on more of an operation than they show, such as the entries of its matrix.
_OF_OPERATION = frozenset(("M", "derivative", "Jr of", "Jr^-1 of", "Jl^-1 of", "Ad of"))
#: Heads that are numbers where their values are.
_OF_NUMBERS = frozenset(("product", "quotient", "sum", "square", "sin", "cos", "exp", "sqrt", "sign"))
_NUMBERS: Mapping[str, Fraction] = {"0": Fraction(0), "1": Fraction(1), "2": Fraction(2)}


@dataclass(frozen=True)
class Factor:
    """A block of a product; factors with one ``key`` are equal. A ``number`` may stand anywhere in it."""

    block: Block
    key: Hashable
    number: bool = False


@dataclass(frozen=True)
class Term:
    """A multiple of a product of factors; none stand for the identity."""

    multiple: Fraction
    factors: tuple[Factor, ...] = ()

    @property
    def key(self) -> Hashable:
        """Equal for terms that differ in their multiples, or in the order of numbers."""
        numbers = sorted(repr(f.key) for f in self.factors if f.number)
        return tuple(numbers), tuple([f.key for f in self.factors if not f.number])

    def block(self, *, identity: bool) -> Block:
        """The term as one tree; ``identity``: a number alone stands before the identity."""
        size, factors = abs(self.multiple), [f.block for f in self.factors]
        place = next((k for k, b in enumerate(factors) if b.head == "quotient" and b.parts[0] == _ONE), None)
        if place is not None and size != 1 and 1 in (size.numerator, size.denominator):
            _, below = factors[place].parts
            divisor = Block("product", (_number(Fraction(size.denominator)), below))
            above = _number(Fraction(size.numerator))
            factors[place] = Block("quotient", (above, below if size.denominator == 1 else divisor))
            size = Fraction(1)
        if not factors and (identity or size == 1):
            factors = [Block("I")]
        shown = ([_number(size)] if size != 1 else []) + factors
        return Block("product", tuple(shown), negative=self.multiple < 0)


_ONE = Block("1")


def added(terms: Iterable[Term]) -> list[Term]:
    """The sum of terms, like ones added, in the order of the first of each."""
    found: dict[Hashable, Term] = {}
    for term in terms:
        first = found.get(term.key)
        found[term.key] = replace(first, multiple=first.multiple + term.multiple) if first else term
    return [term for term in found.values() if term.multiple]


def times(left: Term, right: Term) -> Term:
    """The product of two terms."""
    return Term(left.multiple * right.multiple, left.factors + right.factors)


def same_values(graph: Graph) -> dict[int, Node]:
    """For each node, by its identity, the first node of the graph that is the same operation of the same."""
    same: dict[int, Node] = {}
    first: dict[Hashable, Node] = {}
    for node in graph.nodes():
        key = (signature(node), tuple([id(same[id(n)]) for n in node.operands]))
        same[id(node)] = first.setdefault(key, node)
    return same


def signature(node: Node) -> Hashable:
    """What an operation is, beside its operands; parameters, and what has no hash, are just themselves."""
    operation = node.operation
    if isinstance(operation, Leaf):
        return id(node) if operation.name == "parameter" else (operation.result, operation.coords)
    try:
        hash(operation.parameters)
    except TypeError:
        return id(operation)
    return operation.name, operation.show, operation.result, operation.parameters


def term_of(block: Block, node: Node, kept: Collection[int]) -> Term:
    """A block of a node as a term; values in ``kept`` have names, so that numbers in them are not seen."""
    return _Reading(signature(node), kept).term(block)


@dataclass(frozen=True)
class _Reading:
    operation: Hashable
    kept: Collection[int]

    def term(self, part: Part) -> Term:
        """A tree, or a value that stands for its multiple of the identity or for a column."""
        assert not isinstance(part, int), "a place that was never filled"
        if isinstance(part, Node):
            return self.value(part)
        sign = Term(Fraction(-1 if part.negative else 1))
        return times(sign, self.plain(-part if part.negative else part))

    def plain(self, block: Block) -> Term:
        if block.head in _NUMBERS:
            return Term(_NUMBERS[block.head])
        if block.head == "I":
            return Term(Fraction(1))
        if block.head == "product":
            whole = Term(Fraction(1))
            for part in block.parts:
                whole = times(whole, self.term(part))
            return whole
        return self.quotient(*block.parts) if block.head == "quotient" else self.single(block)

    def quotient(self, above: Part, below: Part) -> Term:
        over, under = self.term(above), self.term(below)
        if not under.multiple:
            return self.single(Block("quotient", (above, below)))
        multiple = over.multiple / under.multiple
        if not under.factors:
            return Term(multiple, over.factors)
        top, bottom = _together(over.factors), _together(under.factors)
        return times(Term(multiple), self.single(Block("quotient", (top, bottom))))

    def value(self, node: Node) -> Term:
        number = _constant(node)
        if number is not None:
            return Term(number)
        name, operands = node.operation.name, node.operands
        if id(node) not in self.kept and node.manifold.form.dim == 1:
            if name == "neg":
                return times(Term(Fraction(-1)), self.value(operands[0]))
            if name == "mul" and any(_constant(n) is not None for n in operands):
                return times(self.value(operands[0]), self.value(operands[1]))
            if name == "div" and (_constant(operands[1]) or 0) != 0:
                return self.quotient(*operands)
        return Term(Fraction(1), (self.factor(Block("product", (node,))),))

    def single(self, block: Block) -> Term:
        return Term(Fraction(1), (self.factor(block),))

    def factor(self, block: Block) -> Factor:
        return Factor(block, self.key(block), _is_number(block))

    def key(self, part: Part) -> Hashable:
        if not isinstance(part, Block):
            return part if isinstance(part, int) else id(part)
        own = self.operation if part.head in _OF_OPERATION else None
        parts = tuple([self.key(p) for p in part.parts])
        if part.head == "product" and len(parts) == 1 and not part.negative:
            return parts[0]
        return part.head, part.detail, part.negative, own, parts


def _together(factors: Sequence[Factor]) -> Part:
    if not factors:
        return _ONE
    parts = tuple([f.block for f in factors])
    only = parts[0] if len(parts) == 1 else Block("product", parts)
    return only.parts[0] if only.head == "product" and len(only.parts) == 1 else only


def _is_number(part: Part) -> bool:
    if isinstance(part, Block):
        return part.head in _NUMBERS or (part.head in _OF_NUMBERS and all(map(_is_number, part.parts)))
    return not isinstance(part, int) and part.manifold.form.dim == 1


def _constant(node: Node) -> Fraction | None:
    """The number that a constant of one entry is, as it is written."""
    leaf = node.operation
    if not isinstance(leaf, Leaf) or leaf.name == "parameter" or len(leaf.coords) != 1:
        return None
    number = float(leaf.coords[0])
    return Fraction(repr(number)) if isfinite(number) else None


def _number(value: Fraction) -> Block:
    """An integer, a decimal of up to six digits, or a quotient of integers."""
    decimal = f"{float(value):.6g}"
    if Fraction(decimal) == value or max(value.numerator, value.denominator) >= 10**6:
        return Block("number", detail=decimal if Fraction(decimal) == value else repr(float(value)))
    above, below = (Block("number", detail=str(n)) for n in (value.numerator, value.denominator))
    return Block("quotient", (above, below))
