"""A call of an operation, and what the files of operations share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .logarithms import Branch
from .matrix import Element, Number, Vector, mp

if TYPE_CHECKING:
    from liegen.manifolds import Node, Operation


@dataclass(frozen=True)
class Call:
    """An operation on values. ``branch.near`` is the result to stay near to."""

    operation: Operation
    operands: Sequence[Node]
    values: Sequence[Element]
    branch: Branch


#: Computes the result of a call.
Rule = Callable[[Call], Element]


def is_elementwise(operation: Operation) -> bool:
    """Tells ``exp(v)`` and ``log(v)`` of every entry from a group's ``SE3.exp(v)`` and ``x.log()``."""
    return operation.show == operation.name + "({0})"


def plain(function: Callable[..., Element]) -> Rule:
    """A rule that needs the values only."""
    return lambda call: function(*call.values)


def real(function: Callable[..., Number]) -> Callable[..., Number]:
    """``function`` with NaN where it has no real value, instead of an exception or a complex number."""

    def value(*numbers: Number) -> Number:
        try:
            result = function(*numbers)
        except (ZeroDivisionError, ValueError, OverflowError):
            return mp.nan
        return result if isinstance(result, mp.mpf) else mp.nan

    return value


def broadcast(vectors: Sequence[Vector]) -> list[Vector]:
    """Entries side by side; a vector of one entry fits any length."""
    n = max(len(v) for v in vectors)
    return [tuple(v[k if len(v) > 1 else 0] for v in vectors) for k in range(n)]


def elementwise(function: Callable[..., Number]) -> Rule:
    """A rule that applies a function of numbers to every entry."""
    guarded = real(function)
    return lambda call: tuple(guarded(*entry) for entry in broadcast(call.values))
