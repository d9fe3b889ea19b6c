"""Where an operation has no derivative, has none that is continuous, or switches: what is to be solved for.

A row of :data:`PLACES` for each operation with such points. A new operation that has some needs a row here,
and its cure in :mod:`liegen.verify.singular.cures`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from liegen.algebra import linear
from liegen.manifolds import ManifoldForm, Node
from liegen.manifolds.form import GroupForm
from liegen.trace import Graph, topological

from ..reference.calls import is_elementwise
from ..sphere_slack import has_sphere

Coords = Sequence[Any]
#: What vanishes at the point, from the coordinates of the result and of the operands.
Gap = Callable[[Coords, Sequence[Coords]], Coords]

Turn = Callable[[Coords], Coords]

#: Points of one formula that are solved for: those of large unrolled sums are alike.
POINTS = 24


@dataclass(frozen=True)
class Place:
    """A kind of singular point: ``where`` has a place for the text of each operand.

    ``either``: which of two values it is there is decided by rounding.
    """

    where: str
    gap: Gap
    either: bool = False


@dataclass(frozen=True, eq=False)
class Point:
    """A place of one node of a graph."""

    node: Node
    place: Place


def points_of(graph: Graph) -> tuple[Point, ...]:
    """The singular points of the operations that the outputs need, one line of the user's after the other.

    Where there are more than :data:`POINTS` those of every line come before second ones of the same line.
    """
    nodes = topological([node for _, node in graph.outputs])
    switches = {id(n) for n in topological([n.operands[0] for n in nodes if n.operation.name == "where"])}
    found: list[tuple[int, Point]] = []
    seen: dict[tuple[str, str], int] = {}
    for node in nodes:
        for place in _places(node, is_switch=id(node) in switches):
            key = (str(node.site), place.where)
            seen[key] = seen.get(key, 0) + 1
            found.append((seen[key], Point(node, place)))
    found.sort(key=lambda entry: entry[0])
    return tuple(point for _, point in found[:POINTS])


def _places(node: Node, *, is_switch: bool) -> Iterator[Place]:
    name = node.operation.name
    if name in ("lt", "le") and is_switch:
        yield Place("{0} equals {1}", lambda _, x: (x[0][0] - x[1][0],), either=True)
    if name in PLACES and (name != "log" or is_elementwise(node.operation)):
        yield from PLACES[name](node)
    elif name in _LOGARITHMS:
        yield from _LOGARITHMS[name](node)


def _of_entries(where: str, operand: int, value: float = 0.0) -> Callable[[Node], Iterator[Place]]:
    """Each entry of an operand at a value."""

    def places(node: Node) -> Iterator[Place]:
        size = node.operands[operand].manifold.form.dim
        for k in range(size):
            shown = where.replace(f"{{{operand}}}", f"{{{operand}}}[{k}]") if size > 1 else where
            yield Place(shown, _entry(operand, k, value))

    return places


def _of_both(where: str) -> Callable[[Node], Iterator[Place]]:
    """Each entry of two operands, of which one may be a scalar."""

    def places(node: Node) -> Iterator[Place]:
        a, b = (n.manifold.form.dim for n in node.operands)
        for k in range(max(a, b)):
            i, j = (k if size > 1 else 0 for size in (a, b))
            shown = where.format(*(f"{{{n}}}[{k}]" if s > 1 else f"{{{n}}}" for n, s in enumerate((a, b))))
            yield Place(shown, _pair(i, j))

    return places


def _whole(where: str) -> Callable[[Node], Iterator[Place]]:
    """All entries of the operand at 0."""
    return lambda _: iter([Place(where, lambda _, x: x[0])])


def _of_units(node: Node) -> Iterator[Place]:
    for end in (1, -1):
        yield from _of_entries(f"{{0}} is {end}", 0, end)(node)


PLACES: Mapping[str, Callable[[Node], Iterator[Place]]] = {
    "sqrt": _of_entries("{0} is 0", 0),
    "log": _of_entries("{0} is 0", 0),
    "div": _of_entries("{1} is 0", 1),
    "acos": _of_units,
    "asin": _of_units,
    "norm": _whole("{0} is 0"),
    "direction": _whole("{0} is 0"),
    "atan2": _of_both("{0} and {1} are 0"),
}


def _of_logarithm(node: Node) -> Iterator[Place]:
    form = node.operands[0].manifold.form
    if form.flat:
        return
    yield Place("{0} is the identity", lambda r, _: r)
    if isinstance(form, GroupForm):
        for turn in _half_turns(form):
            yield Place("{0} is half a turn", _turned(turn), either=True)


def _of_local(node: Node) -> Iterator[Place]:
    form = node.operands[0].manifold.form
    if form.flat:
        return
    yield Place("{0} equals {1}", lambda r, _: r)
    if has_sphere(form):
        if form.name == "S2":
            yield Place("{0} and {1} are opposite", lambda _, x: linear.add(x[0], x[1]), either=True)
    elif isinstance(form, GroupForm) and not node.operation.parameters:
        for turn in _half_turns(form):
            yield Place(
                "{0} and {1} are half a turn apart",
                _turned(turn, form.between),
                either=True,
            )


def _entry(operand: int, k: int, value: float) -> Gap:
    return lambda _, x: (x[operand][k] - value,)


def _pair(i: int, j: int) -> Gap:
    return lambda _, x: (x[0][i], x[1][j])


def _turned(turn: Turn, element: Callable[[Coords, Coords], Coords] | None = None) -> Gap:
    """Of an operand, or of the one as seen from the other."""
    return lambda _, x: turn(x[0] if element is None else element(x[0], x[1]))


def _half_turns(form: ManifoldForm) -> Iterator[Turn]:
    """What vanishes where a rotation of an element is by half a turn."""
    yield from map(_real_part, form.quaternions)
    if form.storage[:2] == ("c", "s"):
        yield lambda c: (c[0] + 1, c[1])


def _real_part(start: int) -> Turn:
    return lambda c: (c[start + 3],)


_LOGARITHMS: Mapping[str, Callable[[Node], Iterator[Place]]] = {"log": _of_logarithm, "local": _of_local}
