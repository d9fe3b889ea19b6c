"""What each operation asks of the frames of its operands, and the frames of its result: a rule per name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NoReturn

from liegen.manifolds import S2, Calibration, Node, Vector
from liegen.manifolds.pose import Pose
from liegen.manifolds.rotation import Rotation
from liegen.manifolds.similarity import Similarity

from .frame_names import Kind, is_map
from .frame_step import Step
from .frame_terms import Framed, Sought, common, mapping, sought, vector

_FREE = (Kind.FREE, Kind.DIFFERENCE)
Rule = Callable[[Step], Framed]


def _compose(s: Step) -> Framed:
    a, b = s.operands
    moves = s.node.operands[1].operation.name == "exp"  # a tangent at the other side
    s.need(
        (0, "inner"), (1, "outer"),
        *([((0, "outer"), (1, "outer"), "{1} @ {0}")] if moves else []),
        ((0, "inner"), (1, "inner"), "{0} @ {1}.inverse()"),
        ((0, "outer"), (1, "outer"), "{0}.inverse() @ {1}"),
        ((0, "outer"), (1, "inner"), "{1} @ {0}"),
    )  # fmt: skip
    return mapping(a.outer, b.inner)


def _inverse(s: Step) -> Framed:
    return mapping(s.operands[0].inner, s.operands[0].outer)


def _same_outer(s: Step) -> None:
    name = s.node.operation.name
    s.need(
        (0, "outer"), (1, "outer"),
        ((0, "outer"), (1, "inner"), f"{{0}}.{name}({{1}}.inverse())"),
        ((0, "inner"), (1, "outer"), f"{{0}}.inverse().{name}({{1}})"),
        ((0, "inner"), (1, "inner"), f"{{0}}.inverse().{name}({{1}}.inverse())"),
    )  # fmt: skip


def _between(s: Step) -> Framed:
    _same_outer(s)
    return mapping(s.operands[0].inner, s.operands[1].inner)


def _local(s: Step) -> Framed:
    """Both in one outer frame; the tangent lives in the body frame of the first."""
    _same_outer(s)
    return vector(s.operands[0].inner, Kind.TANGENT)


def _retract(s: Step) -> Framed:
    made = s.node.manifold.__name__
    s.need((0, "body"), (1, "frame"), ((0, "outer"), (1, "frame"), f"{made}.exp({{1}}) @ {{0}}"))
    return mapping(s.operands[0].outer, Sought())


def _exp(s: Step) -> Framed:
    return mapping(s.operands[0].outer, Sought())


def _log(s: Step) -> Framed:
    """Log(a) is the tangent at the identity of a's outer frame that leads to a."""
    return vector(s.operands[0].outer, Kind.TANGENT)


def _rotation(s: Step) -> Framed:
    return s.operands[0]


def _translation(s: Step) -> Framed:
    return vector(s.operands[0].outer, Kind.POINT)


def _pose(s: Step) -> Framed:
    made = s.node.manifold.__name__
    s.need((0, "outer"), (1, "frame"), ((0, "inner"), (1, "frame"), f"{made}({{0}}, {{0}} @ {{1}})"))
    return s.operands[0]


def _transform_from(s: Step) -> Framed:
    s.need((0, "inner"), (1, "frame"), ((0, "outer"), (1, "frame"), "{0}.transform_to({1})"))
    _moves_points(s, "{0}.rotation @ {1}")
    return vector(s.operands[0].outer, Kind.POINT)


def _transform_to(s: Step) -> Framed:
    s.need((0, "outer"), (1, "frame"), ((0, "inner"), (1, "frame"), "{0}.transform_from({1})"))
    _moves_points(s, "{0}.rotation.unrotate({1})")
    return vector(s.operands[0].inner, Kind.POINT)


def _moves_points(s: Step, repair: str) -> None:
    if s.kind(1) in _FREE:
        s.refuse(
            f"{s.texts[1]} is a free vector in {s.solver.name(s.operands[1].outer)}, "
            f"which translations do not move; {s.cure(repair)}"
        )


def _rotate(s: Step) -> Framed:
    s.need((0, "inner"), (1, "frame"), ((0, "outer"), (1, "frame"), "{0}.unrotate({1})"))
    return vector(s.operands[0].outer, _turned(s.kind(1)))


