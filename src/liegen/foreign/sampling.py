"""The samples of a check: random ones, special ones, and ones that are solved for a zero residual."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.charts import form_chart
from liegen.errors import DefinitionError, ToolError
from liegen.manifolds import Group, Manifold, Value
from liegen.samples import Case, Draw, other_quaternion
from liegen.verify.draws import sampler_of

from .calls import Foreign
from .points import (
    JUMP,
    NUDGE,
    AnyFunction,
    Array,
    Sampled,
    Values,
    arguments,
    at,
    batch,
    evaluated,
    every,
    size_of,
)
from .returned import RaisedError

#: Rotation angles of special samples: those of series and guards, and of half a turn.
ANGLES = (1e-12, 1e-8, 1e-5, 1e-3, 5e-3, 0.03, 0.1, np.pi - 1e-3, np.pi - 1e-6, np.pi)
SPECIAL = (
    Case("tens of metres", spread=30.0),
    Case("identity", angle=0.0, offset=0.0),
    Case("zero rotation", angle=0.0),
    *(Case(f"angle {angle:.7g}", angle=angle) for angle in ANGLES),
    Case("coincident", offset=0.0),
    Case("negated quaternions", negate=True),
)
RANDOM, ZERO = Case("random"), "zero residual"
#: Special samples of each case.
_EACH = 2
#: Gauss-Newton steps to a zero residual, and what counts as zero.
_STEPS, _SOLVED = 30, 1e-12
#: Neighbours of a special sample, which tell whether the formula jumps there.
_NEIGHBOURS = 8
#: Numerical differences have steps of at most that; across a jump they give a multiple of the jump.
_STEP, _LARGE, _ALONG = 1e-4, 100.0, 0.1
_NO_VALUE = "the formula has no value or no finite Jacobian there"
_NO_DERIVATIVE = "the formula has no derivative there"
_ACROSS = "the function takes differences across a jump of the residual, or the mean of both sides"


@dataclass(frozen=True)
class Drawn:
    """Arguments of a sample and what it is."""

    kind: str
    values: Values


def sampled(function: AnyFunction, foreign: Foreign, samples: int, seed: int) -> Sampled:
    """All samples, evaluated.

    Raises DefinitionError when no random sample has a finite Jacobian, and ToolError where the foreign
    function fails at a random sample.
    """
    drawn = [*_drawn(function, foreign.given, samples, seed)]
    values = batch([d.values for d in drawn])
    exact = evaluated(function, values)
    finite = _finite(exact)
    left_out = Counter({_NO_VALUE: int((~finite).sum())})
    if not any(f and d.kind == RANDOM.name for f, d in zip(finite, drawn, strict=True)):
        raise DefinitionError(
            f"{function.graph.site}: {function.name}: no sample has a finite residual and Jacobian; "
            "give it @factor(sample=...)"
        )
    kept: list[Drawn] = []
    points: list[Values] = []
    owners: list[int] = []
    draw = Draw(np.random.default_rng([seed, 1]))
    for k in np.flatnonzero(finite):
        here = at(values, int(k))
        others = [] if drawn[k].kind == RANDOM.name else _across(function, here, [a[k] for a in exact], draw)
        if others is None:
            left_out[_NO_DERIVATIVE] += 1
            continue
        points += [here, *others]
        owners += [len(kept)] * (1 + len(others))
        kept.append(drawn[k])
    everywhere = batch(points)
    index = np.array(owners)
    firsts = batch([d.values for d in kept])
    found, raised = _foreign_results(function, foreign, kept, firsts)
    whole = Sampled(
        tuple(d.kind for d in kept),
        everywhere,
        index,
        np.bincount(index, minlength=len(kept)) > 1,
        evaluated(function, everywhere),
        found,
        raised,
    )
    across = _across_a_jump(function, whole, draw)
    left_out[_ACROSS] = int(across.sum())
    return replace(whole.only(~across), left_out=tuple((why, n) for why, n in left_out.items() if n))


def _across_a_jump(function: AnyFunction, held: Sampled, draw: Draw) -> NDArray[np.bool_]:
    """The samples at which the Jacobians are numerical differences across a jump of the residual.

    There is nothing to hold them against: a column of such a Jacobian is the jump, divided by a small step.
    Nor is there for a residual between both sides, which a logarithm of matrices gives at half a turn.
    """
    across = np.zeros(len(held.kinds), dtype=bool)
    for k in np.flatnonzero(~held.general):
        first = int(held.firsts[k])
        exact = [a[first] for a in held.expected]
        jump = _jump(function, at(held.values, first), exact, draw)
        if jump is None:
            continue
        residual, *blocks = (a[k] for a in held.found)
        part = float((residual - exact[0]) @ jump) / float(jump @ jump)
        between = 0.01 < part < 0.99 and np.abs(residual - exact[0] - part * jump).max() < JUMP
        along = any(_multiple(found - J, jump) for found, J in zip(blocks, exact[1:], strict=True)
                    if found.shape == J.shape)  # fmt: skip
        across[k] = between or along
    return across


def _jump(
    function: AnyFunction, values: Mapping[str, Value], exact: Sequence[Array], draw: Draw
) -> Array | None:
    """How the residual changes at a jump that is nearer than the step of numerical differences."""
    there = evaluated(function, _neighbours(values, draw, _STEP))[0]
    slope = max(float(np.abs(J).max(initial=0.0)) for J in (np.ones((1, 1)), *exact[1:]))
    changes = there - exact[0]
    k = int(np.argmax(np.abs(np.nan_to_num(changes)).max(axis=1)))
    return changes[k] if np.abs(changes[k]).max() > 20 * _STEP * slope + 0.1 else None


def _multiple(error: Array, jump: Array) -> bool:
    """Whether a column is a large multiple of the jump."""
    unit = jump / np.linalg.norm(jump)
    lengths = np.linalg.norm(error, axis=0)
    cosines = np.abs(unit @ error) / np.maximum(lengths, 1e-300)
    return bool(((lengths > _LARGE) & (cosines > 1 - _ALONG)).any())


def _finite(outputs: Sequence[Array]) -> NDArray[np.bool_]:
    return np.all([every(np.isfinite(a)) for a in outputs], axis=0)


def _drawn(function: AnyFunction, given: Mapping[str, Value], samples: int, seed: int) -> Iterator[Drawn]:
    sampler = sampler_of(function)
    names = [p.name for p in function.graph.parameters]
    draw = Draw(np.random.default_rng(seed))

    def one(case: Case) -> dict[str, Value]:
        drawn = sampler(draw, case)
        return {n: given.get(n, drawn[n]) for n in names}

    for _ in range(samples):
        yield Drawn(RANDOM.name, one(RANDOM))
    for _ in range(max(4, samples // 4)):
        solved = solved_for_zero(function, one(RANDOM))
        if solved is not None:
            yield Drawn(ZERO, solved)
    for case in SPECIAL:
        for _ in range(_EACH):
            values = one(case)
            if case.negate:
                values = {name: other_quaternion(v) for name, v in values.items()}
            yield Drawn(case.name, values)
    for name, moved in _turned(function, set(given)):
        values = one(RANDOM)
        yield Drawn(f"{name} {moved[0]}", {**values, name: moved[1]})


def _turned(function: AnyFunction, given: set[str]) -> Iterator[tuple[str, tuple[str, Value]]]:
    """Each rotating argument alone at the identity, and turned about one axis; each vector at zero."""
    for p in function.graph.parameters:
        manifold: Any = p.manifold
        form = manifold.form
        if p.name in given or not issubclass(manifold, Group):
            continue
        if form.flat:
            yield p.name, ("= 0", manifold.from_storage(np.zeros(form.size)))
        if not form.turns:
            continue
        yield p.name, ("at the identity", manifold.identity())
        for k, unit in enumerate(form.tangent):
            if "[rad]" in unit:
                for angle, called in ((1.0, "turned about an axis"), (np.pi, "turned by pi about an axis")):
                    yield p.name, (called, manifold.exp(np.eye(form.dim)[k] * angle))


def solved_for_zero(function: AnyFunction, values: Mapping[str, Value]) -> dict[str, Value] | None:
    """The variables moved to where the residual is zero, by Gauss-Newton steps; None where none is found."""
    moved: dict[str, Any] = dict(values)
    variables = [p.name for p in function.graph.variables]
    for _ in range(_STEPS):
        residual, *blocks = (a[0] for a in evaluated(function, moved))
        if not all(np.isfinite(a).all() for a in (residual, *blocks)):
            return None
        if np.abs(residual).max(initial=0) < _SOLVED:
            return moved
        step = np.asarray(np.linalg.pinv(np.hstack(blocks)) @ -residual, dtype=np.float64)
        ends = np.cumsum([block.shape[1] for block in blocks])[:-1]
        for p, d in zip(variables, np.split(step, ends), strict=True):
            moved[p] = retracted(function, p, moved[p], d)
    return None


def retracted(function: AnyFunction, name: str, x: Any, d: Any) -> Any:
    """A variable moved by tangent coordinates of the factor's own chart."""
    p = next(p for p in function.graph.parameters if p.name == name)
    chart = form_chart(p.manifold.form, p.chart)
    manifold: Any = p.manifold
    return x.retract(d) if chart is None else manifold.holding(chart.retract(x.coords, tuple(d)))


