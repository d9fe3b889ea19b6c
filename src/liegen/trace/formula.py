"""A graph as text: what the user wrote, with names for the values that are used more than once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from liegen.manifolds import Leaf, Node

from .graph import Graph

_CALL = 9
_INFIX = {" + ": 1, " - ": 1, "-": 2, " * ": 3, " / ": 3, " @ ": 4}


@dataclass(frozen=True)
class _Text:
    text: str
    strength: int  # how strongly it binds; calls and names most


def formula(graph: Graph) -> tuple[str, ...]:
    """One line for each shared value, each output, and each stated domain."""
    nodes = graph.nodes()
    names, lines = named_values(graph), list[str]()
    texts: dict[int, _Text] = {}
    for node in nodes:
        shown = show(node, texts)
        name = names.get(id(node))
        if name:
            lines.append(f"{name} = {shown.text}")
            shown = _Text(name, _CALL)
        texts[id(node)] = shown
    lines += [
        f"{name} = {texts[id(node)].text}" for name, node in graph.outputs if names.get(id(node)) != name
    ]
    lines += [f'require({texts[id(d.condition)].text}, "{d.message}")' for d in graph.domain]
    return tuple(lines)


def named_values(graph: Graph) -> dict[int, str]:
    """Names for the nodes that several others use; an output that others use keeps its own name."""
    nodes = graph.nodes()
    uses = Counter(id(n) for node in nodes for n in node.operands)
    outputs = {id(node): name for name, node in graph.outputs}
    free = _free_names({p.name for p in graph.parameters} | {name for name, _ in graph.outputs})
    shared = [
        n
        for n in nodes
        if uses[id(n)] > 1 and not isinstance(n.operation, Leaf) and n.operation.name != "take"
    ]
    return {id(n): outputs.get(id(n)) or next(free) for n in shared}


def _free_names(taken: set[str]) -> Iterator[str]:
    k = 0
    while True:
        for letter in "abcdefgh":
            name = f"{letter}{k}" if k else letter
            if name not in taken:
                yield name
        k += 1


def show(node: Node, texts: dict[int, _Text]) -> _Text:
    """The text of one node from the texts of its operands."""
    pattern = node.operation.show
    if isinstance(node.operation, Leaf):
        return _Text(pattern, 2 if pattern.startswith("-") else _CALL)
    strength = next((s for sign, s in _INFIX.items() if pattern.startswith(("{0}" + sign, sign))), _CALL)
    parts = [_operand(pattern, k, strength, texts[id(n)]) for k, n in enumerate(node.operands)]
    return _Text(pattern.format(*parts), strength)


def _operand(pattern: str, k: int, strength: int, operand: _Text) -> str:
    """Parentheses where the place binds more strongly than the operand."""
    after = pattern.partition(f"{{{k}}}")[2]
    receiver = after.startswith((".", "["))
    needed = _CALL if receiver else strength + (k > 0) if strength < _CALL else 0
    return f"({operand.text})" if operand.strength < needed else operand.text
