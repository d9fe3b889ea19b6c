"""The samples of the accuracy table: for each rotation angle a few, built so that the angle is that one.

The angle is that of the rotation that matters: of the residual, of the argument of ``log`` and ``exp``, and
in one of the kinds of every element. Positions are of the size of a metre; ``liegen verify`` has other sizes.
Measured pixels are anywhere in the image; a column of its own has those near the prediction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import Manifold, Value
from liegen.samples import Case, Draw, negated
from liegen.trace import Graph
from liegen.verify import reference
from liegen.verify.draws import TRIES, AnyFunction, Sample, Values, generator_for, sampler_of, stored
from liegen.verify.reference.charts import space_in
from liegen.verify.reference.layouts import load
from liegen.verify.reference.logarithms import PRINCIPAL
from liegen.verify.reference.matrix import mp

#: Rotation angles [rad] and their titles.
ANGLES: tuple[tuple[str, float], ...] = (
    ("0", 0.0),
    *((f"1e-{k}", float(f"1e-{k}")) for k in range(12, 1, -1)),
    ("0.1", 0.1),
    ("1", 1.0),
    ("pi-1e-3", np.pi - 1e-3),
    ("pi-1e-8", np.pi - 1e-8),
    ("pi", np.pi),
)
#: The columns; the last two are for functions without rotations, and for small differences of pixels.
COLUMNS: tuple[str, ...] = (*(title for title, _ in ANGLES), "no angle", "small")
NO_ANGLE, SMALL = len(ANGLES), len(ANGLES) + 1
#: ``axis``: elements turned by quarters and halves of turns, the angle about a coordinate axis: exact.
#: ``pose``: every element is turned by the angle too. ``random``: any element, any axis. ``negated``: the
#: same with at least one rotation stored as -q.
KINDS = ("axis", "pose", "random", "negated")
#: What rounding leaves of a zero in a rotation by exactly pi.
ROUNDING = 2.5e-16


@dataclass(frozen=True)
class Point:
    """A sample in a column."""

    column: int
    sample: Sample


@dataclass(frozen=True)
class _Units(Draw):
    """Unit vectors along a coordinate: quaternions of half turns, coordinate axes. Others at random."""

    place: int | None = None  # None: any

    def unit(self, n: int) -> NDArray[np.float64]:
        """Plus or minus a coordinate vector."""
        k = int(self.generator.integers(n)) if self.place is None else self.place % n
        return np.eye(n)[k] * self.generator.choice([-1.0, 1.0])

    def vector(self, n: int, length: float | None = None, spread: float = 1.0) -> NDArray[np.float64]:
        """A random vector."""
        return Draw(self.generator).vector(n, length, spread)


@dataclass(frozen=True)
class _Turned(Draw):
    """Rotations by an angle, as quaternion or (cos, sin); other unit vectors at random."""

    angle: float = 0.0

    def unit(self, n: int) -> NDArray[np.float64]:
        """The stored rotation, or any unit vector."""
        if n == 2:
            return np.array([np.cos(self.angle), np.sin(self.angle)])
        if n == 4:
            axis = super().unit(3)
            return np.array([*(np.sin(self.angle / 2) * axis), np.cos(self.angle / 2)])
        return super().unit(n)


@dataclass(frozen=True)
class _PointDraw(Draw):
    """Elements and tangent vectors of a kind."""

    elements: Draw = field(kw_only=True)
    tangents: Draw = field(kw_only=True)

    def element(self, manifold: type[Manifold], spread: float = 1.0) -> Any:
        """An element of the kind."""
        return self.elements.element(manifold, spread)

    def tangent(self, manifold: type[Manifold], case: Case) -> NDArray[np.float64]:
        """A tangent vector with the case's angle, about an axis of the kind."""
        return self.tangents.tangent(manifold, case)


def rotates(graph: Graph) -> bool:
    """Whether rotations or directions occur, also as the group that an operation is about."""
    classes = [n.manifold for n in graph.nodes()]
    classes += [c for n in graph.nodes() for c in _classes(n.operation)]
    return any(c.form.turns or c.form.name == "S2" for c in classes)


