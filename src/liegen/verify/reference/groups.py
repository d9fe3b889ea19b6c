"""Operations on elements of groups and manifolds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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


def _transform_to(T: Matrix, p: Vector) -> Vector:
    return matvec(transpose(rotation_of(T)), sub(p, translation_of(T)))


def _unrotate(R: Matrix, v: Vector) -> Vector:
    return matvec(transpose(R), v)


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
    "rotation": plain(rotation_of),
    "translation": plain(translation_of),
    "transform_from": plain(_transform_from),
    "transform_to": plain(_transform_to),
}
