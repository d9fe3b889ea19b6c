"""The operations of a graph in LaTeX: products of a group side by side, x^{-1} y, Log, Exp, T p."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from liegen.manifolds import Leaf, Node, Vector

from .blocks import additive, elementwise, exponential, positions
from .latex_names import latex_name, latex_number, upright, worded
from .notation import (
    ACTION,
    ATOM,
    NEGATIVE,
    POWER,
    PRODUCT,
    SUM,
    WEAK,
    Layout,
    Text,
    in_tall_parentheses,
)

_ADDITIVE: Mapping[str, Layout] = {
    "compose": Layout("#0 + #1", SUM, (SUM, WEAK)),
    "inverse": Layout("-#0", NEGATIVE, (WEAK,)),
    "between": Layout("#1 - #0", SUM, (WEAK, SUM)),
    "local": Layout("#1 - #0", SUM, (WEAK, SUM)),
    "retract": Layout("#0 + #1", SUM, (SUM, WEAK)),
}
_GROUP: Mapping[str, Layout] = {
    "compose": Layout("#0 #1", ACTION, (ACTION, ACTION)),
    "inverse": Layout("#0^{-1}", POWER, (ATOM,)),
    "between": Layout("#0^{-1} #1", ACTION, (ATOM, ACTION)),
    "local": Layout(r"\mathrm{Log}\left(#0^{-1} #1\right)", ATOM, (ATOM, ACTION)),
    "retract": Layout(r"#0\, \mathrm{Exp}\left(#1\right)", ACTION, (ACTION,)),
}
#: Manifolds that are no groups: both maps start at a point.
_CURVED: Mapping[str, Layout] = {
    "local": Layout(r"\mathrm{Log}_{#0}\left(#1\right)"),
    "retract": Layout(r"\mathrm{Exp}_{#0}\left(#1\right)"),
}
_GEOMETRY: Mapping[str, Layout] = {
    "exp": Layout(r"\mathrm{Exp}\left(#0\right)"),
    "log": Layout(r"\mathrm{Log}\left(#0\right)"),
    "rotate": Layout("#0 #1", ACTION, (ACTION, ACTION)),
    "unrotate": Layout("#0^{-1} #1", ACTION, (ATOM, ACTION)),
    "transform_from": Layout("#0 #1", ACTION, (ACTION, ACTION)),
    "transform_to": Layout("#0^{-1} #1", ACTION, (ATOM, ACTION)),
    "rotation": Layout(r"\mathrm{R}_{#0}"),
    "translation": Layout(r"\mathrm{t}_{#0}"),
    "pose": Layout(r"\left(#0,\, #1\right)"),
    "direction": Layout(r"\mathrm{dir}\left(#0\right)"),
    "vector": Layout("#0", ATOM, (ATOM,)),
}
_VECTOR: Mapping[str, Layout] = {
    "add": Layout("#0 + #1", SUM, (SUM, WEAK)),
    "sub": Layout("#0 - #1", SUM, (SUM, WEAK)),
    "neg": Layout("-#0", NEGATIVE, (WEAK,)),
    "norm": Layout(r"\left\lVert #0 \right\rVert"),
    "dot": Layout(r"#0^{\top} #1", PRODUCT, (ATOM, POWER)),
    "cross": Layout(r"#0 \times #1", WEAK, (POWER, POWER)),
    "matmul": Layout("M #0", ACTION, (ACTION,)),
    "take": Layout("#0_{[#d]}", ATOM, (ATOM,)),
    "where": Layout(
        r"\begin{cases} #1 & \text{if } #0 \\ #2 & \text{otherwise} \end{cases}", WEAK, (0, 0, 0)
    ),
    "stack": Layout(r"\begin{bmatrix} #* \end{bmatrix}", join=r" \\ "),
}
_SCALAR: Mapping[str, Layout] = {
    "mul": Layout(r"#0\, #1", PRODUCT, (PRODUCT, POWER)),
    "div": Layout(r"\frac{#0}{#1}", POWER),
    "sin": Layout(r"\sin\left(#0\right)"),
    "cos": Layout(r"\cos\left(#0\right)"),
    "tan": Layout(r"\tan\left(#0\right)"),
    "asin": Layout(r"\arcsin\left(#0\right)"),
    "acos": Layout(r"\arccos\left(#0\right)"),
    "sqrt": Layout(r"\sqrt{#0}", POWER),
    "exp": Layout(r"\exp\left(#0\right)"),
    "log": Layout(r"\ln\left(#0\right)"),
    "abs": Layout(r"\left|#0\right|"),
    "atan2": Layout(r"\mathrm{atan2}\left(#0,\, #1\right)"),
    "minimum": Layout(r"\min\left(#0,\, #1\right)"),
    "maximum": Layout(r"\max\left(#0,\, #1\right)"),
}
#: Entry by entry, where both operands are vectors or the divisor is one.
_ENTRIES: Mapping[str, Layout] = {
    "mul": Layout(r"#0 \odot #1", WEAK, (POWER, POWER)),
    "div": Layout(r"#0 \oslash #1", WEAK, (POWER, POWER)),
}
_CONDITION: Mapping[str, Layout] = {
    "lt": Layout("#0 < #1", NEGATIVE),
    "le": Layout(r"#0 \leq #1", NEGATIVE),
    "and": Layout(r"#0 \wedge #1", SUM, (NEGATIVE, NEGATIVE)),
    "or": Layout(r"#0 \vee #1", SUM, (NEGATIVE, NEGATIVE)),
    "not": Layout(r"\neg #0", ATOM, (ATOM,)),
}
_SQUARE = Layout("#0^{2}", POWER, (ATOM,))


@dataclass(frozen=True)
class LatexValues:
    """Prints a node from the texts of its operands; ``names`` are the parameters in LaTeX."""

    names: Mapping[str, str]

    def __call__(self, node: Node, called: Mapping[int, Text]) -> Text:
        """The node's text."""
        if isinstance(node.operation, Leaf):
            return self._leaf(node.operation)
        operands = tuple(called[id(n)] for n in node.operands)
        if node.operation.name == "mul" and operands[0].strength == ACTION:
            # k T p is a multiple of T p, so the point that T moves first is set apart
            operands = (replace(operands[0], strength=WEAK), *operands[1:])
        if node.operation.name == "take":
            operands = (_grouped(operands[0]),)
        layout = _layout(node)
        if layout.strength == ACTION and any(t.text.startswith(r"\mathrm") for t in operands):
            layout = replace(layout, pattern=layout.pattern.replace(" #1", r"\, #1"))  # words stay apart
        return layout.filled(operands, in_tall_parentheses)

    def _leaf(self, leaf: Leaf) -> Text:
        if leaf.name == "parameter":
            return Text(self.names[leaf.show], ATOM)
        numbers = [latex_number(float(c)) for c in leaf.coords]
        if len(numbers) == 1:
            simple = r"\cdot" not in numbers[0]
            return Text(numbers[0], NEGATIVE if numbers[0].startswith("-") else ATOM if simple else PRODUCT)
        kind = "" if issubclass(leaf.result, Vector) else upright(leaf.result.form.name)
        return Text(kind + in_tall_parentheses(r",\, ".join(numbers)), ATOM)


