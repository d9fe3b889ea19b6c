"""The points at which a foreign function is held against a formula: arguments and what the formula gives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.define import Function
from liegen.manifolds import Manifold, Value

Array = NDArray[np.float64]
AnyFunction = Function[..., Any]
Values = Mapping[str, Value]
#: How far a nudged point is, and from which relative difference on there is a jump between.
NUDGE, JUMP = 1e-9, 1e-5


def every(mask: Any) -> NDArray[np.bool_]:
    """For each point, or sample, whether all of its entries are true."""
    array: Any = np.asarray(mask).reshape(len(mask), -1)
    return np.asarray(array.all(axis=1), dtype=bool)


def batch(values: Sequence[Values]) -> dict[str, Value]:
    """Values of many points as one value for each argument, whose scalars are arrays."""
    stacked: dict[str, Value] = {}
    for name, first in values[0].items():
        coords = np.array([[float(c) for c in v[name].coords] for v in values]).T
        stacked[name] = type(first).holding([*coords])
    return stacked


def columns_of(scalars: Sequence[Any], points: int) -> Array:
    """Scalars, each a number or an array (P,), as the columns of an array (P, n)."""
    return np.stack([np.broadcast_to(np.asarray(c, dtype=np.float64), points) for c in scalars], axis=-1)


def some(values: Values, chosen: NDArray[Any]) -> dict[str, Value]:
    """The values of some points of a batch, by their indices or by a mask."""
    points = size_of(values)
    return {
        name: type(v).holding([np.broadcast_to(c, points)[chosen] for c in v.coords])
        for name, v in values.items()
    }


def at(values: Values, k: int) -> dict[str, Value]:
    """The values of point k of a batch."""
    scalars = {n: [np.float64(c[k] if np.ndim(c) else c) for c in v.coords] for n, v in values.items()}
    return {name: type(v).holding(scalars[name]) for name, v in values.items()}


def nudged(values: Values, seed: int) -> dict[str, Value]:
    """Every argument of every point moved by a random step that is far below the tolerance."""
    generator = np.random.default_rng(seed)
    moved: dict[str, Value] = {}
    for name, v in values.items():
        if isinstance(v, Manifold) and v.form.dim:
            steps = generator.normal(size=(size_of(values), v.form.dim))
            moved[name] = v.retract(NUDGE * steps / np.linalg.norm(steps, axis=1, keepdims=True))
        else:
            moved[name] = v
    return moved


def stable(outputs: Sequence[Array], others: Sequence[Sequence[Array]]) -> tuple[Array, ...]:
    """The outputs, NaN at the points near which they jump: ``others`` are those of nudged arguments."""
    result: list[Array] = []
    for k, array in enumerate(outputs):
        axes = tuple(range(1, array.ndim))
        with np.errstate(all="ignore"):
            scale = np.maximum(1.0, np.abs(array).max(axis=axes, initial=0.0))
            change = [np.abs(other[k] - array).max(axis=axes, initial=0.0) for other in others]
            steady = np.all([c <= JUMP * scale for c in change], axis=0)
        result.append(np.where(steady.reshape(-1, *(1 for _ in axes)), array, np.nan))
    return tuple(result)


def size_of(values: Values) -> int:
    """How many points a batch has."""
    return max((np.size(c) for v in values.values() for c in v.coords), default=1)


def evaluated(function: AnyFunction, values: Values) -> tuple[Array, ...]:
    """The output (P, m) and the Jacobian (P, m, n) by each variable at P points.

    NaN where the formula has no value, or where a condition that the factor requires does not hold.
    """
    stored = {p.name: p.storage.write(values[p.name].coords) for p in function.graph.parameters}
    program, points = function.kernel.jacobians, size_of(values)
    with np.errstate(all="ignore"):
        results: Any = program.evaluate(stored)
        inside = np.ones(points, dtype=bool)
        for condition in results["status"]:
            inside &= np.broadcast_to(np.asarray(condition, dtype=bool), points)
        arrays: list[Array] = []
        for k, port in enumerate(program.outputs):
            flat = np.where(inside[:, None], columns_of(results[port.name], points), np.nan)
            arrays.append(flat if k == 0 else flat.reshape(points, *port.shape))
    return tuple(arrays)


def arguments(function: AnyFunction, values: Values, *, own: bool) -> list[list[Array]]:
    """The stored numbers that a foreign function gets, for each point, in the formula's order.

    ``own``: in liegen's own layout.
    """
    points = size_of(values)
    columns: list[Array] = []
    for p in function.graph.parameters:
        coords = values[p.name].coords
        scalars = coords if own else p.storage.write(coords)
        flat = columns_of(scalars, points)
        shape = (flat.shape[-1],) if own else p.storage.shape or (p.storage.size,)
        columns.append(flat.reshape(points, *shape))
    return [[np.array(column[k]) for column in columns] for k in range(points)]


@dataclass(frozen=True)
class Sampled:
    """Samples, and what the formula and the foreign function give there.

    A sample has one point; at a jump of the formula (half a turn) it has a second one on the other side, and
    the foreign function may have either. ``kinds``: what each sample is. ``owners``: the sample of each
    point. ``left_out``: how many samples were left out, by the reason.
    """

    kinds: tuple[str, ...]
    values: Values  # of P points
    owners: NDArray[np.intp]
    near_jump: NDArray[np.bool_]  # of each sample
    expected: tuple[Array, ...]  # of P points
    found: tuple[Array, ...]  # of S samples
    raised: tuple[str, ...]  # of each sample, what the function raised there
    left_out: tuple[tuple[str, int], ...] = ()

    @property
    def general(self) -> NDArray[np.bool_]:
        """The samples without anything special."""
        return np.array([kind == "random" for kind in self.kinds])

    @property
    def points(self) -> int:
        """Number of points."""
        return len(self.owners)

    @property
    def firsts(self) -> NDArray[np.intp]:
        """The point of each sample itself, before those on the sides of a jump."""
        return np.flatnonzero(np.r_[True, self.owners[1:] != self.owners[:-1]])

    def first_points(self, samples: int) -> NDArray[np.intp]:
        """The points of the first general samples, which are one each."""
        chosen = np.flatnonzero(self.general)[:samples]
        return np.flatnonzero(np.isin(self.owners, chosen))

    def only(self, samples: NDArray[np.bool_]) -> Sampled:
        """Some of the samples."""
        if samples.all():
            return self
        points = samples[self.owners]
        number = np.cumsum(samples) - 1
        return Sampled(
            tuple(k for k, kept in zip(self.kinds, samples, strict=True) if kept),
            some(self.values, points),
            number[self.owners[points]],
            self.near_jump[samples],
            tuple(a[points] for a in self.expected),
            tuple(a[samples] for a in self.found),
            tuple(r for r, kept in zip(self.raised, samples, strict=True) if kept),
            self.left_out,
        )
