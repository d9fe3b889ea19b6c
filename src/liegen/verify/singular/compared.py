"""Results at singular points that are finite: held against the reference wherever it has a derivative."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.trace import Graph

from .. import reference
from ..backends import Backend
from ..branches import flat, nearby
from ..draws import AnyFunction, Sample, batch
from ..expected import compare, expect
from ..reference.charts import space_in
from ..reference.interpreter import loaded, run
from ..reference.logarithms import PRINCIPAL
from ..reference.matrix import mp
from ..rounding import EPS, JUMP, rounded_otherwise
from .candidates import Hit

Array = NDArray[np.float64]

#: Hits that are compared, of each point and in all: the reference takes longer than all back ends together.
OF_EACH, AT_MOST = 2, 12
#: How much more than elsewhere an error may be, because rounding grows without a bound near such points.
ROUGH = 100.0
#: One-sided slopes are apart by more than this, relative to max(1, s), where there is no derivative.
SIDES = 1e-6
#: The step of one-sided slopes is ten to the power of minus this.
STEP = 35
#: Stored numbers that are looked at beside those of a hit.
NEARBY = 3


def wrong(function: AnyFunction, hits: Sequence[Hit], computed: Sequence[Backend]) -> list[tuple[Hit, str]]:
    """The hits at which a finite result is not the reference's, and what is off."""
    chosen = _chosen(hits)
    if not chosen or (function.weighting and function.weighting.loss):
        return []
    samples = [hit.sample("") for hit in chosen]
    expected = expect(function, samples, conditioned=True)
    decided = _decided(function, samples)
    found: dict[int, str] = {}
    for backend in computed:
        results = backend.evaluate(batch(tuple(samples)))
        for comparison in compare(expected, results):
            name = comparison.block.name
            for k in np.flatnonzero((comparison.ratio > ROUGH) & decided).tolist():
                if (
                    k not in found
                    and _has_derivative(function.graph, samples[k], name)
                    and _resolved(function.graph, samples[k], name)
                ):
                    found[k] = f"{name} of {backend.name} is finite and wrong"
    return [(chosen[k], what) for k, what in sorted(found.items())]


def _chosen(hits: Sequence[Hit]) -> list[Hit]:
    """Exact ones first, then those near by."""
    count: dict[tuple[int, ...], int] = {}
    chosen: list[Hit] = []
    for hit in sorted(hits, key=lambda h: h.away > 0):
        if any(point.place.either for point in hit.points):
            continue
        key = (*map(id, hit.points), hit.away > 0)
        count[key] = count.get(key, 0) + 1
        if count[key] <= OF_EACH:
            chosen.append(hit)
    return chosen[:AT_MOST]


def _decided(function: AnyFunction, samples: Sequence[Sample]) -> NDArray[np.bool_]:
    """Whether other roundings leave all results about the same."""
    program, arguments = function.kernel.jacobians, batch(tuple(samples))
    runs = list(rounded_otherwise(program, arguments, EPS))
    decided = np.ones(len(samples), dtype=np.bool_)
    for name in runs[0]:
        flat = np.array([r[name].reshape(len(samples), -1) for r in runs])
        with np.errstate(all="ignore"):
            size = np.maximum(1.0, np.abs(flat).max(axis=(0, 2)))
            decided &= (flat.max(axis=0) - flat.min(axis=0)).max(axis=1) <= JUMP * size
    return decided


def _resolved(graph: Graph, sample: Sample, block: str) -> bool:
    """Whether the reference gives about the same where the last digits of the stored numbers are others.

    It does not where a norm is one of their rounding: there its gradient may be 0.
    """
    output, _, variable = block.rpartition("_D_")
    if not output:
        return True
    near = [sample.values, *islice(nearby(graph, sample), NEARBY)]
    entries = np.array([flat(reference.jacobians(graph, v)[output, variable]) for v in near])
    with np.errstate(all="ignore"):
        apart = entries.max(axis=0) - entries.min(axis=0)
    return bool((apart <= JUMP * np.maximum(1.0, np.abs(entries).max())).all())


def _has_derivative(graph: Graph, sample: Sample, block: str) -> bool:
    """Whether the slopes from both sides agree in the reference; of an output's value always."""
    output, _, variable = block.rpartition("_D_")
    if not output:
        return True
    p = next(p for p in graph.variables if p.name == variable)
    node = dict(graph.outputs)[output]
    with mp.workdps(3 * STEP):
        given = loaded(graph, sample.values)
        base = run(graph, graph.nodes(), given)
        space, h = space_in(p.manifold, p.chart), mp.mpf(10) ** -STEP
        for k in range(p.manifold.form.dim):
            sides: list[Any] = []
            for sign in (1, -1):
                d = tuple(sign * h if i == k else mp.zero for i in range(p.manifold.form.dim))
                moved = space.retract(given[p.node], d, PRINCIPAL)
                end = run(graph, graph.nodes(), {**given, p.node: moved}, base)
                change = reference.difference(node.manifold, base[node], end[node], graph.chart)
                sides.append([sign * c / h for c in change])
            size = max(1, *(abs(x) for side in sides for x in side))
            if not all(abs(a - b) <= SIDES * size for a, b in zip(*sides, strict=True)):
                return False
    return True