def _across(
    function: AnyFunction, values: Mapping[str, Value], exact: Sequence[Array], draw: Draw
) -> list[Values] | None:
    """A neighbour on each side of a jump, if there is a jump; None where there is no derivative."""
    moved = _neighbours(values, draw, NUDGE)
    there = evaluated(function, moved)
    sides: list[list[Array]] = [list(exact)]
    members: list[list[Values]] = [[]]
    for k in np.flatnonzero(_finite(there)):
        outputs = [a[k] for a in there]
        side = next((n for n, s in enumerate(sides) if _close(outputs, s)), len(sides))
        if side == 2:
            return None
        if side == len(sides):
            sides.append(outputs)
            members.append([])
        members[side].append(at(moved, int(k)))
    return [group[0] for group in members if group] if len(sides) > 1 else []


def _neighbours(values: Mapping[str, Value], draw: Draw, distance: float) -> dict[str, Value]:
    """A batch of points near a point, all of whose arguments are moved."""
    near: dict[str, Any] = {}
    for name, v in values.items():
        if isinstance(v, Manifold) and v.form.dim:
            scale = max(1.0, max(abs(float(c)) for c in v.coords)) if v.form.flat else 1.0
            steps = np.array([draw.unit(v.form.dim) for _ in range(_NEIGHBOURS)]) * scale * distance
            near[name] = v.retract(steps)
        else:
            near[name] = type(v).holding([np.full(_NEIGHBOURS, float(c)) for c in v.coords])
    return near