def _grouped(text: Text) -> Text:
    """In braces what may end in a subscript, so that another one may follow."""
    return replace(text, text=f"{{{text.text}}}") if "_{" in text.text and text.strength == ATOM else text


def _layout(node: Node) -> Layout:
    name, operation = node.operation.name, node.operation
    dims = [n.manifold.form.dim for n in node.operands]
    if name == "mul" and node.operands[0] is node.operands[1] and dims[0] == 1:
        return _SQUARE
    if (name == "mul" and min(dims) > 1) or (name == "div" and dims[1] > 1):
        return _ENTRIES[name]
    if name == "take":
        layout = _VECTOR[name]
        return replace(layout, pattern=layout.pattern.replace("#d", positions(operation.parameters)))
    if name in _SCALAR and elementwise(node):
        return _SCALAR[name]
    group = exponential(node)
    for table in (
        _ADDITIVE if additive(node) else _GROUP if group else _CURVED,
        _GEOMETRY,
        _VECTOR,
        _CONDITION,
    ):
        if name in table:
            return table[name]
    method, _, attribute = operation.show.partition("{0}.")
    if name == "part":
        return Layout(f"#0.{latex_name(attribute)}")
    of_object = not method and bool(attribute)
    made = operation.show.partition("(")[0]  # what makes an element is called as its class
    called = made if made.isidentifier() else name.removesuffix("_of")
    return _called(called, of_object, len(dims))


def _called(name: str, method: bool, operands: int) -> Layout:
    """A method with its object as subscript, or a function."""
    arguments = r",\, ".join(f"#{k}" for k in range(int(method), operands))
    shown = worded(name) + ("_{#0}" if method else "")
    return Layout(shown + (in_tall_parentheses(arguments) if arguments else ""))
