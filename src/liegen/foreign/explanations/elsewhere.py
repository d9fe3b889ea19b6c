"""The formula at other arguments: read in another layout, inverted, exchanged, or with a part left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import permutations, product
from typing import Any, get_args, get_type_hints

import numpy as np

from liegen.layouts import LAYOUTS, Layout, storage
from liegen.layouts.layout import Stored
from liegen.manifolds import Group, Value, Vector
from liegen.trace import Parameter

from .. import tangents
from ..points import AnyFunction, Array, Sampled, Values, evaluated, nudged, stable
from .difference import Difference, Subject

Change = Callable[[Any], Any]
#: Nudged points beside each, that tell whether the formula jumps there.
NUDGES = 4


@dataclass(frozen=True)
class Elsewhere:
    """What the formula gives at other arguments. ``layout``: of the arguments, if it is one."""

    phrase: str
    size: float
    outputs: tuple[Array, ...]
    layout: str = ""


def elsewhere(function: AnyFunction, sampled: Sampled) -> tuple[Elsewhere, ...]:
    """All other arguments that are tried."""
    near = [_changes(function, nudged(sampled.values, seed)) for seed in range(NUDGES)]
    found: list[Elsewhere] = []
    for (phrase, size, changed, layout), *others in zip(
        _changes(function, sampled.values), *near, strict=True
    ):
        there = stable(evaluated(function, changed), [evaluated(function, o[2]) for o in others])
        found.append(Elsewhere(phrase, size, there, layout))
    return tuple(found)


def of_elsewhere(subject: Subject, places: tuple[Elsewhere, ...]) -> Iterator[Difference]:
    """The output there, and, for a Jacobian with several blocks of columns, one block of it."""
    variable = subject.variable
    for place in places:
        array = place.outputs[subject.k]
        base = array[..., None] if variable is None else array
        if base.shape != subject.expected.shape:
            continue
        yield Difference("base", (place.phrase,), place.size, base=base)
        blocks = () if variable is None else tangents.blocks(variable.manifold.form, variable.chart)
        if len(blocks) > 1 and not place.layout:
            for block in blocks:
                mixed = np.array(subject.expected)
                mixed[:, :, block.place] = base[:, :, block.place]
                phrase = f"in the {block.label} columns {place.phrase}"
                yield Difference("base", (phrase,), place.size + 0.05, base=mixed)


def _changes(function: AnyFunction, values: Values) -> Iterator[tuple[str, float, dict[str, Value], str]]:
    parameters = {p.name: p for p in function.graph.parameters}
    groups = groups_of(values)
    for reading in readings(parameters, groups):
        for some in _subsets(groups):
            changed = {**values, **{n: reading.read(n, values[n]) for n in some}}
            what = "the arguments are" if len(some) == len(groups) > 1 else f"{some[0]} is"
            yield f"{what} read in the layout {reading.name}", 1.0, changed, reading.name
    for what, size, change in _OF_GROUPS:
        for some in _subsets(groups):
            changed = {n: change(values[n]) for n in some}
            if all(v is not None for v in changed.values()):
                yield what.format(" and ".join(some)), size, {**values, **changed}, ""
    for name in (n for n, v in values.items() if isinstance(v, Vector)):
        for what, size, change in _OF_VECTORS:
            yield what.format(name), size, {**values, name: change(values[name])}, ""
    for a, b in permutations(values, 2):
        if a < b and values[a].form == values[b].form:
            phrase = f"{a} and {b} are exchanged"
            yield phrase, 1.1, {**values, a: values[b], b: values[a]}, ""
    yield from _other_vectors(values)


def _subsets(names: list[str]) -> list[list[str]]:
    """All of them, then each alone."""
    return ([names] if names else []) + ([[n] for n in names] if len(names) > 1 else [])


@dataclass(frozen=True)
class Reading:
    """Another layout of as many numbers: its name, whether it has one, and how it reads an argument."""

    name: str
    named: bool
    read: Callable[[str, Any], Any]


def readings(parameters: Mapping[str, Parameter], groups: Sequence[str]) -> Iterator[Reading]:
    """The layouts, of as many numbers as the factor's, in which its groups may be read; named ones first."""
    own = {n: parameters[n].storage for n in groups}
    seen = [[own[n].names for n in groups]]
    hints = get_type_hints(Layout)
    others = (Layout(*choice) for choice in product(*(get_args(hints[f.name]) for f in fields(Layout))))
    combined = [Stored(layout.description, layout, layout) for layout in others]
    for layout in (*LAYOUTS.values(), *combined):
        reads = {n: storage(parameters[n].manifold.form, layout) for n in groups}
        names = [reads[n].names for n in groups]
        if names not in seen and all(reads[n].size == own[n].size for n in groups):
            seen.append(names)
            yield Reading(layout.name, layout.name in LAYOUTS, _reader(parameters, own, reads))
    if any(v.manifold.form.name in ("SO2", "SE2") for v in parameters.values()):
        yield Reading("(sin, cos)", False, lambda _, v: _sine_first(v))


