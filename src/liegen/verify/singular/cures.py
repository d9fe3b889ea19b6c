"""What is wrong with an operation at its singular point, and what to write instead."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping

from liegen.manifolds import Node
from liegen.trace import Graph, topological
from liegen.trace.formulas import named_values, texts_of

from ..sphere_slack import has_sphere

#: Formulas up to this length are printed in full; longer ones by the names that ``explain`` prints.
SHORT = 40


def hole_of(node: Node) -> str:
    """What the documentation says of an operation that has no value, or no derivative, somewhere."""
    name = node.operation.name
    if name == "direction":
        return "the vector 0 has no direction"
    if name == "local" and has_sphere(node.operands[0].manifold.form):
        return "opposite directions have no Jacobian"
    return ""


class Texts:
    """The texts of nodes: in full, or with the names that ``explain`` gives to shared values."""

    def __init__(self, graph: Graph) -> None:
        self._names = named_values(graph)
        self._full = texts_of(graph, {})
        self._short = texts_of(graph, self._names)

    def of(self, *nodes: Node) -> Callable[[Node], str]:
        """A printer that is in full where all of ``nodes`` are short."""
        if all(len(self._full[id(n)].text) <= SHORT for n in nodes):
            return lambda node: self._full[id(node)].text
        return lambda node: self._names.get(id(node)) or self._short[id(node)].text

    def definition(self, node: Node) -> str:
        """The formula of a node that may have a name."""
        return (self._full if len(self._full[id(node)].text) <= SHORT else self._short)[id(node)].text

    def named(self, text: str, nodes: Iterable[Node]) -> str:
        """``, a = T.transform_to(p)``: the names in a text, and in what is said of those."""
        named = {self._names[id(n)]: n for n in topological(nodes) if id(n) in self._names}
        said: dict[str, str] = {}
        waiting = [text]
        while waiting:
            for word in re.findall(r"[A-Za-z_]\w*", waiting.pop()):
                if word in named and word not in said:
                    said[word] = self._short[id(named[word])].text
                    waiting.append(said[word])
        return "".join(f", {name} = {said[name]}" for name in sorted(said))


def has_cure(node: Node) -> bool:
    """Whether an operation has points without a bound."""
    return node.operation.name in _CURES


def cure(node: Node, text: Callable[[Node], str]) -> str:
    """What to write instead of an operation, or to state."""
    name = node.operation.name
    rule = _CURES.get(name)
    operands = [text(n) for n in node.operands]
    return rule(node, operands) if rule else _require("...")


def _require(condition: str) -> str:
    return f'state where it holds with require({condition}, "...")'


def _root(node: Node, texts: list[str]) -> str:
    square = _square(node.operands[0])
    (x,) = texts
    first = f"write norm({_inner(x)})" if square == "dot" else "write norm(...) if it is a length"
    if square == "square":
        first = f"write abs({_half(x)})"
    return f'{first}, or require({x} > 0, "...")'


def _square(node: Node) -> str:
    """Whether it is the scalar product of a vector with itself, or a square."""
    same = len(node.operands) == 2 and node.operands[0] is node.operands[1]
    return {"dot": "dot", "mul": "square"}.get(node.operation.name, "") if same else ""


def _inner(text: str) -> str:
    """``d`` of ``dot(d, d)``."""
    inside = text.removeprefix("dot(").removesuffix(")")
    return inside[: (len(inside) - 2) // 2] if text.startswith("dot(") else inside


def _half(text: str) -> str:
    """``x`` of ``x * x``."""
    return text[: (len(text) - 3) // 2]


def _quotient(_: Node, texts: list[str]) -> str:
    return f'require(abs({texts[1]}) > 0, "...") or write it without the quotient'


def _angle(_: Node, texts: list[str]) -> str:
    y, x = texts
    return f'require(norm(stack({y}, {x})) > 0, "...")'


def _inverse(node: Node, texts: list[str]) -> str:
    (x,) = texts
    dot = node.operands[0].operation.name in ("dot", "div")
    first = "for the angle of a and b write atan2(norm(cross(a, b)), dot(a, b)), or " if dot else ""
    return f'{first}require(abs({x}) < 1, "...")'


def _log(_: Node, texts: list[str]) -> str:
    return f'require({texts[0]} > 0, "...")'


_CURES: Mapping[str, Callable[[Node, list[str]], str]] = {
    "sqrt": _root,
    "div": _quotient,
    "atan2": _angle,
    "acos": _inverse,
    "asin": _inverse,
    "log": _log,
}
