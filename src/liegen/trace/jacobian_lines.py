"""The Jacobians of a graph at group level: sums of products of blocks, before any notation prints them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from liegen.charts import form_chart
from liegen.manifolds import Leaf, Node

from .blocks import blocks
from .formulas import free_names, named_values
from .graph import Graph
from .jacobian_terms import Factor, Term, added, same_values, term_of, times
from .notation import Block, Part


@dataclass(frozen=True)
class Derivative:
    """The derivative of a named value by a variable, as a sum."""

    name: str
    node: Node
    variable: Node
    terms: tuple[Term, ...]

    @property
    def block(self) -> Block:
        """The right-hand side as one tree."""
        identity = self.node.manifold.form.dim > 1  # 3 I, but 3 for a number
        products = tuple([term.block(identity=identity) for term in self.terms])
        return Block("sum", products) if products else Block("0")


@dataclass(frozen=True)
class Lines:
    """What is printed: values that the blocks speak of and that need a line, then derivatives."""

    names: Mapping[int, str]
    definitions: tuple[Node, ...]
    derivatives: tuple[Derivative, ...]


def jacobian_lines(graph: Graph, inline: Callable[[Node], bool]) -> Lines:
    """Values that several others use have lines of their own, so the text stays as short as the graph.

    ``inline`` says which values may stand in a block as they are, without a name.
    """
    variables = {id(p.node): p.node for p in graph.variables}
    charted = {id(p.node) for p in graph.parameters if form_chart(p.manifold.form, p.chart)}
    same = same_values(graph)
    active = [n for n in _active(graph, variables) if same[id(n)] is n]
    shared = named_values(graph)
    kept = {id(same[key]) for key in (*shared, *(id(node) for _, node in graph.outputs)) if key in same}
    terms_of = {id(node): tuple(_terms(node, same, kept)) for node in active}
    names, definitions = _all_names(graph, terms_of, shared, same, inline)
    outputs = {id(same[id(node)]) for _, node in graph.outputs}
    lines: list[Derivative] = []
    derivatives: dict[int, dict[int, list[Term]]] = {}
    for node in active:
        terms = _chain_rule(node, terms_of[id(node)], derivatives, same, variables, charted)
        several = id(node) in kept or any(len(products) > 1 for products in terms.values())
        if several and id(node) in names and id(node) not in outputs:
            own = [
                Derivative(names[id(node)], node, variables[v], tuple(products))
                for v, products in terms.items()
                if not _trivial(products)
            ]
            lines += own
            terms |= {id(d.variable): [_single(Block("of by", (d.node, d.variable)))] for d in own}
        derivatives[id(node)] = terms
    for name, node in graph.outputs:
        found = _in_rows(same[id(node)], derivatives.get(id(same[id(node)]), {}), graph)
        lines += [Derivative(name, node, variables[v], tuple(found.get(v, ()))) for v in variables]
    return Lines(names, tuple(definitions), tuple(lines))


def _in_rows(node: Node, terms: Mapping[int, list[Term]], graph: Graph) -> Mapping[int, list[Term]]:
    """The rows of an output on a group in its chart."""
    if form_chart(node.manifold.form, graph.chart) is None:
        return terms
    rows = _single(Block("Chart^-1", (node,)))
    return {v: [times(rows, term) for term in products] for v, products in terms.items()}


def _trivial(products: list[Term]) -> bool:
    """Whether a sum is the identity but for its sign."""
    return len(products) == 1 and not products[0].factors and abs(products[0].multiple) == 1


def _single(block: Block) -> Term:
    return Term(Fraction(1), (Factor(block, (block.head, *map(id, block.parts))),))


def _terms(node: Node, same: Mapping[int, Node], kept: Collection[int]) -> Iterator[Term | None]:
    """The derivative of a node by each of its operands."""
    if node.operands:
        for block in blocks(node):
            yield block and term_of(_of_same(block, same), node, kept)


def _of_same(block: Block, same: Mapping[int, Node]) -> Block:
    def put(part: Part) -> Part:
        if isinstance(part, Block):
            return _of_same(part, same)
        return part if isinstance(part, int) else same[id(part)]

    return replace(block, parts=tuple([put(part) for part in block.parts]))


def _chain_rule(
    node: Node,
    own: tuple[Term | None, ...],
    derivatives: Mapping[int, Mapping[int, list[Term]]],
    same: Mapping[int, Node],
    variables: Mapping[int, Node],
    charted: Collection[int],
) -> dict[int, list[Term]]:
    """The derivative of a node by each variable, from those of its operands."""
    if id(node) in variables:
        return {id(node): [_single(Block("Chart", (node,))) if id(node) in charted else Term(Fraction(1))]}
    terms: dict[int, list[Term]] = {}
    for term, operand in zip(own, node.operands, strict=True):
        for variable, products in derivatives.get(id(same[id(operand)]), {}).items():
            assert term is not None, "conditions have no derivative"
            terms.setdefault(variable, []).extend(times(term, product) for product in products)
    sums = {variable: added(products) for variable, products in terms.items()}
    return {variable: products for variable, products in sums.items() if products}


def _active(graph: Graph, variables: Mapping[int, Node]) -> list[Node]:
    """The nodes that depend on a variable, operands first."""
    below: dict[int, Node] = {}
    for node in graph.nodes():
        through = node.manifold.form.dim > 0 and any(id(n) in below for n in node.operands)
        if id(node) in variables or through:
            below[id(node)] = node
    return list(below.values())


def _all_names(
    graph: Graph,
    terms: Mapping[int, tuple[Term | None, ...]],
    shared: Mapping[int, str],
    same: Mapping[int, Node],
    inline: Callable[[Node], bool],
) -> tuple[dict[int, str], list[Node]]:
    """Names for shared values and outputs, and for what the blocks speak of; the last need definitions."""
    names = dict(shared)
    for name, node in graph.outputs:
        if not isinstance(node.operation, Leaf):
            names.setdefault(id(node), name)
    nodes = graph.nodes()
    for node in nodes:  # values that are the same have one name, that of the first
        if id(node) in names:
            names.setdefault(id(same[id(node)]), names[id(node)])
    spoken: set[int] = set()
    for node in nodes:
        for term, operand in zip(terms.get(id(node), ()), node.operands, strict=False):
            if term is not None and id(same[id(operand)]) in terms:
                spoken |= {id(value) for factor in term.factors for value in factor.block.values()}
    taken = {p.name for p in graph.parameters} | {name for name, _ in graph.outputs} | set(shared.values())
    free = free_names(taken)
    definitions: list[Node] = []
    for node in nodes:
        if id(node) in spoken and id(node) not in names and not _short(node, names) and not inline(node):
            names[id(node)] = next(free)
            definitions.append(node)
        elif id(same[id(node)]) in names:
            names.setdefault(id(node), names[id(same[id(node)])])
    return names, definitions


def _short(node: Node, names: Mapping[int, str]) -> bool:
    """A parameter, a constant, an entry of a named value, or a comparison: its text can stand in a block."""
    if node.operation.name == "take":
        return id(node.operands[0]) in names or isinstance(node.operands[0].operation, Leaf)
    return isinstance(node.operation, Leaf) or node.manifold.form.dim == 0