def _reader(
    parameters: Mapping[str, Parameter], own: Mapping[str, Any], reads: Mapping[str, Any]
) -> Callable[[str, Any], Any]:
    def read(name: str, value: Any) -> Any:
        manifold: Any = parameters[name].manifold
        return manifold.holding(reads[name].read(own[name].write(value.coords)))

    return read


def groups_of(values: Values) -> list[str]:
    """The arguments that are elements of groups other than vectors."""
    return [n for n, v in values.items() if isinstance(v, Group) and not isinstance(v, Vector)]


def _sine_first(v: Value) -> Value:
    if v.form.name not in ("SO2", "SE2"):
        return v
    c, s, *rest = v.coords
    return _same_class(v, [s, c, *rest])


def _same_class(v: Any, coords: Sequence[Any]) -> Any:
    return v.holding(coords)  # a class method


def _with_rotation(v: Any, turned: Callable[[Any, Any], Any]) -> Any:
    rotation = tangents.rotation_of(v.form)
    if rotation is None:
        return None
    q = tuple(turned(rotation, v.coords[: rotation.size]))
    return _same_class(v, [*q, *v.coords[rotation.size :]])


def _without_vectors(v: Any) -> Any:
    rotation = tangents.rotation_of(v.form)
    if rotation is None or rotation.size == v.form.size:
        return None
    zero = [0.0 * c for c in v.coords[rotation.size : rotation.size + rotation.space]]
    return _same_class(v, [*v.coords[: rotation.size], *zero, *v.coords[rotation.size + rotation.space :]])


_OF_GROUPS: tuple[tuple[str, float, Change], ...] = (
    ("the inverse of {} is taken", 1.1, lambda v: v.inverse()),
    ("the rotation of {} is left out", 1.15, lambda v: _with_rotation(v, lambda r, _: r.identity())),
    ("R({})^T stands where R is right", 1.15, lambda v: _with_rotation(v, lambda r, q: r.inverse(q))),
    ("the translation of {} is left out", 1.15, _without_vectors),
)
_OF_VECTORS: tuple[tuple[str, float, Change], ...] = (
    ("{} has the opposite sign", 1.15, lambda v: _same_class(v, [-c for c in v.coords])),
    ("{} is left out", 1.25, lambda v: _same_class(v, [0.0 * c for c in v.coords])),
    ("{} is read in degrees", 1.2, lambda v: _same_class(v, [c * np.pi / 180 for c in v.coords])),
    ("{} is read in radians, it is in degrees", 1.2,
     lambda v: _same_class(v, [c * 180 / np.pi for c in v.coords])),
)  # fmt: skip


def _vectors(values: Values) -> dict[str, tuple[str, slice]]:
    """The vectors among the arguments, and the translations of poses: argument and place of the scalars."""
    found: dict[str, tuple[str, slice]] = {}
    for name, v in values.items():
        form: Any = v.form
        rotation = tangents.rotation_of(form)
        if isinstance(v, Vector):
            found[name] = (name, slice(0, form.size))
        elif rotation is not None and form.size >= rotation.size + rotation.space:
            place = slice(rotation.size, rotation.size + rotation.space)
            found[f"the translation of {name}"] = (name, place)
    return found


def _other_vectors(values: Values) -> Iterator[tuple[str, float, dict[str, Value], str]]:
    """One vector in the place of another of the same length."""
    for (text, (name, place)), (other, (source, there)) in permutations(_vectors(values).items(), 2):
        taken = values[source].coords[there]
        if len(taken) != place.stop - place.start:
            continue
        coords = list(values[name].coords)
        coords[place] = taken
        changed = {**values, name: type(values[name]).holding(coords)}
        yield f"{other} stands where {text} is right", 1.2, changed, ""
