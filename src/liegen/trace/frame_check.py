"""A pass over a traced graph: do the frames fit, and in which are residual, Jacobians and noise?"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NoReturn

from liegen.errors import DefinitionError
from liegen.manifolds import Calibration, Leaf, Manifold, Node, Value, Vector
from liegen.manifolds.pose import Pose
from liegen.manifolds.rotation import Rotation
from liegen.manifolds.similarity import Similarity

from .formulas import show
from .frame_names import Declared, Kind, is_map, needed
from .frame_report import FrameReport
from .frame_rules import rule
from .frame_step import HATCH, Step
from .frame_terms import Frame, Framed, Known, Solver, Sought, mapping, sought, vector
from .frame_text import lines
from .graph import Call, Graph, Parameter
from .notation import ATOM, Text

#: Operands longer than this are shown as dots.
_LONG = 60
_DOTS = Text("...", ATOM)


def check_frames(graph: Graph) -> FrameReport:
    """Find the frames of all values of a graph.

    Raises DefinitionError, with the line and the likely repair, where declared frames do not fit. Values
    without declared frames fit anything.
    """
    solver = Solver()
    values = {id(p.node): _of_parameter(p) for p in graph.parameters}
    inside = _Inside.of(graph.calls)
    for node in graph.nodes():
        if id(node) not in values:
            values[id(node)] = _of_node(node, values, solver, graph, inside)
    for call in graph.calls:
        if call.checked:
            _check_call(call, values, solver, graph)
    _coincide_at_zero(graph, values, solver)
    return _report(graph, values, solver)


def _of_parameter(p: Parameter) -> Framed:
    if p.frames is not None:
        return _declared(p.frames, p.manifold, [Known(name) for name in p.frames.names])
    if is_map(p.manifold):
        camera = issubclass(p.manifold, Calibration)
        return sought("", "" if camera else f"the body frame of {p.name}", is_map=True)
    return sought(f"the frame of {p.name}" if needed(p.manifold) else "", is_map=False)


def _declared(d: Declared, manifold: type[Manifold], frames: list[Frame]) -> Framed:
    if is_map(manifold):
        return mapping(frames[0], frames[1] if len(frames) > 1 else Sought())
    return vector(frames[0], d.kind)


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


def _of_node(
    node: Node, values: Mapping[int, Framed], solver: Solver, graph: Graph, inside: _Inside
) -> Framed:
    if isinstance(node.operation, Leaf) or id(node) in inside.unchecked:
        return sought(is_map=is_map(node.manifold))

    def refuse(message: str) -> NoReturn:
        call, text = inside.calls.get(id(node)), _texts(graph)[id(node)].text
        site = call.site if call else node.site
        where = f"in {call.name} ({node.site}), " if call else ""
        raise DefinitionError(f"{site}: {graph.name}: {where}{text}: {message}")

    def route(k: int, kind: Kind, to: Frame) -> str | None:
        text, frame = say()[k], values[id(node.operands[k])].outer
        return _route(
            graph.parameters, node.operands[k].manifold, text, (solver.name(frame), solver.name(to)), kind
        )

    def say() -> tuple[str, ...]:
        texts = _texts(graph)
        return tuple(_receiver(texts[id(n)]) for n in node.operands)

    step = Step(node, tuple(values[id(n)] for n in node.operands), solver, say, refuse, route)
    return rule(node)(step)


def _texts(graph: Graph) -> dict[int, Text]:
    """The text of every node; of long operands only dots."""
    texts: dict[int, Text] = {}
    for node in graph.nodes():
        operands = {id(n): texts[id(n)] for n in node.operands}
        texts[id(node)] = show(node, {k: t if len(t.text) <= _LONG else _DOTS for k, t in operands.items()})
    return texts


def _receiver(text: Text) -> str:
    if len(text.text) > _LONG:
        return _DOTS.text
    return text.text if text.strength >= _DOTS.strength else f"({text.text})"


def _route(
    parameters: Iterable[Parameter],
    moved: type[Value],
    text: str,
    way: tuple[str | None, str | None],
    kind: Kind,
) -> str | None:
    """How a declared pose or rotation takes a vector from one frame to the other."""
    free = kind in (Kind.FREE, Kind.DIFFERENCE, Kind.TANGENT)
    for p in parameters:
        pose, rotation = issubclass(p.manifold, Pose | Similarity), issubclass(p.manifold, Rotation)
        form: Any = p.manifold.form
        space = form.rotation.space if pose else form.space if rotation else 0
        if p.frames is None or not issubclass(moved, Vector) or moved.form.dim != space:
            continue
        turn, moves = f"{p.name}.rotation" if pose else p.name, pose and not free
        if p.frames.names == way[::-1]:
            return f"{p.name}.transform_from({text})" if moves else f"{turn} @ {text}"
        if p.frames.names == way:
            return f"{p.name}.transform_to({text})" if moves else f"{turn}.unrotate({text})"
    return None


def _check_call(call: Call, values: Mapping[int, Framed], solver: Solver, graph: Graph) -> None:
    """What is given to a factor with declared frames has frames that fit together as they do there."""
    scope: dict[str, Frame] = {}
    for a in call.arguments:
        if a.frames is None or id(a.node) not in values:  # a constant, or not used
            continue
        wanted = [scope.setdefault(name, Sought(untyped=False)) for name in a.frames.names]
        given = values[id(a.node)]
        pairs = [(given.outer, wanted[0], a.frames.names[0])]
        if is_map(a.manifold) and len(wanted) > 1:
            pairs.append((given.inner, wanted[1], a.frames.names[1]))
        for frame, meant, name in pairs:
            if not solver.equal(frame, meant):
                raise DefinitionError(
                    f"{call.site}: {graph.name}: {call.name}: argument {a.name!r} is given with frame "
                    f"{solver.name(frame)} where its {name} is {solver.name(meant)} by the others; {HATCH}"
                )
        kinds = {a.frames.kind, given.kind if solver.declared(given.outer) else Kind.OPEN}
        if kinds == {Kind.POINT, Kind.FREE}:
            raise DefinitionError(
                f"{call.site}: {graph.name}: {call.name}: argument {a.name!r} is a {a.frames.kind.value} "
                f"in {a.frames.names[0]}, it is given a {given.kind.value}; {HATCH}"
            )


def _coincide_at_zero(graph: Graph, values: Mapping[int, Framed], solver: Solver) -> None:
    """A measurement without declared frames has the body frame of what it measures."""
    for node in graph.nodes():
        if node.operation.name == "local" and all(is_map(n.manifold) for n in node.operands):
            measured, predicted = (values[id(n)].inner for n in node.operands)
            if solver.name(measured) is None and solver.name(predicted):
                solver.equal(measured, predicted)


def _report(graph: Graph, values: Mapping[int, Framed], solver: Solver) -> FrameReport:
    arguments: dict[str, tuple[str, ...]] = {}
    columns: dict[str, str] = {}
    for p in graph.parameters:
        x = values[id(p.node)]
        ends = (x.outer, x.inner) if is_map(p.manifold) else (x.outer,)
        names = [solver.name(f) for f in ends]
        known = tuple(name for name in names if name is not None)
        if len(known) == len(names):
            arguments[p.name] = known
        column = solver.said(x.inner)
        if p.variable and column and not issubclass(p.manifold, Calibration):
            columns[p.name] = column
    rows = {name: row for name, node in graph.outputs if (row := _rows(node, values, solver))}
    declared = any(p.frames for p in graph.parameters)
    report = FrameReport(declared, arguments, rows, columns)
    return replace(report, lines=lines(graph, values, report))


def _rows(node: Node, values: Mapping[int, Framed], solver: Solver) -> str | None:
    """The frame of a value's tangent; of stacked vectors the frame of each."""
    parts = list(_parts(node))
    if len(parts) == 1:
        camera = issubclass(node.manifold, Calibration)
        return None if camera else solver.said(values[id(node)].inner)
    said: list[str] = []
    start = 0
    for part in parts:
        end = start + part.manifold.form.dim
        frame = solver.said(values[id(part)].inner)
        if frame:
            said.append(f"{frame} (rows {start}:{end})")
        start = end
    return ", ".join(said) or None


def _parts(node: Node) -> Iterator[Node]:
    if node.operation.name != "stack":
        yield node
        return
    for part in node.operands:
        yield from _parts(part)
