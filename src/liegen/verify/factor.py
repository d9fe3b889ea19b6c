"""All checks of one factor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from liegen.errors import DomainError
from liegen.trace import Graph

from .accuracy import Results, accuracy, agreement
from .backends import Backend, Workspace, backends
from .differences import differences
from .domain import domain
from .draws import AnyFunction, Samples, batch, draw_samples
from .expected import Expected, compare, expect
from .gradient import gradient, not_applicable
from .in_place import in_place
from .normal_terms import normal_terms
from .report import Check, FactorReport
from .sanity import check_finite
from .single import single
from .singular import singular_points
from .taylor import taylor
from .unit_length import off_unit

Array = NDArray[np.float64]

#: The back end whose Jacobians and outputs the checks by differences and remainders take.
TAKEN = "NumPy"
#: Samples that are also given one at a time: NumPy computes scalars by other code than arrays.
SINGLE = 4


def check_factor(
    function: AnyFunction,
    place: Workspace,
    samples: int,
    seed: int,
    *,
    conditioned: bool,
    gauss_newton: bool = False,
) -> FactorReport:
    """Draw ``samples`` samples and run every check.

    ``conditioned`` as in :func:`expect`; ``gauss_newton``: of the Gauss-Newton terms too.
    """
    checks = _checks(function, place, samples, seed, conditioned, gauss_newton)
    compared = len(checks) > 1  # else there is no sample, or no number
    return FactorReport(function.name, checks, off_unit(function, seed) if compared else ())


def _checks(
    function: AnyFunction,
    place: Workspace,
    samples: int,
    seed: int,
    conditioned: bool,
    gauss_newton: bool,
) -> tuple[Check, ...]:
    drawn = draw_samples(function, samples, seed)
    if not drawn.inside:
        return (_nothing(function, drawn),)
    computed = backends(function.kernel, place)
    results = {b.name: b.evaluate(batch(drawn.inside)) for b in computed}
    hopeless = _finite_nowhere(function, results[TAKEN if function.kernel.variables else f"{TAKEN}, value"])
    if hopeless:
        return (hopeless,)
    weighting = function.weighting if function.weighting and function.weighting.loss else None
    expected = expect(function, drawn.inside, conditioned=conditioned)
    floats = [single(function.kernel, place, drawn.inside, drawn.outside)]
    terms: list[Check] = []
    if gauss_newton:
        terms += [normal_terms(function, place, drawn, expected)]
        kernel, name = function.gauss_newton_kernel, "single, Gauss-Newton"
        floats += [single(kernel, place, drawn.inside, drawn.outside, name)]
    singles = {
        f"{b.name}, one at a time": _one_at_a_time(b, drawn) for b in computed if b.name.startswith(TAKEN)
    }
    if weighting:
        branches = compare(expected, results[TAKEN])[0].branch.tolist()
        return (
            *accuracy(expected, results, drawn.refused),
            gradient(function, weighting, drawn.inside, results, branches),
            agreement(expected, results | singles),
            domain(function, drawn, computed, seed),
            singular_points(function, drawn, computed),
            *(not_applicable(name, weighting.mode.name) for name in ("differences", "Taylor")),
            *terms,
            *floats,
            _compiled(place),
        )
    return (
        *accuracy(expected, results, drawn.refused, has_jacobians=bool(function.kernel.variables)),
        agreement(expected, results | singles),
        domain(function, drawn, computed, seed),
        singular_points(function, drawn, computed),
        *(_slopes(function.graph, drawn, expected, computed, results) if function.kernel.variables else ()),
        *terms,
        *([in_place(function.kernel, place, batch(drawn.inside))] if function.kernel.in_place else []),
        *floats,
        _compiled(place),
    )


def _slopes(
    graph: Graph,
    drawn: Samples,
    expected: Expected,
    computed: Sequence[Backend],
    results: Mapping[str, Results],
) -> tuple[Check, Check]:
    """The checks of Jacobians by differences and by remainders, where the reference is finite."""
    taken = results[TAKEN]
    branches = compare(expected, taken)[0].branch.tolist()
    values = next(b for b in computed if b.name == f"{TAKEN}, value")
    usable = np.all([block.kept for block in expected.blocks], axis=0)
    smooth = [k for k in range(len(drawn.inside)) if usable[k]]
    kept = [drawn.inside[k] for k in smooth]
    jacobians = {name: array[smooth] for name, array in taken.items()}
    allowed = {b.name: b.bound[0][smooth] for b in expected.blocks if not b.is_value}
    return (
        differences(graph, kept, values.evaluate, jacobians),
        taylor(graph, kept, jacobians, [branches[k] for k in smooth], allowed),
    )


def _one_at_a_time(backend: Backend, drawn: Samples) -> Mapping[str, Array]:
    """The first ``SINGLE`` samples one by one, the rest as a batch."""
    arguments = batch(drawn.inside)
    results = dict(backend.evaluate(arguments))
    for k in range(min(SINGLE, len(drawn.inside))):
        for name, array in backend.evaluate({n: a[k] for n, a in arguments.items()}).items():
            results[name] = results[name].copy()
            results[name][k] = array
    return results


def _nothing(function: AnyFunction, drawn: Samples) -> Check:
    reasons = dict.fromkeys(entry.partition(": ")[2] for entry in drawn.refused)
    note = (
        f"{function.graph.site}: {function.name}: {'; '.join(reasons)}, "
        f"in all of {len(drawn.refused)} cases; correct it, or draw inside with @factor(sample=...)"
    )
    return Check("value", False, float("nan"), 0.0, "", "", 0, drawn.refused, note)


def _finite_nowhere(function: AnyFunction, results: Results) -> Check | None:
    """A failure where an output or a Jacobian is not finite at any sample, with line and cure."""
    if all(np.isfinite(a.reshape(len(a), -1)).all(axis=1).any() for a in results.values()):
        return None
    try:
        check_finite(function)
    except DomainError as error:
        return Check("value", False, float("nan"), 0.0, "", "", 0, note=str(error))
    return None


def _compiled(place: Workspace) -> Check:
    note = "" if place.library else "not checked: no C compiler (set CC, or install cc, gcc or clang)"
    checked = place.library is not None
    return Check("C", True, 0.0, 0.0, "", place.compiler, int(checked), note=note, checked=checked)
