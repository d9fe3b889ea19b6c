"""Hold foreign Jacobians against those of a formula, and name the convention in which they differ."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.define import Function
from liegen.errors import DefinitionError
from liegen.manifolds import Value
from liegen.samples import Case, Draw, default_sampler

from .calls import Foreign
from .conventions import Choices, Point, explanations, of_jacobian, of_residual

Array = NDArray[np.float64]
#: Samples away from special cases, and those where the residual is zero.
_ANY, _ZERO = Case("random"), Case("zero residual", angle=0.0, offset=0.0)
#: Gauss-Newton steps to a zero residual, and what counts as zero.
_STEPS, _SOLVED = 30, 1e-12


@dataclass(frozen=True)
class Finding:
    """One output: how far it is off, where, and why.

    ``worst`` is the largest absolute difference relative to max(1, largest entry of the expected array).
    ``differences`` are the conventions that explain it; empty where none does, or where nothing differs.
    """

    name: str
    correct: bool
    worst: float
    entry: tuple[int, ...]
    expected: float
    found: float
    sample: str
    differences: tuple[str, ...]
    correct_at_zero: bool

    @property
    def verdict(self) -> str:
        """In a few words."""
        if self.correct:
            return "correct"
        if self.differences:
            return "; ".join(self.differences)
        return (
            "wrong away from zero residual"
            if self.correct_at_zero
            else "wrong, no known convention explains it"
        )


@dataclass(frozen=True)
class Comparison:
    """What was found of the residual and of each Jacobian."""

    factor: str
    samples: int
    tolerance: float
    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        """Whether all is correct."""
        return all(f.correct for f in self.findings)

    def as_json(self) -> dict[str, Any]:
        """The same with plain types."""
        return {**asdict(self), "passed": self.passed}


@dataclass(frozen=True)
class _Sampled:
    """The points and, for each output, the expected and the found arrays."""

    points: tuple[Point, ...]
    expected: tuple[tuple[Array, ...], ...]
    found: tuple[tuple[Array, ...], ...]

    def errors(self, k: int, change: Callable[[Array, Point], Array]) -> list[Array]:
        """The relative differences of output k at each point, from a changed expectation."""
        return [
            np.abs(found[k] - change(expected[k], point))
            / max(1.0, float(np.abs(expected[k]).max(initial=0)))
            for point, expected, found in zip(self.points, self.expected, self.found, strict=True)
        ]

    def agrees(self, k: int, change: Callable[[Array, Point], Array], tolerance: float) -> bool:
        """Whether output k is the changed expectation; NaN never is."""
        return all(bool((error <= tolerance).all()) for error in self.errors(k, change))


def compare(
    function: Function[..., Any],
    foreign: Foreign,
    *,
    samples: int = 24,
    seed: int = 0,
    tolerance: float = 1e-7,
) -> Comparison:
    """Hold a foreign function against a factor at random samples.

    Raises DefinitionError for a function with several outputs, or when no sample is finite.
    """
    if len(function.graph.outputs) != 1:
        raise DefinitionError(f"{function.name} has several outputs; check-jacobian is for one residual")
    general = _sampled(function, foreign, _ANY, samples, seed)
    zero = _sampled(function, foreign, _ZERO, max(4, samples // 4), seed)
    variables = [p.name for p in function.graph.variables]
    output = function.graph.outputs[0][0]
    choices = [of_residual(function.graph), *(of_jacobian(function.graph, v) for v in variables)]
    names = [output, *(f"{output}_D_{v}" for v in variables)]
    return Comparison(
        function.name,
        len(general.points),
        tolerance,
        tuple(
            _finding(n, k, c, general, zero, tolerance)
            for k, (n, c) in enumerate(zip(names, choices, strict=True))
        ),
    )


def _finding(
    name: str, k: int, choices: Choices, general: _Sampled, zero: _Sampled, tolerance: float
) -> Finding:
    errors = [np.where(np.isnan(e), np.inf, e) for e in general.errors(k, _as_it_is)]
    at = int(np.argmax([e.max() for e in errors]))
    entry = tuple(int(i) for i in np.unravel_index(int(np.argmax(errors[at])), errors[at].shape))
    correct = general.agrees(k, _as_it_is, tolerance)
    why: tuple[str, ...] = ()
    if not correct:
        for differences in explanations(choices):
            if general.agrees(k, _one_after_the_other([d.change for d in differences]), tolerance):
                why = tuple(d.meaning for d in differences)
                break
    values = ", ".join(f"{n} = {np.asarray(v).tolist()}" for n, v in general.points[at].values.items())
    return Finding(
        name,
        correct,
        float(errors[at].max()),
        entry,
        float(general.expected[at][k][entry]),
        float(general.found[at][k][entry]),
        values,
        why,
        bool(zero.points) and zero.agrees(k, _as_it_is, tolerance),
    )


def _as_it_is(array: Array, _: Point) -> Array:
    return array


def _one_after_the_other(
    changes: Sequence[Callable[[Array, Point], Array]],
) -> Callable[[Array, Point], Array]:
    def change(array: Array, point: Point) -> Array:
        for step in changes:
            array = step(array, point)
        return array

    return change


def _sampled(function: Function[..., Any], foreign: Foreign, case: Case, samples: int, seed: int) -> _Sampled:
    parameters = {p.name: p.manifold for p in function.graph.parameters}
    variables = [p.name for p in function.graph.variables]
    manifolds: Any = parameters
    sampler = function.sampler or default_sampler(manifolds)
    draw = Draw(np.random.default_rng(seed))
    points: list[Point] = []
    expected: list[tuple[Array, ...]] = []
    found: list[tuple[Array, ...]] = []
    for _ in range(samples):
        drawn = sampler(draw, case)
        values: dict[str, Value] | None = {n: foreign.given.get(n, drawn[n]) for n in parameters}
        if case is _ZERO and foreign.given:  # the sampler's are at zero with its own measurement only
            values = _solved(function, values, variables)
        if values is None:
            continue
        exact = _evaluated(function, values, variables)
        if not all(np.isfinite(a).all() for a in exact):
            continue
        points.append(Point(values, exact[0]))
        expected.append(exact)
        stored = [p.storage.write(values[p.name].coords) for p in function.graph.parameters]
        found.append(foreign.call([np.array(x, dtype=np.float64) for x in stored]))
    if not points and case is _ANY:
        raise DefinitionError(
            f"{function.name}: no sample has a finite residual; give it @factor(sample=...)"
        )
    return _Sampled(tuple(points), tuple(expected), tuple(found))


def _evaluated(
    function: Function[..., Any], values: Mapping[str, Value], variables: Sequence[str]
) -> tuple[Array, ...]:
    given = {name: v for name, v in values.items() if name not in variables}
    return tuple(function.jacobians(*(values[v] for v in variables), **given).values())


def _solved(
    function: Function[..., Any], values: Mapping[str, Value], variables: Sequence[str]
) -> dict[str, Value] | None:
    """The variables moved to where the residual is zero, by Gauss-Newton steps; None where none is found."""
    moved: dict[str, Any] = dict(values)
    for _ in range(_STEPS):
        residual, *blocks = _evaluated(function, moved, variables)
        if not all(np.isfinite(a).all() for a in (residual, *blocks)):
            return None
        if np.abs(residual).max() < _SOLVED:
            return moved
        step = np.linalg.lstsq(np.hstack(blocks), -residual, rcond=None)[0]
        ends = np.cumsum([block.shape[1] for block in blocks])[:-1]
        for name, d in zip(variables, np.split(step, ends), strict=True):
            moved[name] = moved[name].retract(d)
    return None
