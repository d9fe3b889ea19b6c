"""The Jacobians of a graph at group level: sums of products of blocks, before any notation prints them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass

from liegen.charts import form_chart
from liegen.manifolds import Leaf, Node

from .blocks import blocks
from .formulas import free_names, named_values
from .graph import Graph
from .notation import Block

#: A sign and the factors of a product; no factors stand for the identity.
Term = tuple[int, tuple[Block, ...]]


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
        products = [_product(term) for term in self.terms]
        return Block("sum", tuple(products)) if products else Block("0")


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
    active = _active(graph, variables)
    shared = named_values(graph)
    names, definitions = _all_names(graph, active, shared, inline)
    outputs = {id(node) for _, node in graph.outputs}
    lines: list[Derivative] = []
    derivatives: dict[int, dict[int, list[Term]]] = {}
    for node in active:
        terms = _chain_rule(node, derivatives, variables, charted)
        several = id(node) in shared or any(len(products) > 1 for products in terms.values())
        if several and id(node) in names and id(node) not in outputs:
            own = [
                Derivative(names[id(node)], node, variables[v], tuple(products))
                for v, products in terms.items()
                if not _trivial(products)
            ]
            lines += own
            terms |= {id(d.variable): [(1, (Block("of by", (d.node, d.variable)),))] for d in own}
        derivatives[id(node)] = terms
    for name, node in graph.outputs:
        found = _in_rows(node, derivatives.get(id(node), {}), graph)
        lines += [Derivative(name, node, variables[v], tuple(found.get(v, ()))) for v in variables]
    return Lines(names, tuple(definitions), tuple(lines))


def _in_rows(node: Node, terms: Mapping[int, list[Term]], graph: Graph) -> Mapping[int, list[Term]]:
    """The rows of an output on a group in its chart."""
    if form_chart(node.manifold.form, graph.chart) is None:
        return terms
    rows = Block("Chart^-1", (node,))
    return {v: [(s, (rows, *rest)) for s, rest in products] for v, products in terms.items()}


def _trivial(products: list[Term]) -> bool:
    """Whether a sum is the identity but for its sign."""
    return len(products) == 1 and not products[0][1]


def _product(term: Term) -> Block:
    sign, factors = term
    return Block("product", factors or (Block("I"),), negative=sign < 0)


def _factors(block: Block) -> Iterator[Block]:
    """A block as factors of a longer product: the identity is none."""
    if block.head != "I":
        yield -block if block.negative else block


def _chain_rule(
    node: Node,
    derivatives: Mapping[int, Mapping[int, list[Term]]],
    variables: Mapping[int, Node],
    charted: Collection[int],
) -> dict[int, list[Term]]:
    """The derivative of a node by each variable, from those of its operands."""
    if id(node) in variables:
        return {id(node): [(1, (Block("Chart", (node,)),) if id(node) in charted else ())]}
    terms: dict[int, list[Term]] = {}
    for block, operand in zip(blocks(node), node.operands, strict=True):
        for variable, products in derivatives.get(id(operand), {}).items():
            assert block is not None, "conditions have no derivative"
            sign, own = -1 if block.negative else 1, tuple(_factors(block))
            terms.setdefault(variable, []).extend((sign * s, (*own, *rest)) for s, rest in products)
    return terms


def _active(graph: Graph, variables: Mapping[int, Node]) -> list[Node]:
    """The nodes that depend on a variable, operands first."""
    below: dict[int, Node] = {}
    for node in graph.nodes():
        through = node.manifold.form.dim > 0 and any(id(n) in below for n in node.operands)
        if id(node) in variables or through:
            below[id(node)] = node
    return list(below.values())


def _all_names(
    graph: Graph, active: list[Node], shared: Mapping[int, str], inline: Callable[[Node], bool]
) -> tuple[dict[int, str], list[Node]]:
    """Names for shared values and outputs, and for what the blocks speak of; the last need definitions."""
    names = dict(shared)
    for name, node in graph.outputs:
        if not isinstance(node.operation, Leaf):
            names.setdefault(id(node), name)
    depends = {id(n) for n in active}
    spoken: set[int] = set()
    for node in active:
        if not node.operands:
            continue
        for block, operand in zip(blocks(node), node.operands, strict=True):
            if block is not None and id(operand) in depends:
                spoken |= {id(value) for value in block.values()}
    taken = {p.name for p in graph.parameters} | {name for name, _ in graph.outputs} | set(shared.values())
    free = free_names(taken)
    definitions: list[Node] = []
    for node in graph.nodes():
        if id(node) in spoken and id(node) not in names and not _short(node, names) and not inline(node):
            names[id(node)] = next(free)
            definitions.append(node)
    return names, definitions


def _short(node: Node, names: Mapping[int, str]) -> bool:
    """A parameter, a constant, an entry of a named value, or a comparison: its text can stand in a block."""
    if node.operation.name == "take":
        return id(node.operands[0]) in names or isinstance(node.operands[0].operation, Leaf)
    return isinstance(node.operation, Leaf) or node.manifold.form.dim == 0