def _close(a: Sequence[Array], b: Sequence[Array]) -> bool:
    return all(
        bool(np.abs(x - y).max(initial=0) <= JUMP * max(1.0, float(np.abs(y).max(initial=0))))
        for x, y in zip(a, b, strict=True)
    )


def _foreign_results(
    function: AnyFunction, foreign: Foreign, drawn: Sequence[Drawn], values: Values
) -> tuple[tuple[Array, ...], tuple[str, ...]]:
    """What the foreign function gives at each sample: NaN where it raises at a special one."""
    results: list[tuple[Array, ...] | None] = []
    raised: list[str] = []
    for sample, given in zip(drawn, arguments(function, values, own=foreign.own), strict=True):
        try:
            results.append(foreign.call(given))
            raised.append("")
        except RaisedError as error:
            if sample.kind == RANDOM.name:
                raise ToolError(str(error)) from error
            results.append(None)
            raised.append(str(error))
    shapes = [a.shape for a in next(r for r in results if r is not None)]
    nothing = tuple(np.full(shape, np.nan) for shape in shapes)
    complete = [tuple(map(np.asarray, r)) if r is not None else nothing for r in results]
    for k, r in enumerate(complete):
        if [a.shape for a in r] != shapes:
            raise ToolError(f"the arrays have other shapes at sample {k} than at the first one")
    return tuple(np.stack(arrays).astype(np.float64) for arrays in zip(*complete, strict=True)), tuple(raised)


def judged_at(
    function: AnyFunction, foreign: Foreign, values: Values
) -> tuple[tuple[Array, ...], tuple[Array, ...]] | None:
    """What formula and foreign function give at one more point; None where either has no value."""
    exact = evaluated(function, values)
    if size_of(values) != 1 or not _finite(exact).all():
        return None
    try:
        found = foreign.call(arguments(function, values, own=foreign.own)[0])
    except RaisedError:
        return None
    return tuple(a[0] for a in exact), found


Judge = Callable[[Values], bool | None]
