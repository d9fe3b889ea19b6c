"""What a peer is: a library with some of the operations, on liegen's stored numbers."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Places in an array.
Order = NDArray[np.intp]
#: From the arguments of one sample to the blocks that the library offers, by liegen's names.
Evaluate = Callable[[Mapping[str, Array]], Mapping[str, Array]]

#: Rotation first to translation first and back, in the tangent of SE(3).
SWAPPED = (3, 4, 5, 0, 1, 2)


@dataclass(frozen=True)
class Operation:
    """An operation under the name of liegen's function, in the preset whose chart the library has for it."""

    function: str
    preset: str
    evaluate: Evaluate


@dataclass(frozen=True)
class Peer:
    """A library in its version. ``note`` says how it was asked."""

    name: str
    version: str
    note: str
    operations: tuple[Operation, ...]


def doubles(value: Any) -> Array:
    """A result of a library as an array of its own."""
    return np.array(value, dtype=np.float64)


def vector(value: Any) -> Array:
    """The same with one axis."""
    return doubles(value).reshape(-1)


def version_of(distribution: str) -> str:
    """The version of an installed distribution."""
    return importlib.metadata.version(distribution)


def rotation_matrix(q: Array) -> Array:
    """Of the unit quaternion (x, y, z, w)."""
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(R: Array) -> Array:
    """(x, y, z, w) of a rotation matrix, by its largest component (Shepperd 1978)."""
    (a, b, c), (d, e, f), (g, h, i) = R
    rows = np.array(
        [
            [1 + a - e - i, b + d, c + g, h - f],
            [b + d, 1 + e - a - i, f + h, c - g],
            [c + g, f + h, 1 + i - a - e, d - b],
            [h - f, c - g, d - b, 1 + a + e + i],
        ]
    )
    row = rows[int(np.argmax(np.diag(rows)))]
    return row / np.linalg.norm(row)