def _unrotate(s: Step) -> Framed:
    s.need((0, "outer"), (1, "frame"), ((0, "inner"), (1, "frame"), "{0} @ {1}"))
    return vector(s.operands[0].inner, _turned(s.kind(1)))


def _turned(kind: Kind) -> Kind:
    """A point counts as the vector from its frame's origin; R^T (p - t) may be a point again."""
    return Kind.OPEN if kind in (Kind.DIFFERENCE, Kind.OPEN) else Kind.FREE


def _one_frame(s: Step) -> Framed:
    """Vectors in one frame; scalars fit anywhere. The first of them."""
    dim = s.node.manifold.form.dim
    dims = [n.manifold.form.dim for n in s.node.operands]
    wide = max((n for n in dims if n), default=dim)
    places = [k for k, n in enumerate(dims) if n == wide]
    if wide == 1:  # angles and other numbers
        known = (x for x in s.operands if s.solver.name(x.outer))
        return next(known, s.operands[places[0]])
    for k in places[1:]:
        first, other = s.operands[places[0]], s.operands[k]
        if not s.solver.equal(first.outer, other.outer):
            _differ(s, places[0], k)
    return s.operands[places[0]]


def _differ(s: Step, i: int, k: int) -> NoReturn:
    (a, b), (x, y) = (s.operands[i], s.operands[k]), (s.texts[i], s.texts[k])
    ways = (s.route(k, b.kind, a.outer), s.route(i, a.kind, b.outer))
    # rather an argument than what was computed
    route = next(filter(None, ways if not s.node.operands[k].operands else ways[::-1]), None)
    cure = f"write {route}" if route else s.cure(None)
    s.refuse(f"{x} is in {s.solver.name(a.outer)}, {y} is in {s.solver.name(b.outer)}; {cure}")


def _add(s: Step) -> Framed:
    x = _one_frame(s)
    a, b = s.kind(0), s.kind(1)
    if _scalar_with_vector(s) or Kind.OPEN in (a, b):
        return vector(x.outer, Kind.OPEN)
    points = (a, b).count(Kind.POINT)
    return vector(x.outer, (_both(a, b), Kind.POINT, Kind.OPEN)[points])


def _sub(s: Step) -> Framed:
    x = _one_frame(s)
    return _minus(s, x, 0, 1)


def _minus(s: Step, x: Framed, i: int, j: int) -> Framed:
    """Operand i minus operand j."""
    a, b = s.kind(i), s.kind(j)
    if _scalar_with_vector(s) or Kind.OPEN in (a, b):
        return vector(x.outer, Kind.OPEN)
    if b is Kind.POINT and a in _FREE:
        s.refuse(
            f"{s.texts[i]} is a free vector and {s.texts[j]} a point, both in {s.solver.name(x.outer)}: "
            "their difference is neither; move points with a pose (a rotation alone gives the vector from "
            "the origin), subtract the other way round, or give a point a name such as p_W"
        )
    if b is Kind.POINT:
        return vector(x.outer, Kind.DIFFERENCE if a is Kind.POINT else Kind.OPEN)
    return vector(x.outer, Kind.POINT if a is Kind.POINT else _both(a, b))


def _both(a: Kind, b: Kind) -> Kind:
    return a if a is b else Kind.FREE


def _scalar_with_vector(s: Step) -> bool:
    dims = {n.manifold.form.dim for n in s.node.operands}
    return len(dims) > 1


def _scaled(s: Step) -> Framed:
    """A multiple of a point is none; a multiple of a free vector is one."""
    x = _one_frame(s)
    wide = [k for k, n in enumerate(s.node.operands) if n.manifold.form.dim == s.node.manifold.form.dim]
    divides = s.node.operation.name == "div" and wide[-1] == 1
    kind = s.kind(wide[0]) if len(wide) == 1 and not divides else Kind.OPEN
    return vector(x.outer, Kind.OPEN if kind is Kind.POINT else kind)


def _choice(s: Step) -> Framed:
    x = _one_frame(s)
    kinds = [s.kind(k) for k, n in enumerate(s.node.operands) if n.manifold.form.dim]
    return vector(x.outer, common(kinds))


