"""A frame report as lines of text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from liegen.charts import form_chart
from liegen.manifolds import S2, SO2, Leaf, Node, Product

from .frame_axes import Charts, charted
from .frame_declared import MAPS, Piece, as_read, is_map, pieces
from .frame_fit import leaves
from .frame_names import Kind
from .frame_report import FrameReport
from .frame_terms import Framed
from .graph import Graph, Parameter


def lines(
    graph: Graph, values: Mapping[Node, Framed], report: FrameReport, charts: Charts
) -> tuple[str, ...]:
    """What each argument is, then the frames of rows, noise and columns, then charts."""
    found = (*_arguments(graph, values, report), *_outputs(graph, values, report), *_columns(graph, report))
    return (*found, *_charts(graph, charts)) if found else ()


#: What to do about a name that was not read.
_CURE = 'declare frames as in T_WB, T_Map_BaseLink, p_W, or with Annotated[SE3, frames("W", "B")]'


def names_read(parameters: Iterable[Parameter]) -> tuple[str, ...]:
    """How the name of each argument was read, or why it was not; nothing of names that say nothing."""
    found = [(p.name, _read(p)) for p in parameters]
    told = [f"{name}: {said}" for name, said in found if said]
    return (*told, *([_CURE] if any(said.startswith("none, ") for _, said in found) else []))


def _read(p: Parameter) -> str:
    reading, names = as_read(p.name, p.manifold), p.frames.names if p.frames else ()
    if names == reading.names or issubclass(p.manifold, Product):
        how = f" (as in {reading.as_})" if names and reading.as_ else ""
        return f"{', '.join(names)}{how}" if names else f"none, {reading.note}" if reading.note else ""
    return f"{', '.join(names) or 'none'} (annotated)"


def _arguments(graph: Graph, values: Mapping[Node, Framed], report: FrameReport) -> Iterator[str]:
    for p in graph.parameters:
        listed = pieces(p.name, p.manifold, p.frames)
        for piece, value in zip(listed, leaves(p.manifold, values[p.node]), strict=True):
            if piece.path in report.arguments:
                inferred = "" if piece.declared else " (inferred)"
                yield f"{piece.path}: {_described(piece, report.arguments[piece.path], value)}{inferred}"
            elif piece.declared and issubclass(piece.manifold, SO2):
                yield f"{piece.path}: bearing in {piece.declared.names[0]}"


def _described(piece: Piece, names: tuple[str, ...], value: Framed) -> str:
    text = next((text for base, text in MAPS.items() if issubclass(piece.manifold, base)), None)
    if text:
        return text.format(*names)
    return f"{'direction' if issubclass(piece.manifold, S2) else value.kind.value} in {names[0]}"


def _outputs(graph: Graph, values: Mapping[Node, Framed], report: FrameReport) -> Iterator[str]:
    for name, node in graph.outputs:
        if name in report.rows:
            frame, basis = report.rows[name], _basis(node)
            where = f"{frame}, {basis}" if basis else frame
            yield f"{name}: {_shape(node, values)} in {where}; noise in {'that basis' if basis else frame}"
        elif node.manifold.form.dim == 1:
            yield f"{name}: a number, in no frame; noise in its unit"


def _basis(node: Node) -> str:
    """Where the tangent of a direction has its basis."""
    if issubclass(node.manifold, S2):
        return "in the tangent basis at it"
    if node.operation.name == "neg":
        return _basis(node.operands[0])
    if node.operation.name != "local" or not issubclass(node.operands[0].manifold, S2):
        return ""
    at = node.operands[0].operation
    return f"in the tangent basis at {at.show if isinstance(at, Leaf) else 'the prediction'}"


def _shape(node: Node, values: Mapping[Node, Framed]) -> str:
    if is_map(node.manifold) or issubclass(node.manifold, S2 | Product):
        return "tangent"
    kind = values[node].kind
    return (Kind.FREE if kind is Kind.DIFFERENCE else kind).value


def _columns(graph: Graph, report: FrameReport) -> Iterator[str]:
    directions = {p.name for p in graph.parameters if issubclass(p.manifold, S2)}
    for name, _ in graph.outputs:
        for variable, frame in report.columns.items():
            basis = f", in the tangent basis at {variable}" if variable in directions else ""
            yield f"{name}_D_{variable}: columns in {frame}{basis}"


def _charts(graph: Graph, charts: Charts) -> Iterator[str]:
    """Where coordinates are not those of x exp(d)."""
    for p in graph.parameters:
        preset = charts.columns.get(p.name)
        if p.variable and preset and form_chart(p.manifold.form, preset):
            yield f"chart {preset.name}: columns of {p.name}; order and scale are under Conventions"
    if charted(graph.nodes(), tuple(node for _, node in graph.outputs), charts.rows):
        yield f"chart {charts.rows.name}: local, rows and noise; order and scale are under Conventions"
