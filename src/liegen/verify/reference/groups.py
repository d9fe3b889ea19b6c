"""Operations on elements of groups and manifolds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import extended, galilean, similarity
from .calls import Call, Rule, plain
from .charts import space_in
from .matrix import Element, Matrix, Vector, add, matvec, normalised, sub, transpose
from .spaces import GroupSpace, Space, group_of, pose, rotation_of, space_of, translation_of


def _group(call: Call) -> GroupSpace:
    return group_of(call.operands[0].manifold)


def _compose(call: Call) -> Element:
    return _group(call).compose(*call.values)


def _inverse(call: Call) -> Element:
    return _group(call).inverse(*call.values)


def _between(call: Call) -> Element:
    group, (a, b) = _group(call), call.values
    return group.compose(group.inverse(a), b)


def exp(call: Call) -> Element:
    """The exponential of the result's group."""
    return group_of(call.operation.result).exp(call.values[0])


def log(call: Call) -> Vector:
    """The logarithm of the operand's group."""
    return _group(call).log(call.values[0], call.branch)


def _space(call: Call) -> Space:
    """The operand's manifold, in the chart that the operation carries."""
    manifold = call.operands[0].manifold
    return space_in(manifold, *call.operation.parameters) if call.operation.parameters else space_of(manifold)


def _retract(call: Call) -> Element:
    x, d = call.values
    return _space(call).retract(x, d, call.branch)


def _local(call: Call) -> Vector:
    x, y = call.values
    return _space(call).local(x, y, call.branch)


def _direction(call: Call) -> Element:
    """The unit vector; for the plane the rotation that turns the x axis to it."""
    unit: Any = normalised(*call.values)
    return unit if len(unit) == 3 else ((unit[0], -unit[1]), (unit[1], unit[0]))


def _transform_from(T: Matrix, p: Vector) -> Vector:
    return add(matvec(rotation_of(T), p), translation_of(T))


def _transform_to(call: Call) -> Vector:
    T, p = call.values
    if _scaled(call):
        return similarity.act_inverse(T, p)
    return matvec(transpose(rotation_of(T)), sub(p, translation_of(T)))


def _scaled(call: Call) -> bool:
    return call.operands[0].manifold.form.name in ("Sim2", "Sim3")


def _unrotate(R: Matrix, v: Vector) -> Vector:
    return matvec(transpose(R), v)


def _rotation(call: Call) -> Matrix:
    """The rotation: 2 x 2 of a pose of the plane, 3 x 3 of all other matrices."""
    (T,) = call.values
    if _scaled(call):
        return similarity.rotation_of(T)
    return rotation_of(T) if len(T) < 5 else extended.rotation_of(T)


def _column(name: str) -> Rule:
    return lambda call: extended.column_of(
        call.values[0], _COLUMNS[name, call.operands[0].manifold.form.name]
    )


def _pose_of(call: Call) -> Matrix:
    return pose(_rotation(call), _column("position")(call))


#: Where a vector stands in the 5 x 5 matrices.
_COLUMNS: Mapping[tuple[str, str], int] = {
    ("position", "SE23"): 3,
    ("velocity", "SE23"): 4,
    ("position", "NavState"): 3,
    ("velocity", "NavState"): 4,
    ("position", "Gal3"): 4,
    ("velocity", "Gal3"): 3,
}

OPERATIONS: Mapping[str, Rule] = {
    "compose": _compose,
    "inverse": _inverse,
    "between": _between,
    "retract": _retract,
    "local": _local,
    "direction": _direction,
    "vector": lambda call: call.values[0],
    "rotate": plain(matvec),
    "unrotate": plain(_unrotate),
    "pose": plain(pose),
    "rotation": _rotation,
    "part": lambda call: call.values[0][call.operation.parameters[0]],
    "product": lambda call: tuple(call.values),
    "extended_pose": plain(extended.extended),
    "event": plain(galilean.event),
    "time": lambda call: (call.values[0][3][4],),
    "pose_of": _pose_of,
    "position": _column("position"),
    "velocity": _column("velocity"),
    "translation": plain(translation_of),
    "transform_from": plain(_transform_from),
    "transform_to": _transform_to,
    "similarity": plain(similarity.similar),
    "scale": lambda call: (similarity.scale_of(call.values[0]),),
}
