"""Blocks of a Jacobian as small trees, and the two notations in which they are printed.

``Ad`` adjoint, ``Jr`` and ``Jl`` right and left Jacobian of the exponential, ``R(x)`` rotation matrix,
``[v]x`` matrix of the vector product, ``J`` quarter turn of the plane, ``I[0:2]`` rows and ``I[:, 0:2]``
columns of the identity, ``B(n)`` tangent basis at a direction, ``D2[f](a, b)`` the derivative of f by its
second operand where there is no shorter name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from liegen.manifolds import Node

from .latex_names import latex_number, worded

#: How strongly a text binds.
SUM, NEGATIVE, WEAK, PRODUCT, ACTION, POWER, ATOM = range(1, 8)


@dataclass(frozen=True)
class Text:
    """A formula and how strongly it binds."""

    text: str
    strength: int


@dataclass(frozen=True)
class Layout:
    """How a tree is printed: ``#0`` its first part, ``#*`` all parts with ``join`` between them.

    A part that binds less than ``needs`` stands in parentheses; parts without an entry never do.
    """

    pattern: str
    strength: int = ATOM
    needs: tuple[int, ...] = ()
    join: str = ""

    def filled(self, parts: tuple[Text, ...], wrap: Callable[[str], str]) -> Text:
        """The pattern with its parts."""
        needs = self.needs if not self.join else self.needs * len(parts)
        wanted = (*needs, *[0] * (len(parts) - len(needs)))
        texts = [wrap(p.text) if p.strength < n else p.text for p, n in zip(parts, wanted, strict=True)]
        whole = _joined(texts, self.join) if self.join else ""
        text = re.sub(r"#(\d|\*)", lambda m: whole if m[1] == "*" else texts[int(m[1])], self.pattern)
        return Text(text, self.strength)


@dataclass(frozen=True)
class Block:
    """A tree of notation: a head of :data:`HEADS` over parts, which are trees or values.

    In the tables of blocks a value is a place: an operand by its number, or ``RESULT``; in a formula a node.
    """

    head: str
    parts: tuple[Part, ...] = ()
    detail: str = ""  # of heads that carry a text: positions, an operation's name
    negative: bool = False

    def __neg__(self) -> Block:
        return replace(self, negative=not self.negative)

    def values(self) -> Iterator[int | Node]:
        """The places or nodes in the tree."""
        for part in self.parts:
            if isinstance(part, Block):
                yield from part.values()
            else:
                yield part

    def at(self, node: Node) -> Block:
        """The tree with the operands and the result of a node in its places."""

        def put(part: Part) -> Part:
            if isinstance(part, Block):
                return part.at(node)
            return node.operands[part] if isinstance(part, int) and part >= 0 else node

        return Block(self.head, tuple([put(part) for part in self.parts]), self.detail, self.negative)


Part = Block | int | Node
RESULT = -1
IDENTITY = Block("I")

#: Each head's layout on a terminal and in LaTeX.
HEADS: Mapping[str, tuple[Layout, Layout]] = {
    "I": (Layout("I"), Layout("I")),
    "0": (Layout("0"), Layout("0")),
    "1": (Layout("1"), Layout("1")),
    "2": (Layout("2"), Layout("2")),
    "number": (Layout("#d"), Layout("#d", PRODUCT)),
    "J": (Layout("J"), Layout("J")),
    "M": (Layout("M"), Layout("M")),
    "Ad": (Layout("Ad(#0)"), Layout(r"\mathrm{Ad}_{#0}")),
    "Jr": (Layout("Jr(#0)"), Layout(r"J_r\left(#0\right)")),
    "Jr^-1": (Layout("Jr^-1(#0)"), Layout(r"J_r^{-1}\left(#0\right)")),
    "Jl^-1": (Layout("Jl^-1(#0)"), Layout(r"J_l^{-1}\left(#0\right)")),
    "Jr of": (Layout("Jr[#d](#*)", join=", "), Layout(r"J_{r,\,\text{#d}}\left(#*\right)", join=r",\, ")),
    "Jr^-1 of": (
        Layout("Jr^-1[#d](#*)", join=", "),
        Layout(r"J_{r,\,\text{#d}}^{-1}\left(#*\right)", join=r",\, "),
    ),
    "Jl^-1 of": (
        Layout("Jl^-1[#d](#*)", join=", "),
        Layout(r"J_{l,\,\text{#d}}^{-1}\left(#*\right)", join=r",\, "),
    ),
    "Ad of": (
        Layout("Ad[#d](#*)", join=", "),
        Layout(r"\mathrm{Ad}_{\text{#d}}\left(#*\right)", join=r",\, "),
    ),
    "Exp": (Layout("Exp(#0)"), Layout(r"\mathrm{Exp}\left(#0\right)")),
    "inverse": (Layout("#0^-1"), Layout("#0^{-1}", POWER, (ATOM,))),
    "transpose": (Layout("#0^T", ATOM, (POWER,)), Layout(r"#0^{\top}", POWER, (ATOM,))),
    "square": (Layout("#0^2", POWER, (POWER,)), Layout("#0^{2}", POWER, (ATOM,))),
    "R": (Layout("R(#0)"), Layout(r"\mathrm{R}_{#0}")),
    # the matrix of a rotation, and of the rotation of a pose
    "matrix": (Layout("R(#0)"), Layout("#0", ATOM, (ATOM,))),
    "Chart": (Layout("Chart(#0)"), Layout(r"M_{#0}")),
    "Chart^-1": (Layout("Chart^-1(#0)"), Layout(r"M^{-1}_{#0}")),
    "velocity": (Layout("#0.velocity", ATOM, (ATOM,)), Layout(r"\mathrm{v}_{#0}")),
    "scale": (Layout("#0.scale", ATOM, (ATOM,)), Layout(r"\mathrm{s}_{#0}")),
    "B": (Layout("B(#0)"), Layout("B_{#0}")),
    "unit row": (
        Layout("unit(#0)^T"),
        Layout(r"\frac{#0^{\top}}{\left\lVert #0 \right\rVert}", POWER),
    ),
    "skew": (Layout("[#0]x"), Layout(r"\left[#0\right]_{\times}")),
    "length": (Layout("|#0|"), Layout(r"\left\lVert #0 \right\rVert")),
    "diag": (Layout("diag(#0)"), Layout(r"\mathrm{diag}\left(#0\right)")),
    "row": (Layout("[#*]", join=", "), Layout(r"\begin{bmatrix} #* \end{bmatrix}", join=" & ")),
    "column": (Layout("[#*]", join="; "), Layout(r"\begin{bmatrix} #* \end{bmatrix}", join=r" \\ ")),
    "product": (Layout("#*", PRODUCT, (PRODUCT,), " "), Layout("#*", PRODUCT, (PRODUCT,), r"\, ")),
    "sum": (Layout("#*", SUM, (NEGATIVE,), " + "), Layout("#*", SUM, (NEGATIVE,), " + ")),
    # a quotient in one line stands in parentheses wherever it is a factor
    "quotient": (Layout("#0 / #1", SUM, (PRODUCT, POWER)), Layout(r"\frac{#0}{#1}", POWER)),
    "sin": (Layout("sin(#0)"), Layout(r"\sin\left(#0\right)")),
    "cos": (Layout("cos(#0)"), Layout(r"\cos\left(#0\right)")),
    "exp": (Layout("exp(#0)"), Layout(r"\exp\left(#0\right)")),
    "sqrt": (Layout("sqrt(#0)"), Layout(r"\sqrt{#0}", POWER)),
    "sign": (Layout("sign(#0)"), Layout(r"\mathrm{sign}\left(#0\right)")),
    "holds": (Layout("[#0]"), Layout(r"\left[#0\right]")),
    "fails": (Layout("[~(#0)]"), Layout(r"\left[\neg\left(#0\right)\right]")),
    "less": (Layout("[#0 < #1]"), Layout(r"\left[#0 < #1\right]")),
    "rows": (Layout("I[#d]"), Layout("I_{[#d]}")),
    "columns": (Layout("I[:, #d]"), Layout(r"I_{[:,\, #d]}")),
    "derivative": (Layout("D#d(#*)", join=", "), Layout(r"D#d\left(#*\right)", join=r",\, ")),
    "of by": (Layout("#0_D_#1"), Layout(r"\frac{\partial #0}{\partial #1}", POWER)),
}


@dataclass(frozen=True)
class Notation:
    """A printer of trees: the layout of every head, and parentheses."""

    layouts: Mapping[str, Layout]
    wrap: Callable[[str], str]
    detail: Callable[[str], str]

    def text(self, block: Block, value: Callable[[Node], Text]) -> Text:
        """A tree as text; ``value`` prints its nodes. A leading minus is written."""
        parts: list[Text] = []
        for part in block.parts:
            assert not isinstance(part, int), "a place that was never filled"
            parts.append(self.text(part, value) if isinstance(part, Block) else value(part))
        layout = self.layouts[block.head]
        if "#d" in layout.pattern:
            layout = replace(layout, pattern=layout.pattern.replace("#d", self.detail(block.detail)))
        shown = layout.filled(tuple(parts), self.wrap)
        return replace(shown, text=f"-{shown.text}") if block.negative else shown


def in_parentheses(text: str) -> str:
    """``(text)``."""
    return f"({text})"


def in_tall_parentheses(text: str) -> str:
    r"""``\left(text\right)``."""
    return rf"\left({text}\right)"


#: What mathematics calls the charts of a manifold.
_MAPS: Mapping[str, str] = {"local": "Log", "retract": "Exp"}


def in_mathematics(detail: str) -> str:
    r"""``1[uncalibrate]`` with the number as subscript and the name upright; other details as they are."""
    if re.fullmatch(r"[\d.]+e[+-]\d+", detail):
        return latex_number(float(detail))
    found = re.fullmatch(r"(\d*)\[(\w+)\]", detail)
    if not found:
        return detail
    number, name = found[1], worded(_MAPS.get(found[2], found[2]))
    return (f"_{{{number}}}" if number else "") + rf"\left[{name}\right]"


TERMINAL = Notation({head: layouts[0] for head, layouts in HEADS.items()}, in_parentheses, str)
LATEX = Notation({head: layouts[1] for head, layouts in HEADS.items()}, in_tall_parentheses, in_mathematics)


def _joined(texts: list[str], join: str) -> str:
    """Parts side by side; in a sum a minus stands for the plus before it."""
    whole = join.join(texts)
    return whole.replace(" + -", " - ") if join == " + " else whole
