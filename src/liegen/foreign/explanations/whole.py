"""One chart and one layout in which all outputs of a function are correct."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from liegen.errors import LiegenError
from liegen.layouts import storage

from ..points import AnyFunction, Values, columns_of, evaluated, nudged, size_of, stable
from .chart_candidates import Candidate, candidates, representative
from .columns import chart_columns
from .difference import Array, Subject
from .elsewhere import NUDGES, groups_of, readings
from .nodes import value_of
from .search import enough, misfits


@dataclass(frozen=True)
class Whole:
    """The convention in words, and the options of the command that ask for it."""

    text: str
    options: str


@dataclass(frozen=True)
class _Read:
    """The arguments as another layout reads them. Without a text: as the factor's own does."""

    text: str
    option: str
    values: Values
    near: tuple[Values, ...]  # the same of nudged points


def whole_convention(subjects: Sequence[Subject], tolerance: float) -> Whole | None:
    """The first that fits every output at all samples: layouts, then charts, then both."""
    function, sampled = subjects[0].function, subjects[0].sampled
    near = [nudged(sampled.values, seed) for seed in range(NUDGES)]
    read = [_Read("", "", sampled.values, ()), *_readings(function, sampled.values, near)]
    exact = [_stable(function, r) for r in read]
    for r, outputs in zip(read[1:], exact[1:], strict=True):
        if _fit(subjects, outputs, tolerance):
            return Whole(r.text, r.option)
    for candidate in _candidates(function):
        charted = _in_chart(function, candidate)
        for r, outputs in zip(read, exact, strict=True):
            found = charted and _outputs(subjects, charted, candidate, r, outputs, tolerance)
            if found and _fit(subjects, found, tolerance):
                text = f"the chart {candidate.name}" + (f" and {r.text}" if r.text else "")
                option = f"--chart {candidate.name}" if candidate.named else ""
                options = " ".join(o for o in (option, r.option) if o)
                return Whole(text, options if option and (r.option or not r.text) else "")
    return None


def _stable(function: AnyFunction, read: _Read) -> tuple[Array, ...]:
    return stable(evaluated(function, read.values), [evaluated(function, n) for n in read.near])


def _readings(function: AnyFunction, values: Values, near: Sequence[Values]) -> Iterator[_Read]:
    parameters = {p.name: p for p in function.graph.parameters}
    groups = groups_of(values)
    for reading in readings(parameters, groups):
        changed, *others = ({**v, **{n: reading.read(n, v[n]) for n in groups}} for v in (values, *near))
        option = f"--layout {reading.name}" if reading.named else ""
        yield _Read(f"the layout {reading.name}", option, changed, tuple(others))


def _candidates(function: AnyFunction) -> Iterator[Candidate]:
    """The charts other than the function's own, of the first argument or value that has several."""
    forms = [p.manifold.form for p in function.graph.parameters]
    forms += [n.operands[0].manifold.form for n in function.graph.nodes() if n.operands]
    charted = next((f for f in forms if representative(f) is not None), None)
    if charted is not None:
        yield from (c for c in candidates(charted, function.graph.chart) if c.preset != function.graph.chart)


def _in_chart(function: AnyFunction, candidate: Candidate) -> AnyFunction | None:
    try:
        return replace(function, chart=candidate.name if candidate.named else candidate.preset.space)
    except LiegenError:
        return None


def _outputs(
    subjects: Sequence[Subject],
    charted: AnyFunction,
    candidate: Candidate,
    read: _Read,
    exact: Sequence[Array],
    tolerance: float,
) -> Sequence[Array] | None:
    """The outputs in a chart; None where the residual is another one already, which is quick to see."""
    if not _depends_on_chart(charted):
        columns: list[Array] = [exact[0]]
        for p, J in zip(subjects[0].function.graph.variables, exact[1:], strict=True):
            try:
                columns.append(J @ chart_columns(p, candidate.preset, read.values[p.name], len(J)))
            except LiegenError:
                return None
        return columns
    residual, *others = (_residual(charted, v) for v in (read.values, *read.near))
    if not _fit(subjects[:1], stable([residual], [[o] for o in others]), tolerance):
        return None
    return _stable(charted, read)


def _residual(charted: AnyFunction, values: Values) -> Array:
    graph = charted.graph
    output = graph.outputs[0][1]
    scalars = storage(output.manifold.form, graph.layout).write(value_of(graph, output, values).coords)
    return columns_of(scalars, size_of(values))


def _depends_on_chart(function: AnyFunction) -> bool:
    """Whether the values do, not only the columns of the Jacobians."""
    moving = any(n.operation.name in ("local", "retract") for n in function.graph.nodes())
    return moving or representative(function.graph.outputs[0][1].manifold.form) is not None


def _fit(subjects: Sequence[Subject], outputs: Sequence[Array], tolerance: float) -> bool:
    for s in subjects:
        array = outputs[s.k]
        array = array[..., None] if s.variable is None else array
        general = s.sampled.general[s.sampled.owners]
        if not enough(array[general]):
            return False
        if array.shape != s.expected.shape or misfits(s, array, tolerance).any():
            return False
    return True
