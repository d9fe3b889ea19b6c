"""What a factor computes, and what it costs, as text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from liegen.charts import form_chart
from liegen.define import Function
from liegen.derive import function_latex, noise_lines, weights_of
from liegen.kernel import Kernel
from liegen.manifolds import Leaf
from liegen.program.kinds import kinds as grouped
from liegen.text import latex_comment
from liegen.trace import Graph, jacobian_formulas
from liegen.trace.formulas import texts_of
from liegen.trace.jacobian_text import legend

AnyFunction = Function[..., Any]


@dataclass(frozen=True)
class Summary:
    """A factor in one row."""

    name: str
    variables: Mapping[str, str]
    given: Mapping[str, str]
    outputs: Mapping[str, tuple[str, int]]
    meaning: str

    @property
    def arguments(self) -> str:
        """``x: SE3, y: SE3, *, z: SE3``."""
        variables = [f"{k}: {v}" for k, v in self.variables.items()]
        given = [f"{k}: {v}" for k, v in self.given.items()]
        return ", ".join([*variables, *(["*"] if variables and given else []), *given])

    @property
    def results(self) -> str:
        """``res: 6``, the dimensions of the outputs' tangents."""
        return ", ".join(f"{name}: {dim}" for name, (_, dim) in self.outputs.items())

    def as_json(self) -> dict[str, Any]:
        """The same with plain types."""
        return {
            "name": self.name,
            "variables": dict(self.variables),
            "given": dict(self.given),
            "outputs": {name: {"manifold": m, "dim": dim} for name, (m, dim) in self.outputs.items()},
            "doc": self.meaning,
        }


def summary(function: AnyFunction) -> Summary:
    """Name, arguments, outputs and the first line of the docstring; nothing is derived."""
    graph = function.graph
    lines = graph.doc.strip().splitlines()
    kinds = {w.name: w.kind for w in weights_of(function.plain, function.weighting)}
    return Summary(
        name=graph.name,
        variables={p.name: p.manifold.form.name for p in graph.variables},
        given={p.name: kinds.get(p.name, p.manifold.form.name) for p in graph.parameters if not p.variable},
        outputs={n: (node.manifold.form.name, node.manifold.form.dim) for n, node in graph.outputs},
        meaning=lines[0] if lines else "",
    )


def explanation(function: AnyFunction) -> str:
    """Residual, Jacobians at group level, conventions, and the operations after each pass."""
    kernel, row = function.kernel, summary(function)
    lines = [f"{row.name}({row.arguments}) -> {row.results}", *_indented(kernel.doc.strip().splitlines())]
    lines += _section("Formula", kernel.formula)
    lines += _section("Singular points", _singular(function.plain))
    lines += _section("Jacobians", kernel.jacobian_formulas)
    lines += _section("Noise and loss", kernel.noise)
    lines += _section("Frames", function.frames.lines)
    lines += _section("Names read as frames", function.frames.names)
    lines += _section("Where", [*legend(kernel.jacobian_formulas), *_notes(function.plain)])
    lines += _section("Conventions", kernel.conventions)
    counted = "Operations with Jacobians" if kernel.variables else "Operations"
    lines += _section(f"{counted}, after each pass", _pass_rows(kernel))
    lines += _section("Operations by kind", [*_kind_rows(kernel), *_KIND_NOTES])
    return "\n".join(lines) + "\n"


def latex_explanation(function: AnyFunction) -> str:
    """The same formulas as an ``aligned`` environment of LaTeX, after comments on what the blocks are."""
    row, shown = summary(function), function.plain
    weighed = noise_lines(shown, function.weighting)
    comments = [f"{row.name}({row.arguments}) -> {row.results}", *legend(jacobian_formulas(shown)), *weighed]
    text = function_latex(shown, function.weighting)
    return latex_comment(comments) + text + "\n"


_KIND_NOTES = (
    "call: of these, calls of libm",
    "fused: of these, pairs a b + c that are one instruction with fused multiply-add",
)


def _section(title: str, lines: Iterable[str]) -> list[str]:
    inner = _indented(lines)
    return ["", f"{title}:", *inner] if inner else []


def _singular(graph: Graph) -> list[str]:
    """``point on the axis, where norm(...) is 0``."""
    texts = texts_of(
        replace(graph, outputs=tuple((s.message, n) for s in graph.singular for n in s.zeros)), {}
    )
    lines: list[str] = []
    for stated in graph.singular:
        shown = " and ".join(texts[id(n)].text for n in stated.zeros)
        verb = "are" if len(stated.zeros) > 1 else "is"
        lines.append(f"{stated.message}, where {shown} {verb} 0" if shown else stated.message)
    return lines


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"  {line}".rstrip() for line in lines]


def _pass_rows(kernel: Kernel) -> list[str]:
    rows = [(p.name, p.operations) for p in kernel.passes]
    width = max(len(name) for name, _ in rows)
    lines: list[str] = []
    for (name, count), (_, before) in zip(rows, [rows[0], *rows], strict=False):
        change = count - before
        lines.append(f"{name:<{width}}  {count:>6}" + (f"  {change:+d}" if change else ""))
    return lines


def _kind_rows(kernel: Kernel) -> list[str]:
    alone, both = kernel.value.op_counts(), kernel.jacobians.op_counts()
    kinds = sorted({*alone, *both})
    title = "residual" if [o.name for o in kernel.outputs] == ["res"] else "outputs"
    rows: list[Sequence[Any]] = [("", title, "with Jacobians")]
    rows += [(kind, alone.get(kind, 0), both.get(kind, 0)) for kind in kinds]
    rows.append(("total", kernel.value.operations, kernel.jacobians.operations))
    short, long = grouped(kernel.value), grouped(kernel.jacobians)
    rows += [(kind, short[kind], long[kind]) for kind in ("call", "fused")]
    lines = [(f"{a!s:<8}  {b!s:>8}", f"  {c!s:>14}") for a, b, c in rows]
    return [first + (second if kernel.variables else "") for first, second in lines]


def _notes(graph: Graph) -> list[str]:
    """In which frame the noise lives, for the residual z.local(x.between(y))."""
    result = graph.outputs[0][1]
    if result.operation.name != "local" or not isinstance(result.operands[0].operation, Leaf):
        return []
    measured, predicted = result.operands
    if predicted.operation.name != "between" or not all(
        isinstance(n.operation, Leaf) and n.operation.name == "parameter"
        for n in (measured, *predicted.operands)
    ):
        return []
    z, x, y = (n.operation.show for n in (measured, *predicted.operands))
    known = {name: names[-1] for name, names in graph.frames.arguments.items()}
    own = {name: f"frame {known[name]}" if name in known else "its own frame" for name in (x, y)}
    frame, cov, why = f"noise of covariance S in the frame of {z}:", "S", f"exact, since {y} = {x} {z} Exp(n)"
    if form_chart(measured.manifold.form, graph.chart) is not None:
        cov, why = "S'", "of first order"
        frame = (
            f"noise of covariance S in the chart {graph.chart.name} at {z}, "
            f"S' = M({z}) S M({z})^T (uncertainty.from_chart):"
        )
    return [
        f"{frame} with {x} fixed, {y} has covariance {cov} in {own[y]};",
        f"with {y} fixed, {x} has covariance Ad({z}) {cov} Ad({z})^T in {own[x]}",
        f"({why})",
    ]
