"""Hold foreign Jacobians against those of a formula, and say where and why they differ."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.define import Function
from liegen.errors import DefinitionError
from liegen.trace import Parameter

from . import tangents
from .ambient import as_tangent
from .calls import Foreign
from .conditions import condition
from .explanations import Explanation, Subject, explained
from .explanations.difference import applied
from .explanations.elsewhere import Elsewhere, elsewhere
from .explanations.search import agreeing
from .explanations.whole import Whole, whole_convention
from .places import instead, located
from .points import Sampled, Values, at, every
from .sampling import ZERO, judged_at, sampled

Array = NDArray[np.float64]
#: Other explanations of as much that are told.
_SAME = 4


@dataclass(frozen=True)
class Finding:
    """One output: how far it is off, where, and why.

    ``worst`` is the largest absolute difference relative to max(1, largest entry of the expected array);
    ``entry``, ``expected``, ``found`` and ``sample`` are those of the worst. ``differences`` explain all that
    differs; empty where none of the ``tried`` explanations does, or where nothing differs. ``same`` are other
    explanations of as much. ``charts`` are those in which the output is correct. ``where`` tells the samples
    at which it differs, ``what`` the entries that differ there, and what they are instead.
    """

    name: str
    correct: bool
    worst: float
    entry: tuple[int, ...]
    expected: float
    found: float
    sample: str
    differences: tuple[str, ...] = ()
    same: tuple[str, ...] = ()
    charts: tuple[str, ...] = ()
    tried: int = 0
    where: str = ""
    what: str = ""
    correct_at_zero: bool = False

    @property
    def verdict(self) -> str:
        """In a few words."""
        if self.correct:
            return "correct"
        named = f" (chart {' or '.join(self.charts)})" if self.charts else ""
        why = "; ".join(self.differences) + named
        if self.differences and not self.where:
            return why
        if self.differences or not self.tried:
            return f"{why or 'correct'}, except {self.where}: there {self.what}"
        if self.where.startswith("where "):
            return f"correct, except {self.where}: there {self.what}"
        zero = "wrong away from zero residual" if self.correct_at_zero else "wrong"
        return f"{zero}, none of {self.tried} known explanations fits: {self.what}, {self.where}"


@dataclass(frozen=True)
class Comparison:
    """What was found of the residual and of each Jacobian.

    ``samples`` is their number, ``left_out`` how many more were left out, by the reason. ``convention`` is
    the chart and layout in which all outputs are correct, where they are not in the factor's own; ``options``
    are those of the command that ask for it.
    """

    factor: str
    samples: int
    tolerance: float
    findings: tuple[Finding, ...]
    left_out: tuple[tuple[str, int], ...] = ()
    convention: str = ""
    options: str = ""

    @property
    def passed(self) -> bool:
        """Whether all is correct."""
        return all(f.correct for f in self.findings)

    def as_json(self) -> dict[str, Any]:
        """The same with plain types."""
        return {**asdict(self), "passed": self.passed}


def compare(
    function: Function[..., Any],
    foreign: Foreign,
    *,
    samples: int = 24,
    seed: int = 0,
    tolerance: float = 1e-7,
) -> Comparison:
    """Hold a foreign function against a factor.

    ``samples`` are random; beside them are special ones: small angles, half a turn, turns about one axis,
    the identity, and random ones that are solved for a zero residual. Raises DefinitionError for a function
    with several outputs, for a tolerance that is no number above 0, or when no sample is finite; ToolError
    where the foreign function fails at a random sample.
    """
    if len(function.graph.outputs) != 1:
        raise DefinitionError(f"{function.name} has several outputs; check-jacobian is for one residual")
    if not 0.0 < tolerance < np.inf:
        raise DefinitionError(f"tolerance={tolerance!r}: the tolerance is a number above 0")
    held, notes = as_tangent(function, sampled(function, foreign, samples, seed))
    subjects = _subjects(function, held)
    wrong = [not _agrees(s, tolerance) for s in subjects]
    whole = whole_convention(subjects, tolerance) if any(wrong) else None
    places = elsewhere(function, held) if any(wrong) else ()
    findings = tuple(_finding(function, foreign, s, notes[s.k], places, whole, tolerance) for s in subjects)
    return Comparison(
        function.name,
        len(held.kinds),
        tolerance,
        findings,
        held.left_out,
        whole.text if whole else "",
        whole.options if whole else "",
    )


def _subjects(function: Function[..., Any], held: Sampled) -> list[Subject]:
    variables: list[Parameter | None] = [None, *function.graph.variables]
    return [Subject(function, held, k, variable) for k, variable in enumerate(variables)]


def _agrees(subject: Subject, tolerance: float) -> bool:
    return bool(agreeing(subject, subject.expected, tolerance).all())


def _name(subject: Subject) -> str:
    output = subject.function.graph.outputs[0][0]
    return output if subject.variable is None else f"{output}_D_{subject.variable.name}"


def _finding(
    function: Function[..., Any],
    foreign: Foreign,
    subject: Subject,
    note: str,
    places: tuple[Elsewhere, ...],
    whole: Whole | None,
    tolerance: float,
) -> Finding:
    held = subject.sampled
    good = agreeing(subject, subject.expected, tolerance)
    zero = np.array([kind == ZERO for kind in held.kinds])
    at_zero = bool(zero.any()) and bool(good[zero].all())
    finding = replace(_worst(subject), correct=bool(good.all()) and not note, correct_at_zero=at_zero)
    if finding.correct:
        return finding
    if note and good.all():
        return replace(finding, differences=(note,))
    found = explained(subject, places, tolerance)
    phrases = (*found.phrases, note) if note else found.phrases
    charts = tuple(dict.fromkeys(c for d in found.differences for c in d.charts)) if _one_chart(found) else ()
    if whole is not None and (not phrases or found.misses.any()):
        phrases, charts = (f"it is that of {whole.text}",), ()
        found = replace(found, misses=np.zeros_like(found.misses))
    others = (*(d.same for d in found.differences if len(found.differences) == 1),
              *((d.text, *d.same) for d in found.same))  # fmt: skip
    same = tuple(text for texts in others for text in texts)[:_SAME]
    finding = replace(finding, differences=phrases, same=same, charts=charts, tried=found.tried)
    if phrases and not found.misses.any():
        return finding
    right = agreeing(subject, applied(found.differences, subject.expected), tolerance)
    judge = None if found.differences else _judge(function, foreign, subject, tolerance)
    return _with_place(finding, function, subject, found, right, judge)


def _one_chart(found: Explanation) -> bool:
    return sum(bool(d.charts) for d in found.differences) == 1


def _worst(subject: Subject) -> Finding:
    held = subject.sampled
    expected, found = subject.expected[held.firsts], subject.found
    best = expected.copy()
    for k in np.flatnonzero(held.near_jump):  # the side of the jump that is nearer
        sides = subject.expected[held.owners == k]
        best[k] = sides[int(np.argmin([np.abs(side - found[k]).max() for side in sides]))]
    with np.errstate(all="ignore"):
        errors = np.abs(found - best) / np.maximum(1.0, np.abs(best).max(axis=(1, 2), keepdims=True))
    errors = np.where(np.isfinite(found), errors, np.inf)
    k, i, j = (int(n) for n in np.unravel_index(int(np.argmax(errors)), errors.shape))
    values = ", ".join(
        f"{n} = {np.asarray(v).tolist()}" for n, v in at(held.values, int(held.firsts[k])).items()
    )
    told = f" (it raised: {held.raised[k]})" if held.raised[k] else ""
    entry = (i,) if subject.variable is None else (i, j)
    return Finding(
        _name(subject), False, float(errors[k, i, j]), entry, float(best[k, i, j]), float(found[k, i, j]),
        values + told,
    )  # fmt: skip


def _with_place(
    finding: Finding,
    function: Function[..., Any],
    subject: Subject,
    found: Explanation,
    right: NDArray[np.bool_],
    judge: Any,
) -> Finding:
    held = subject.sampled
    misses = ~every(right)
    expected = applied(found.differences, subject.expected)[held.firsts]
    wrong = ~right & misses[:, None, None]
    some: NDArray[np.bool_] = np.asarray(wrong[misses].any(axis=0), dtype=bool)
    p = subject.variable
    columns = tangents.names(p.manifold.form, p.chart) if p else ()
    blocks = tangents.blocks(p.manifold.form, p.chart) if p else ()
    place = located(some, columns, blocks)
    mask = np.broadcast_to(some, expected[misses].shape)
    value = instead(expected[misses], subject.found[misses], mask) or instead(
        expected[misses], subject.found[misses], wrong[misses]
    )
    whole = place.startswith(("entries in all", "all entries"))
    one = not any(word in place for word in ("columns", "rows", "entries"))
    if value:
        what = f"{'all entries' if whole else place} {'is' if one else 'are'} {value}"
    else:
        what = f"{place} {'differs' if one else 'differ'}"
    if misses.all():
        where = "at all samples"
    elif misses[held.general].all() and not found.differences:
        where = "at all random samples"  # at some special ones what is wrong is multiplied by 0
    else:
        where = condition(function, held, misses, judge)
    return replace(finding, where=where, what=what)


def _judge(function: Function[..., Any], foreign: Foreign, subject: Subject, tolerance: float) -> Any:
    """Whether the output is right at another point."""

    def judge(values: Values) -> bool | None:
        both = judged_at(function, foreign, values)
        if both is None:
            return None
        exact, found = (arrays[subject.k] for arrays in both)
        if exact.shape != np.shape(found):
            return None
        error = np.abs(found - exact) / max(1.0, float(np.abs(exact).max(initial=0.0)))
        return bool((error <= tolerance).all())

    return judge
