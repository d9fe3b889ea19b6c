"""Parts of a value: an attribute that reads a slice of the storage, with its Jacobian."""

from __future__ import annotations

from typing import Any

from liegen.algebra.linear import Vector as Coordinates

from .form import Coords, Rule
from .node import Operation, V, Value, apply


def part(
    x: Value,
    name: str,
    result: type[V],
    stored: slice,
    blocks: Rule,
    operation: str = "",
    parameters: tuple[Any, ...] = (),
) -> V:
    """The part ``x.name``: the numbers ``stored`` of the storage as a ``result``.

    ``operation`` is the operation's name where it differs from the attribute's.
    """

    def value(coords: Coords) -> Coordinates:
        return tuple(coords[stored])

    return apply(Operation(operation or name, result, value, blocks, f"{{0}}.{name}", parameters), result, x)
