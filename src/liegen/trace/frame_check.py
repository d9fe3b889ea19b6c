"""A pass over a traced graph: do the frames fit, and in which are residual, Jacobians and noise?"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Any, NoReturn

from liegen.charts import GTSAM
from liegen.errors import DefinitionError
from liegen.manifolds import Leaf, Node, Value, Vector
from liegen.manifolds.pose import Pose
from liegen.manifolds.rotation import Rotation
from liegen.manifolds.similarity import Similarity

from .formulas import show
from .frame_axes import OWN, Charts, in_chart, of_rows, said
from .frame_declared import is_map, pieces
from .frame_fit import leaves, misfit
from .frame_names import Kind
from .frame_products import by_part, framed, own_frames, unknown
from .frame_repair import Trial
from .frame_report import FrameReport
from .frame_rules import rule
from .frame_step import HATCH, Step
from .frame_terms import Frame, Framed, Solver, Sought, made_of
from .frame_text import lines, names_read
from .graph import Call, Graph, Parameter, topological
from .notation import ATOM, Text

#: Operands longer than this are shown as dots.
_LONG = 60
_DOTS = Text("...", ATOM)


def check_frames(graph: Graph, charts: Charts = OWN) -> FrameReport:
    """Find the frames of all values of a graph; what is reported of tangents is in ``charts``.

    Raises DefinitionError, with the line and the likely repair, where declared frames do not fit. Values
    without declared frames fit anything.
    """
    found = _checked(graph, mend=True)
    _coincide_at_zero(found)
    return _report(found, charts)


def _checked(graph: Graph, *, mend: bool = False) -> _Check:
    """The frames of all values. ``mend``: errors propose what would fit."""
    values = {p.node: framed(p, graph.parameters) for p in graph.parameters}
    found = _Check(graph, Solver(), values, mend)
    for node in graph.nodes():
        found.add(node, node)
    for call in graph.calls:
        if call.checked:
            _check_call(call, found)
    return found


@dataclass(frozen=True)
class _Check:
    """A check that runs: ``values`` grows."""

    graph: Graph
    solver: Solver
    values: dict[Node, Framed]
    mend: bool

    @cached_property
    def inside(self) -> _Inside:
        """Which nodes belong to calls."""
        return _Inside.of(self.graph.calls)

    def add(self, node: Node, origin: Node) -> Framed:
        """The frames of a node and, of an operation on products, of those on its parts.

        ``origin`` is the node of the graph that it is, or is part of.
        """
        if node not in self.values:
            unchecked = isinstance(node.operation, Leaf) or id(origin) in self.inside.unchecked
            self.values[node] = unknown(node.manifold) if unchecked else self._found(node, origin)
        return self.values[node]

    def _found(self, node: Node, origin: Node) -> Framed:
        for operand in node.operands:
            self.add(operand, origin)
        parts = by_part(node)
        if parts:
            whole = made_of([self.add(n, origin) for n in parts], [n.manifold.form.dim for n in parts])
            return replace(whole, kind=Kind.TANGENT) if issubclass(node.manifold, Vector) else whole
        return rule(node)(self._step(node, origin))

    def _step(self, node: Node, origin: Node) -> Step:
        operands = tuple(self.values[n] for n in node.operands)

        def refuse(message: str) -> NoReturn:
            call, text = self.inside.calls.get(id(origin)), _texts(node)[node].text
            site = call.site if call else origin.site
            where = f"in {call.name} ({origin.site}), " if call else ""
            raise DefinitionError(f"{site}: {self.graph.name}: {where}{text}: {message}")

        def say() -> tuple[str, ...]:
            texts = _texts(node)
            return tuple(_receiver(texts[n]) for n in node.operands)

        def route(k: int, kind: Kind, to: Frame) -> str | None:
            way = self.solver.name(operands[k].outer), self.solver.name(to)
            ways = _routes(self.graph.parameters, node.operands[k].manifold, f"{{{k}}}", way, kind)
            found = next((text for text in ways if self.mend and trial.operand(k, text)), None)
            return found and found.format(*say())

        trial = Trial(self.graph, node, _checked)
        return Step(node, operands, self.solver, say, refuse, route, lambda t: self.mend and trial.whole(t))


@dataclass(frozen=True)
class _Inside:
    """Which nodes belong to the body of a call: the outermost one, and whether all around it are checked."""

    calls: Mapping[int, Call]
    unchecked: frozenset[int]

    @staticmethod
    def of(calls: Iterable[Call]) -> _Inside:
        owner: dict[int, Call] = {}
        unchecked: set[int] = set()
        for call in calls:
            body = _body(call)
            owner.update(dict.fromkeys(body, call))  # outer calls end later
            unchecked.update(() if call.checked else body)
        return _Inside(owner, frozenset(unchecked))


def _body(call: Call) -> list[int]:
    seen = {id(a.node): False for a in call.arguments}
    stack = list(call.results)
    while stack:
        node = stack.pop()
        if id(node) not in seen:
            seen[id(node)] = True
            stack.extend(node.operands)
    return [key for key, body in seen.items() if body]


def _texts(last: Node) -> dict[Node, Text]:
    """The text of a node and of all that it needs; of long operands only dots."""
    texts: dict[Node, Text] = {}
    for node in topological([last]):
        operands = {id(n): texts[n] for n in node.operands}
        texts[node] = show(node, {k: t if len(t.text) <= _LONG else _DOTS for k, t in operands.items()})
    return texts


def _receiver(text: Text) -> str:
    if len(text.text) > _LONG:
        return _DOTS.text
    return text.text if text.strength >= _DOTS.strength else f"({text.text})"


def _routes(
    parameters: Iterable[Parameter],
    moved: type[Value],
    text: str,
    way: tuple[str | None, str | None],
    kind: Kind,
) -> Iterator[str]:
    """How declared poses and rotations take a vector from one frame to the other."""
    free = kind in (Kind.FREE, Kind.DIFFERENCE, Kind.TANGENT)
    for p in chain.from_iterable(pieces(a.name, a.manifold, a.frames) for a in parameters):
        rotation = issubclass(p.manifold, Rotation)
        if p.declared is None or not is_map(p.manifold) or not issubclass(moved, Vector):
            continue
        form: Any = p.manifold.form if rotation else getattr(p.manifold.form, "rotation", None)
        if form is None or moved.form.dim != form.space:
            continue
        turn, moves = p.path if rotation else f"{p.path}.rotation", not rotation and not free
        pose = p.path if issubclass(p.manifold, Pose | Similarity) else f"{p.path}.pose"
        if p.declared.names == way[::-1]:
            yield f"{pose}.transform_from({text})" if moves else f"{turn} @ {text}"
        if p.declared.names == way:
            yield f"{pose}.transform_to({text})" if moves else f"{turn}.unrotate({text})"


def _check_call(call: Call, found: _Check) -> None:
    """What is given to a factor with declared frames has frames that fit together as they do there."""
    scope: dict[str, Frame] = {}
    for a in call.arguments:
        if a.node not in found.values:  # a constant, or not used
            continue
        own = own_frames(a, call.arguments)

        def meant(name: str, a: Parameter = a, own: tuple[str, ...] = own) -> Frame:
            key = f"{name} of {a.name}" if name in own else name
            return scope.setdefault(key, Sought(untyped=False))

        why = misfit(a.name, a.manifold, a.frames, found.values[a.node], found.solver, meant)
        if why:
            raise DefinitionError(f"{call.site}: {found.graph.name}: {call.name}: argument {why}; {HATCH}")


def _coincide_at_zero(found: _Check) -> None:
    """A measurement without declared frames has the body frame of what it measures."""
    for node in found.values:
        if node.operation.name == "local" and all(is_map(n.manifold) for n in node.operands):
            measured, predicted = (found.values[n].inner for n in node.operands)
            if found.solver.name(measured) is None and found.solver.name(predicted):
                found.solver.equal(measured, predicted)


def _report(found: _Check, charts: Charts) -> FrameReport:
    graph, values, solver = found.graph, found.values, found.solver
    arguments: dict[str, tuple[str, ...]] = {}
    columns: dict[str, str] = {}
    for p in graph.parameters:
        for piece, value in zip(
            pieces(p.name, p.manifold, p.frames), leaves(p.manifold, values[p.node]), strict=True
        ):
            ends = (value.outer, value.inner) if is_map(piece.manifold) else (value.outer,)
            names = [solver.name(f) for f in ends]
            known = tuple(name for name in names if name is not None)
            if len(known) == len(names):
                arguments[piece.path] = known
        preset, dim = charts.columns.get(p.name, GTSAM), p.manifold.form.dim
        column = said(in_chart(values[p.node], p.manifold, p.name, preset), dim, solver, "columns")
        if p.variable and column:
            columns[p.name] = column
    rows = {
        name: row
        for name, node in graph.outputs
        if (row := said(of_rows(node, values, charts.rows), node.manifold.form.dim, solver, "rows"))
    }
    declared = any(p.frames for p in graph.parameters)
    report = FrameReport(declared, arguments, rows, columns, names_read(graph.parameters))
    return replace(report, lines=lines(graph, values, report, charts))
