"""What each operation asks of the frames of its operands, and the frames of its result: a rule per name."""

from __future__ import annotations

from collections.abc import Mapping

from liegen.manifolds import S2, Calibration, Node, Product, Vector

from .frame_declared import as_written, is_map, parts
from .frame_fit import misfit
from .frame_names import Kind
from .frame_products import unknown
from .frame_step import HATCH, Step
from .frame_terms import Frame, Framed, Sought, made_of, mapping, vector
from .frame_vectors import FREE, VECTORS, Rule, first, one_frame


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


def _velocity(s: Step) -> Framed:
    return vector(s.operands[0].outer, Kind.FREE)


def _pose(s: Step) -> Framed:
    """A rotation and vectors in its outer frame: a position, then perhaps a velocity."""
    made, given = s.node.manifold.__name__, range(len(s.operands))
    for k, _ in enumerate(s.operands[1:], start=1):
        if s.node.operands[k].manifold.form.dim == 1:  # the time, the scale
            continue
        turned = ", ".join(f"{{0}} @ {{{i}}}" if i == k else f"{{{i}}}" for i in given)
        s.need((0, "outer"), (k, "frame"), ((0, "inner"), (k, "frame"), f"{made}({turned})"))
        if k == 2 and s.kind(k) is Kind.POINT:
            s.refuse(
                f"{s.texts[k]} is a point in {s.solver.name(s.operands[k].outer)}, but the third argument is "
                f"the velocity, a free vector: {made}(rotation, position, velocity)"
            )
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
    if s.kind(1) in FREE:
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


def _nothing(s: Step) -> Framed:
    return unknown(s.node.manifold)


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
    return vector(one_frame(s).outer, Kind.TANGENT)


def _part(s: Step) -> Framed:
    k: int = s.node.operation.parameters[0]
    return s.operands[0].parts[k].value


def _product(s: Step) -> Framed:
    """Parts whose frames fit together as the class names them."""
    scope: dict[str, Frame] = {}
    made = s.node.manifold
    assert issubclass(made, Product)
    listed = list(parts(made, as_written(made)))
    for k, (name, kind, stated) in enumerate(listed):
        why = misfit(
            name, kind, stated, s.operands[k], s.solver, lambda n: scope.setdefault(n, Sought(untyped=False))
        )
        if why:
            s.refuse(f"part {why}; {HATCH}")
    return made_of(s.operands, [kind.form.dim for _, kind, _ in listed])


_MAPS: Mapping[str, Rule] = {
    "compose": _compose, "inverse": _inverse, "between": _between, "local": _local, "retract": _retract,
    "exp": _exp, "log": _log, "rotation": _rotation, "translation": _translation, "pose": _pose,
    "transform_from": _transform_from, "transform_to": _transform_to, "rotate": _rotate,
    "unrotate": _unrotate, "direction": _direction, "pose_of": _rotation, "position": _translation,
    "velocity": _velocity, "extended_pose": _pose, "event": _pose,
    "similarity": _pose, "scale": _nothing,
}  # fmt: skip
_DIRECTIONS: Mapping[str, Rule] = {
    "direction": _direction, "vector": _unit_vector, "local": _same_frame_tangent, "retract": first
}  # fmt: skip
_CAMERAS: Mapping[str, Rule] = {"distort": _distort, "uncalibrate": _uncalibrate}
_PRODUCTS: Mapping[str, Rule] = {"part": _part, "product": _product}
#: The rules of each class's operations. Of the rest, maps share one table, vectors another.
_TABLES = ((S2, _DIRECTIONS), (Calibration, _CAMERAS), (Product, _PRODUCTS))
#: Operations whose rule is that of what they make; all others have that of what they are applied to.
_MAKE = ("exp", "pose", "direction", "product", "extended_pose", "event", "similarity")


def rule(node: Node) -> Rule:
    """The rule of a node's operation; operations without one tell nothing of frames."""
    name, result = node.operation.name, node.manifold
    makes = name in _MAKE and not issubclass(result, Vector)
    subject = result if makes else node.operands[0].manifold
    table = next((rules for base, rules in _TABLES if issubclass(subject, base)), None)
    table = table or (_MAPS if is_map(subject) else VECTORS)
    # R3.exp(v) and v.log() are the identity, exp(v) and log(v) functions of every entry
    if table is VECTORS and name in ("exp", "log") and not node.operation.show.startswith(f"{name}("):
        return first
    return table.get(name, _nothing)