def _cross(s: Step) -> Framed:
    x = _one_frame(s)
    return vector(x.outer, Kind.OPEN if Kind.OPEN in (s.kind(0), s.kind(1)) else Kind.FREE)


def _number(s: Step) -> Framed:
    _one_frame(s)
    return sought(is_map=False)


def _nothing(s: Step) -> Framed:
    return sought(is_map=is_map(s.node.manifold))


def _take(s: Step) -> Framed:
    """A part of a vector in a known frame is in that frame; single entries are numbers."""
    x, few = s.operands[0], s.node.manifold.form.dim == 1
    if few or s.solver.name(x.outer) is None:
        return sought(is_map=False)
    return vector(x.outer, Kind.FREE if x.kind is Kind.TANGENT else x.kind)


def _stack(s: Step) -> Framed:
    """Vectors of one declared frame keep it, as in a twist; anything else is in none."""
    names = {s.solver.name(x.outer) if s.solver.declared(x.outer) else None for x in s.operands}
    if len(names) > 1 or None in names or any(n.manifold.form.dim == 1 for n in s.node.operands):
        return sought(is_map=False)
    return vector(s.operands[0].outer, Kind.OPEN)


def _direction(s: Step) -> Framed:
    frame = s.operands[0].outer
    return mapping(frame, Sought()) if is_map(s.node.manifold) else vector(frame, Kind.FREE)


def _unit_vector(s: Step) -> Framed:
    return vector(s.operands[0].outer, Kind.FREE)


def _distort(s: Step) -> Framed:
    s.need((0, "inner"), (1, "frame"))
    return vector(s.operands[1].outer, Kind.OPEN)


def _uncalibrate(s: Step) -> Framed:
    s.need((0, "inner"), (1, "frame"))
    return vector(s.operands[0].outer, Kind.POINT)


def _same_frame_tangent(s: Step) -> Framed:
    """On the sphere: the tangent basis at the first direction, in the frame of both."""
    return vector(_one_frame(s).outer, Kind.TANGENT)


def _first(s: Step) -> Framed:
    return s.operands[0]


def _negative(s: Step) -> Framed:
    x = s.operands[0]
    return vector(x.outer, Kind.OPEN if x.kind is Kind.POINT else x.kind)


def _reversed_sub(s: Step) -> Framed:
    """other - self."""
    return _minus(s, _one_frame(s), 1, 0)


_MAPS: Mapping[str, Rule] = {
    "compose": _compose, "inverse": _inverse, "between": _between, "local": _local, "retract": _retract,
    "exp": _exp, "log": _log, "rotation": _rotation, "translation": _translation, "pose": _pose,
    "transform_from": _transform_from, "transform_to": _transform_to, "rotate": _rotate,
    "unrotate": _unrotate, "direction": _direction, "similarity": _pose, "scale": _nothing,
}  # fmt: skip
_VECTORS: Mapping[str, Rule] = {
    "compose": _add, "inverse": _negative, "between": _reversed_sub, "local": _reversed_sub, "retract": _add,
    "add": _add, "sub": _sub, "neg": _negative, "mul": _scaled, "div": _scaled, "dot": _number,
    "norm": _number, "cross": _cross, "minimum": _choice, "maximum": _choice, "where": _choice, "take": _take,
    "stack": _stack,
}  # fmt: skip
_DIRECTIONS: Mapping[str, Rule] = {
    "direction": _direction, "vector": _unit_vector, "local": _same_frame_tangent, "retract": _first
}  # fmt: skip
_CAMERAS: Mapping[str, Rule] = {"distort": _distort, "uncalibrate": _uncalibrate}


def rule(node: Node) -> Rule:
    """The rule of a node's operation; operations without one tell nothing of frames."""
    name, result = node.operation.name, node.manifold
    acts = name in ("exp", "pose", "similarity", "direction") and not issubclass(result, Vector)
    subject = result if acts else node.operands[0].manifold
    families = ((S2, _DIRECTIONS), (Calibration, _CAMERAS), ((Pose, Rotation, Similarity), _MAPS))
    table = next((rules for base, rules in families if issubclass(subject, base)), _VECTORS)
    # R3.exp, the identity, is shown with its class; exp(v) of every entry is not
    if table is _VECTORS and name == "exp" and not node.operation.show.startswith("exp"):
        return _first
    return table.get(name, _nothing)
