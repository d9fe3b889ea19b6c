r"""A graph in LaTeX: the residual and its Jacobians in the group's own notation.

The rows are those of an ``aligned`` environment; what is used is understood by LaTeX with amsmath, MathJax
and KaTeX.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from liegen.manifolds import Leaf, Node
from liegen.manifolds.form import GroupForm

from .blocks import additive
from .formulas import named_values, texts_of
from .graph import Graph
from .jacobian_lines import jacobian_lines
from .latex_names import spelled
from .latex_values import LatexValues
from .notation import ATOM, LATEX, Text


def latex(graph: Graph) -> str:
    """The rows of a graph, aligned."""
    return aligned(latex_rows(graph))


def aligned(rows: Iterable[str]) -> str:
    r"""An ``aligned`` environment, to be set between ``\[`` and ``\]`` or two dollar signs."""
    return "\\begin{aligned}\n" + " \\\\\n".join(f"  {row}" for row in rows) + "\n\\end{aligned}"


def latex_rows(graph: Graph) -> tuple[str, ...]:
    """Shared values, outputs, stated conditions, then what the Jacobians speak of, and the Jacobians."""
    lines, shared = jacobian_lines(graph, _stands_as_it_is), named_values(graph)
    parameters = [p.name for p in graph.parameters]
    written = spelled(dict.fromkeys([*parameters, *(n for n, _ in graph.outputs), *lines.names.values()]))
    show = LatexValues(written)
    formula = _Called(shared, written, texts_of(graph, _written(shared, written), show))
    called = _Called(lines.names, written, texts_of(graph, _written(lines.names, written), show))
    return (
        *(formula.defined(n) for n in graph.nodes() if id(n) in shared),
        *(
            f"{written[name]} &= {formula(node).text}"
            for name, node in graph.outputs
            if shared.get(id(node)) != name
        ),
        *(rf"\text{{requires}} &\quad {formula(d.condition).text}" for d in graph.domain),
        *map(called.defined, lines.definitions),
        *(
            rf"\frac{{\partial {written[d.name]}}}{{\partial {called(d.variable).text}}} &= "
            + LATEX.text(d.block, called).text
            for d in lines.derivatives
        ),
    )


def _written(names: Mapping[int, str], written: Mapping[str, str]) -> dict[int, str]:
    return {key: written[name] for key, name in names.items()}


@dataclass(frozen=True)
class _Called:
    """Values by their names where they have one, else by their texts."""

    names: Mapping[int, str]
    written: Mapping[str, str]
    texts: Mapping[int, Text]

    def __call__(self, node: Node) -> Text:
        name = self.names.get(id(node))
        return Text(self.written[name], ATOM) if name else self.texts[id(node)]

    def defined(self, node: Node) -> str:
        """``a &= x^{-1} y``."""
        return f"{self(node).text} &= {self.texts[id(node)].text}"


def _stands_as_it_is(node: Node) -> bool:
    """Products of parameters on a group are as short as a name for them."""
    return (
        node.operation.name in ("between", "compose")
        and isinstance(node.manifold.form, GroupForm)
        and not additive(node)
        and all(isinstance(n.operation, Leaf) and n.operation.name == "parameter" for n in node.operands)
    )
