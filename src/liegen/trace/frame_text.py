"""A frame report as lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from liegen.manifolds import S2, SO2, Calibration, Leaf, Node
from liegen.manifolds.pose import Pose
from liegen.manifolds.similarity import Similarity

from .frame_names import Kind, is_map
from .frame_report import FrameReport
from .frame_terms import Framed
from .graph import Graph, Parameter


def lines(graph: Graph, values: Mapping[int, Framed], report: FrameReport) -> tuple[str, ...]:
    """What each argument is, then the frames of rows, noise and columns."""
    return (*_arguments(graph, values, report), *_outputs(graph, values, report), *_columns(graph, report))


def _arguments(graph: Graph, values: Mapping[int, Framed], report: FrameReport) -> Iterator[str]:
    for p in graph.parameters:
        if p.name in report.arguments:
            kind = values[id(p.node)].kind
            inferred = "" if p.frames else " (inferred)"
            yield f"{p.name}: {_described(p, report.arguments[p.name], kind)}{inferred}"
        elif p.frames and issubclass(p.manifold, SO2):
            yield f"{p.name}: bearing in {p.frames.names[0]}"


def _described(p: Parameter, names: tuple[str, ...], kind: Kind) -> str:
    if issubclass(p.manifold, Calibration):
        return f"calibration, from {names[1]} to {names[0]}"
    if issubclass(p.manifold, Pose):
        return f"pose of {names[1]} in {names[0]}"
    if issubclass(p.manifold, Similarity):
        return f"similarity from {names[1]} to {names[0]}"
    if is_map(p.manifold):
        return f"rotation from {names[1]} to {names[0]}"
    if issubclass(p.manifold, S2):
        return f"direction in {names[0]}"
    return f"{kind.value} in {names[0]}"


def _outputs(graph: Graph, values: Mapping[int, Framed], report: FrameReport) -> Iterator[str]:
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


def _shape(node: Node, values: Mapping[int, Framed]) -> str:
    if is_map(node.manifold) or issubclass(node.manifold, S2):
        return "tangent"
    kind = values[id(node)].kind
    return (Kind.FREE if kind is Kind.DIFFERENCE else kind).value


def _columns(graph: Graph, report: FrameReport) -> Iterator[str]:
    directions = {p.name for p in graph.parameters if issubclass(p.manifold, S2)}
    for name, _ in graph.outputs:
        for variable, frame in report.columns.items():
            basis = f", in the tangent basis at {variable}" if variable in directions else ""
            yield f"{name}_D_{variable}: columns in {frame}{basis}"
