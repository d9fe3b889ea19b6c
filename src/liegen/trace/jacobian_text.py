"""The Jacobians of a graph as text for a terminal; :mod:`.notation` lists what the blocks are called."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.manifolds import Node

from .formulas import texts_of
from .graph import Graph
from .jacobian_lines import jacobian_lines
from .notation import ATOM, TERMINAL, Text

_RIGHT = "Jr(d), Jr^-1(d): right Jacobian of Exp at d and its inverse"
#: What occurs in a line, and what it means.
_LEGEND: Mapping[str, str] = {
    "Ad(": "Ad(x): adjoint, x Exp(d) = Exp(Ad(x) d) x",
    "Jr(": _RIGHT,
    "Jr^-1(": _RIGHT,
    "Jl^-1(": "Jl^-1(d): inverse of the left Jacobian, Jl(d) = Jr(-d)",
    "Jr^-1[": "Jr^-1[c](x, y): d x.local(y Exp(e))/de at 0 in the chart c; Jr^-1(res) in the chart of Exp",
    "Jl^-1[": "Jl^-1[c](x, y): -d (x Exp(e)).local(y)/de at 0 in the chart c; Jl^-1(res) in the chart of Exp",
    "Jr[": "Jr[c](x, d): the right Jacobian of d -> x.retract(d) in the chart c; Jr(d) in the chart of Exp",
    "Ad[": "Ad[c](x, d): how x.retract(d) moves with x in the chart c; Ad(Exp(d)^-1) in the chart of Exp",
    "R(": "R(x): rotation matrix of x",
    "]x": "[v]x: the matrix with [v]x w = v x w",
    "J ": "J: quarter turn [[0, -1], [1, 0]]",
    "B(": "B(n): tangent basis at the direction n, 2 x 3",
    "unit(": "unit(v): v / |v|, and 0 at 0",
    "I[": "I[0:2], I[:, 0:2]: these rows, columns of the identity",
    "diag(": "diag(v): diagonal matrix",
    " M": "M: the constant matrix of the formula",
    "D[": "D[f](a): derivative of f at a",
    "Chart(": "Chart(x): column map of the chart of x, d Log(x^-1 x.retract(d))/dd at 0",
    "Chart^-1(": "Chart^-1(x): inverse of the column map of the chart of x",
    "D1[": "D1[f](a, b): derivative of f by its first operand",
    "D2[": "D2[f](a, b): derivative of f by its second operand",
}


def legend(lines: tuple[str, ...]) -> tuple[str, ...]:
    """The notation that occurs in the lines of :func:`jacobian_formulas`."""
    right = [line.partition(" = ")[2] for line in lines if "_D_" in line.partition(" = ")[0]]
    text = " " + " ".join(right)
    return tuple(dict.fromkeys(meaning for mark, meaning in _LEGEND.items() if mark in text))


def jacobian_formulas(graph: Graph) -> tuple[str, ...]:
    """Lines such as ``res_D_x = -Jr^-1(res) Ad(a^-1)``, after what ``formula`` does not define."""
    lines = jacobian_lines(graph, lambda _: False)
    texts = texts_of(graph, lines.names)
    parameters = {id(p.node): p.name for p in graph.parameters}

    def value(node: Node) -> Text:
        return Text(lines.names.get(id(node)) or texts[id(node)].text, ATOM)

    return (
        *(f"{lines.names[id(n)]} = {texts[id(n)].text}" for n in lines.definitions),
        *(
            f"{d.name}_D_{parameters[id(d.variable)]} = {TERMINAL.text(d.block, value).text}"
            for d in lines.derivatives
        ),
    )
