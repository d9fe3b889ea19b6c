"""Along which frames the coordinates of a tangent are: of a value, of a variable or output in a chart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from liegen.charts import GTSAM, Preset, form_chart
from liegen.manifolds import Leaf, ManifoldForm, Node, Value
from liegen.manifolds.form import PoseForm, RotationForm

from .frame_names import Kind
from .frame_terms import Framed, Part, Solver


@dataclass(frozen=True)
class Charts:
    """The charts of a factor: of the columns of each variable, and of ``local`` and the rows."""

    columns: Mapping[str, Preset] = field(default_factory=dict[str, Preset])
    rows: Preset = GTSAM


#: Everything in its manifold's own chart.
OWN = Charts()


@dataclass(frozen=True)
class Piece:
    """Coordinates ``start`` to ``stop`` of a tangent, along the outer or the inner frame of ``value``."""

    value: Framed
    path: str
    start: int
    stop: int
    outer: bool


def said(pieces: Iterator[Piece], dim: int, solver: Solver, what: str) -> str | None:
    """The frame of all pieces; where they differ that of each, with its coordinates."""
    runs: list[tuple[str, int, int]] = []
    for piece in pieces:
        frame = None if piece.value.kind is Kind.CAMERA else _name(piece, solver)
        if runs and frame and runs[-1][0] == frame and runs[-1][2] == piece.start:
            runs[-1] = (frame, runs[-1][1], piece.stop)
        elif frame:
            runs.append((frame, piece.start, piece.stop))
    if len(runs) == 1 and runs[0][1:] == (0, dim):
        return runs[0][0]
    return ", ".join(f"{frame} ({what} {start}:{stop})" for frame, start, stop in runs) or None


def _name(piece: Piece, solver: Solver) -> str | None:
    if not piece.outer:
        return solver.said(piece.value.inner)
    return solver.said(piece.value.outer) or f"the outer frame of {piece.path}"


def of_value(value: Framed, dim: int) -> Iterator[Piece]:
    """A value, or the parts of stacked vectors and of products, by their inner frames."""
    for part in _parts(value, dim):
        yield Piece(part.value, "", part.start, part.stop, outer=False)


def in_chart(value: Framed, manifold: type[Value], path: str, preset: Preset) -> Iterator[Piece]:
    """The coordinates of a manifold's chart."""
    forms = list(_leaves(manifold.form, path))
    for part, (form, place) in zip(_parts(value, manifold.form.dim), forms, strict=False):
        for start, stop, outer in _axes(form, preset):
            yield Piece(part.value, place, part.start + start, part.start + stop, outer=outer)


def of_rows(node: Node, values: Mapping[Node, Framed], preset: Preset) -> Iterator[Piece]:
    """An output: on a manifold in its chart; of ``local`` and its negative in that of the first operand."""
    at = _taken_at(node)
    if at is None or form_chart(at.manifold.form, preset) is None:
        return of_value(values[node], node.manifold.form.dim)
    path = at.operation.show if isinstance(at.operation, Leaf) else "the element that local is taken at"
    return in_chart(values[at], at.manifold, path, preset)


def charted(nodes: tuple[Node, ...], outputs: tuple[Node, ...], preset: Preset) -> bool:
    """Whether ``local``, ``retract`` or an output makes a difference in the chart."""
    used = [n.operands[0] for n in nodes if n.operation.name in ("local", "retract")]
    return any(form_chart(n.manifold.form, preset) for n in (*used, *outputs))


def _taken_at(node: Node) -> Node | None:
    if node.operation.name == "neg":
        return _taken_at(node.operands[0])
    if node.operation.name == "local":
        return node.operands[0]
    return node


def _parts(value: Framed, dim: int) -> Iterator[Part]:
    """None of pixels and the like, which are in no frame."""
    if value.kind is not Kind.CAMERA:
        yield from value.flat() if value.parts else (Part(value, 0, dim),)


def _leaves(form: ManifoldForm, path: str) -> Iterator[tuple[ManifoldForm, str]]:
    if not form.parts:
        yield form, path
    for part, name in zip(form.parts, getattr(form, "names", ()), strict=True):
        yield from _leaves(part, f"{path}.{name}")


def _axes(form: ManifoldForm, preset: Preset) -> tuple[tuple[int, int, bool], ...]:
    """Slices of a tangent without parts, and whether they are along the outer frame."""
    if form_chart(form, preset) is None:
        return ((0, form.dim, False),)
    chart = preset.chart(form)
    if isinstance(form, RotationForm):
        return ((0, form.dim, chart.side == "left"),)
    if not isinstance(form, PoseForm):
        return ((0, form.dim, False),)
    left = chart.side == "left"
    turn, move = form.rotation.dim, form.dim - form.rotation.dim
    turned = left and (form.space == 3 or chart.translation == "coupled")
    moved = left if chart.translation == "coupled" else chart.translation == "world"
    first = form.rotation_first if chart.order == "own" else chart.order == "rotation-first"
    if first:
        return (0, turn, turned), (turn, form.dim, moved)
    return (0, move, moved), (move, form.dim, turned)
