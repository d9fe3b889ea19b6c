"""Conditions on values: what comparisons give, and ``where`` and ``require`` take."""

from __future__ import annotations

from typing import Self

from liegen.algebra import call
from liegen.algebra.linear import Vector as Coordinates

from .form import Coords, ManifoldForm
from .node import Operation, Value, apply


class _ConditionForm(ManifoldForm):
    name = "condition"
    storage = ("holds",)
    tangent = ()

    def retract(self, x: Coords, d: Coords) -> Coordinates:
        return tuple(x)

    def local(self, x: Coords, y: Coords) -> Coordinates:
        return ()


class Condition(Value):
    """True or false, for each element of a batch. Combine with ``&``, ``|``, ``~``."""

    __slots__ = ()
    form = _ConditionForm()

    def __and__(self, other: Condition) -> Condition:
        return apply(_logic("and", "({0} & {1})"), Condition, self, other)

    def __or__(self, other: Condition) -> Condition:
        return apply(_logic("or", "({0} | {1})"), Condition, self, other)

    def __invert__(self) -> Self:
        return apply(_logic("not", "~{0}"), type(self), self)


def _logic(name: str, show: str) -> Operation:
    def value(*operands: Coordinates) -> Coordinates:
        return (call(name, *(c[0] for c in operands)),)

    return Operation(name, Condition, value, None, show)
