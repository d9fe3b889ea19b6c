"""A known difference between a foreign output and the formula's, and what it is asked about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds.group import as_array
from liegen.trace import Parameter

from ..points import AnyFunction, Sampled

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Subject:
    """Output ``k`` of a function at its samples: the residual (``variable`` is None) or a Jacobian."""

    function: AnyFunction
    sampled: Sampled
    k: int
    variable: Parameter | None

    @property
    def expected(self) -> Array:
        """The formula's, (P, m, n); the residual as one column."""
        array = self.sampled.expected[self.k]
        return array[..., None] if self.variable is None else array

    @property
    def found(self) -> Array:
        """The foreign function's, (S, m, n)."""
        array = self.sampled.found[self.k]
        return array[..., None] if self.variable is None else array


@dataclass(frozen=True)
class Difference:
    """The output is ``left @ expected @ right``, or ``base`` in place of the expected one.

    Each is an array of matrices, one for each point, or None. ``kind``: of each kind an explanation has at
    most one. ``size``: an explanation of smaller size is preferred. ``phrases`` say it in words, ``same`` are
    other words for as much; ``charts`` are the charts that have it.
    """

    kind: str
    phrases: tuple[str, ...]
    size: float
    left: Array | None = None
    right: Array | None = None
    base: Array | None = None
    charts: tuple[str, ...] = ()
    same: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The phrases in one line."""
        return "; ".join(self.phrases)

    def at(self, points: NDArray[np.intp]) -> Difference:
        """The same at some of the points."""
        left, right, base = (None if a is None else a[points] for a in (self.left, self.right, self.base))
        return replace(self, left=left, right=right, base=base)


def matrices(matrix: Any, points: int) -> Array:
    """A matrix of scalars or of arrays (P,) as (P, rows, columns)."""
    array = np.asarray(as_array(matrix), dtype=np.float64)
    return np.broadcast_to(array, (points, *array.shape[-2:]))


def constant(matrix: Sequence[Sequence[float]] | Array, points: int) -> Array:
    """The same matrix at every point."""
    array = np.asarray(matrix, dtype=np.float64)
    return np.broadcast_to(array, (points, *array.shape))


def applied(differences: Sequence[Difference], expected: Array) -> Array:
    """The output that the differences make of the expected one."""
    array = next((d.base for d in differences if d.base is not None), expected)
    for d in differences:
        if d.left is not None:
            array = d.left @ array
        if d.right is not None:
            array = array @ d.right
    return array