def _classes(operation: Any) -> list[type[Value]]:
    return [c for c in getattr(operation, "parameters", ()) if isinstance(c, type) and hasattr(c, "form")]


def draw_points(function: AnyFunction, count: int, seed: int) -> tuple[tuple[Point, ...], tuple[str, ...]]:
    """``count`` points for each angle, and the columns where none was found inside the domain."""
    columns = list(enumerate(ANGLES)) if rotates(function.graph) else [(NO_ANGLE, ("no angle", 0.0))]
    columns += [(SMALL, ("small", 1.0))] if measured_pixel(function.graph) else []
    points: list[Point] = []
    refused: list[str] = []
    for column, (title, angle) in columns:
        found = [_drawn(function, column, angle, k, seed) for k in range(count)]
        points += [Point(column, sample) for sample in found if sample]
        refused += [] if any(found) else [title]
    return tuple(points), tuple(refused)


def measured_pixel(graph: Graph) -> str | None:
    """The argument that is subtracted as a measured pixel, if there is one: far above the residual."""
    ((_, node), *_) = graph.outputs
    calibrated = any(n.operation.name == "uncalibrate" for n in graph.nodes())
    names = {p.node: p.name for p in graph.parameters}
    return names.get(node.operands[1]) if calibrated and node.operation.name == "sub" else None


def _drawn(function: AnyFunction, column: int, angle: float, k: int, seed: int) -> Sample | None:
    """Functions with the same arguments get the same samples: the reference computes some results once."""
    kind = KINDS[k % len(KINDS)]
    arguments = [f"{p.name}: {p.manifold.form.name}" for p in function.graph.parameters]
    generator = generator_for(seed, *arguments, COLUMNS[column], k)
    pixel = measured_pixel(function.graph) if column != SMALL else None
    draw, case = _source(kind, angle, column + k // len(KINDS), generator), Case(kind, angle=angle)
    sampler = sampler_of(function)
    for _ in range(TRIES):
        typed = negated(sampler(draw, case), draw, always=kind == "negated")
        values: dict[str, tuple[float, ...]] = dict(_in_chart(function.graph, stored(function, typed)))
        exact = kind == "axis" and angle == ANGLES[-1][1]
        values = {n: _cleaned(v) for n, v in values.items()} if exact else values
        if pixel:
            # anywhere in the image: s is then of the size of a pixel's coordinates
            values = values | {pixel: tuple(c * draw.uniform(0, 0.6) for c in values[pixel])}
        if all(reference.holds(function.graph, values)):
            return Sample(kind, values)
    return None


def _source(kind: str, angle: float, place: int, generator: np.random.Generator) -> Draw:
    if kind == "axis":
        return _PointDraw(generator, elements=_Units(generator), tangents=_Units(generator, place))
    if kind == "pose":
        return _PointDraw(generator, elements=_Turned(generator, angle), tangents=Draw(generator))
    return Draw(generator)


def _cleaned(coords: Sequence[float]) -> tuple[float, ...]:
    """Zero where rounding left almost zero: half a turn is then exact."""
    return tuple(0.0 if abs(c) < ROUNDING else c for c in coords)


def _in_chart(graph: Graph, values: Values) -> Values:
    """A tangent vector that ``retract`` takes in a chart has there the coordinates of the same rotation."""
    changed = dict(values)
    names = {p.node: p.name for p in graph.parameters}
    for node in graph.nodes():
        preset = next(iter(getattr(node.operation, "parameters", ())), None)
        if node.operation.name != "retract" or preset is None:
            continue
        x, d = node.operands
        if x in names and d in names:
            with mp.workdps(reference.DIGITS):
                at = load(x.manifold, values[names[x]])
                own = tuple(mp.mpf(c) for c in values[names[d]])
                moved = space_in(x.manifold, None).retract(at, own, PRINCIPAL)
                coords = space_in(x.manifold, preset).local(at, moved, PRINCIPAL)
                changed[names[d]] = tuple(float(c) for c in coords)
    return changed
