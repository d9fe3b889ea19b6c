"""A graph as text: what the user wrote, with names for the values that are used more than once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping

from liegen.manifolds import Leaf, Node

from .graph import Graph
from .notation import ATOM, Text

#: How strongly the signs of the user's own notation bind.
_INFIX = {" < ": 0, " <= ": 0, " + ": 1, " - ": 1, "-": 2, " * ": 3, " / ": 3, " @ ": 4, "M @ ": 4}
_LOGIC = (" & ", " | ", "~")
_CALL = ATOM
#: The text of one node from the texts of its operands.
Show = Callable[[Node, Mapping[int, Text]], Text]


def formula(graph: Graph) -> tuple[str, ...]:
    """One line for each shared value, each output, and each stated domain."""
    names = named_values(graph)
    texts = texts_of(graph, names)

    def used(node: Node) -> str:
        return names.get(id(node)) or texts[id(node)].text

    lines = [f"{names[id(node)]} = {texts[id(node)].text}" for node in graph.nodes() if id(node) in names]
    lines += [f"{name} = {used(node)}" for name, node in graph.outputs if names.get(id(node)) != name]
    lines += [f'require({used(d.condition)}, "{d.message}")' for d in graph.domain]
    return tuple(lines)


def texts_of(graph: Graph, names: Mapping[int, str], printed: Show | None = None) -> dict[int, Text]:
    """The text of every node by its identity, in which nodes with a name are called by it."""
    texts: dict[int, Text] = {}
    for node in graph.nodes():
        called = {id(n): Text(names[id(n)], ATOM) if id(n) in names else texts[id(n)] for n in node.operands}
        texts[id(node)] = (printed or show)(node, called)
    return texts


def named_values(graph: Graph) -> dict[int, str]:
    """Names for the nodes that several others use; an output that others use keeps its own name."""
    nodes = graph.nodes()
    uses = Counter(id(n) for node in nodes for n in node.operands)
    outputs = {id(node): name for name, node in graph.outputs}
    free = free_names({p.name for p in graph.parameters} | {name for name, _ in graph.outputs})
    shared = [
        n
        for n in nodes
        if uses[id(n)] > 1 and not isinstance(n.operation, Leaf) and n.operation.name not in ("take", "part")
    ]
    return {id(n): outputs.get(id(n)) or next(free) for n in shared}


def free_names(taken: set[str]) -> Iterator[str]:
    """Letters that are not taken, a to h, then a1 to h1."""
    k = 0
    while True:
        for letter in "abcdefgh":
            name = f"{letter}{k}" if k else letter
            if name not in taken:
                yield name
        k += 1


def show(node: Node, texts: Mapping[int, Text]) -> Text:
    """The text of one node from the texts of its operands."""
    pattern = node.operation.show
    if isinstance(node.operation, Leaf):
        return Text(pattern, 2 if pattern.startswith("-") else _CALL)
    strength = next((s for sign, s in _INFIX.items() if pattern.startswith(("{0}" + sign, sign))), _CALL)
    parts = [_operand(pattern, k, strength, texts[id(n)]) for k, n in enumerate(node.operands)]
    return Text(pattern.format(*parts), strength)


def _operand(pattern: str, k: int, strength: int, operand: Text) -> str:
    """Parentheses where the place binds more strongly than the operand."""
    before, _, after = pattern.partition(f"{{{k}}}")
    if after.startswith((".", "[")):
        needed = _CALL
    elif any(sign in pattern for sign in _LOGIC):
        needed = 1
    else:
        needed = strength + (before != "") if strength < _CALL else 0
    return f"({operand.text})" if operand.strength < needed else operand.text
