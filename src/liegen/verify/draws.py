"""The samples that a factor is verified at: drawn by its sampler, inside its domain, always the same ones."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.define import Function, Sampler
from liegen.errors import DefinitionError
from liegen.manifolds import Value
from liegen.samples import CASES, Case, Draw, negated
from liegen.samples import sampler_of as own_sampler
from liegen.trace import Graph

AnyFunction = Function[..., Any]
#: Stored doubles of every argument.
Values = Mapping[str, tuple[float, ...]]
#: Whether the values lie in the domain that the graph states.
Inside = Callable[[Graph, Values], bool]

#: Draws for one sample before its case counts as impossible inside the domain.
TRIES = 50


@dataclass(frozen=True)
class Sample:
    """Arguments of a factor: the case that they show, and their stored doubles.

    ``conditioned``: the case is ill-conditioned by its nature, so the bound takes the inputs' last digits in.
    """

    case: str
    values: Values
    conditioned: bool = False


@dataclass(frozen=True)
class Samples:
    """Samples inside the domain, some outside, and the cases that found none inside: ``case: reason``."""

    inside: tuple[Sample, ...]
    outside: tuple[Sample, ...]
    refused: tuple[str, ...]


def generator_for(*names: object) -> np.random.Generator:
    """A generator whose seed is the text of ``names``, the same on every machine."""
    text = "\n".join(map(str, names))
    return np.random.default_rng(int.from_bytes(hashlib.sha256(text.encode()).digest(), "big"))


def schedule(name: str, count: int, seed: int) -> tuple[tuple[Case, int], ...]:
    """``count`` pairs (case, how many of it came before): every case once, again from the start, and so on.

    The first case comes first; with fewer samples than cases the others are those of a random order.
    """
    shuffled: list[int] = generator_for(seed, name).permutation(len(CASES) - 1).tolist()
    order = [CASES[0], *(CASES[1 + k] for k in shuffled)]
    return tuple((order[k % len(order)], k // len(order)) for k in range(count))


def draw_samples(function: AnyFunction, count: int, seed: int, inside: Inside | None = None) -> Samples:
    """Draw ``count`` samples, each from a generator of its own.

    ``inside`` tells the domain. By default it is what the mpmath reference says of each ``require``, and that
    roots, logarithms, acos and asin have real values. Raises DefinitionError for a sampler that does not give
    every argument its typed value.
    """
    why = _reference_reason() if inside is None else _given_reason(inside)
    kept: list[Sample] = []
    outside: list[Sample] = []
    refused: list[str] = []
    for case, turn in schedule(function.name, count, seed):
        draw = Draw(generator_for(seed, function.name, case.name, turn))
        reason = None
        for _ in range(TRIES):
            sample = draw_one(function, draw, case)
            reason = why(function.graph, sample.values)
            if reason is None:
                kept.append(sample)
                break
            if reason.stated:
                outside.append(sample)
        else:
            refused.append(f"{case.name}: no sample inside the domain, {reason.text if reason else ''}")
    return Samples(tuple(kept), tuple(outside[:count]), tuple(refused))


def draw_one(function: AnyFunction, draw: Draw, case: Case) -> Sample:
    """One sample, inside the domain or not."""
    values = negated(sampler_of(function)(draw, case), draw, always=case.negate)
    return Sample(case.name, stored(function, values), case.apart)


def sampler_of(function: AnyFunction) -> Sampler:
    """The sampler of a factor, with numbers for what noise and loss add."""
    own = own_sampler(function)
    weighting = function.weighting
    if weighting is None:
        return own
    m = function.plain.outputs[0][1].manifold.form.dim
    classes: dict[str, Any] = {p.name: p.manifold for p in function.graph.parameters}

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        values = dict(own(draw, case))
        drawn = weighting.draw(draw.generator, m)
        return {**values, **{name: classes[name].from_storage(x) for name, x in drawn.items()}}

    return sample


def stored(function: AnyFunction, values: Mapping[str, Value]) -> dict[str, tuple[float, ...]]:
    """The stored doubles of typed values. Raises DefinitionError where one is missing or not as declared."""
    doubles: dict[str, tuple[float, ...]] = {}
    for p in function.graph.parameters:
        value = values.get(p.name)
        if not isinstance(value, Value) or value.form != p.manifold.form:
            given = "nothing" if value is None else f"a {type(value).__name__}"
            raise DefinitionError(
                f"{function.graph.site}: {function.name}: its sampler gave {given} for {p.name!r}; "
                f"it must return a {p.manifold.__name__} for it"
            )
        doubles[p.name] = tuple(float(c) for c in p.storage.write(value.coords))
    return doubles


def batch(samples: tuple[Sample, ...]) -> dict[str, NDArray[np.float64]]:
    """The samples as arrays (number of samples, size) by argument."""
    names = samples[0].values if samples else ()
    return {name: np.array([s.values[name] for s in samples], dtype=np.float64) for name in names}


def program_domain(function: AnyFunction) -> Inside:
    """The domain as the derived program tells it: quick, and no check of the program itself."""

    def inside(_: Graph, values: Values) -> bool:
        return all(map(bool, function.kernel.value.evaluate(values)["status"]))

    return inside


@dataclass(frozen=True)
class Reason:
    """Why values are outside of a domain; ``stated``: by a ``require``."""

    text: str
    stated: bool = True


def _reference_reason() -> Callable[[Graph, Values], Reason | None]:
    """Loaded here, so that drawing for ``generate`` does not need it."""
    from .natural import unnatural
    from .reference import evaluate

    def reason(graph: Graph, values: Values) -> Reason | None:
        evaluation = evaluate(graph, values)
        for stated, holds in zip(graph.domain, evaluation.holds, strict=True):
            if not holds:
                return Reason(f"outside `{stated.message}`")
        text = unnatural(evaluation)
        return Reason(text, stated=False) if text else None

    return reason


def _given_reason(inside: Inside) -> Callable[[Graph, Values], Reason | None]:
    return lambda graph, values: None if inside(graph, values) else Reason("outside")
