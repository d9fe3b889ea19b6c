"""Outside of a factor's domain: NaN everywhere, and in C the bits of the conditions that do not hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from liegen.samples import CASES, Draw, default_sampler
from liegen.trace import Graph

from . import reference
from .backends import Backend
from .compiled import STATUS
from .draws import AnyFunction, Sample, Samples, batch, generator_for, stored
from .report import Check

#: Samples outside the domain that are enough, and draws to find them.
ENOUGH, TRIES = 8, 60


def domain(function: AnyFunction, samples: Samples, computed: Sequence[Backend], seed: int) -> Check:
    """Check NaN and status outside, and status 0 inside. ``worst`` counts wrong results."""
    graph = function.graph
    outside = (*samples.outside, *_more(function, seed))[:ENOUGH] if graph.domain else ()
    bits = [_bits(graph, s) for s in outside]
    wrong, where = 0, ""
    for backend in computed:
        for sample, bad in zip(outside, _wrong_outside(backend, outside, bits), strict=True):
            wrong, where = wrong + bad, f"{backend.name}, {sample.case}" if bad else where
        inside = backend.evaluate(batch(samples.inside)).get(STATUS) if samples.inside else None
        if inside is not None and inside.any():
            wrong, where = wrong + int(np.count_nonzero(inside)), f"{backend.name}, status inside the domain"
    note = "" if outside else "no sample outside was found" if graph.domain else "everywhere"
    return Check("domain", wrong == 0, float(wrong), 0.0, "wrong results", where, len(outside), note=note)


def _wrong_outside(backend: Backend, outside: Sequence[Sample], bits: Sequence[int]) -> list[int]:
    if not outside:
        return []
    results = dict(backend.evaluate(batch(tuple(outside))))
    status = results.pop(STATUS, None)
    blank = np.all([np.isnan(a.reshape(len(outside), -1)).all(axis=1) for a in results.values()], axis=0)
    right = blank if status is None else blank & (status == np.array(bits))
    return [int(not r) for r in right]


def _bits(graph: Graph, sample: Sample) -> int:
    return sum(1 << k for k, held in enumerate(reference.holds(graph, sample.values)) if not held)


def _more(function: AnyFunction, seed: int) -> list[Sample]:
    """Samples outside, drawn without regard to the factor's own sampler, which stays inside."""
    graph = function.graph
    manifolds: dict[str, Any] = {p.name: p.manifold for p in graph.parameters}
    sampler = default_sampler(manifolds)
    draw = Draw(generator_for(seed, function.name, "outside"))
    drawn = (Sample("outside", stored(function, sampler(draw, CASES[0]))) for _ in range(TRIES))
    return [s for s in drawn if _bits(graph, s)][:ENOUGH]
