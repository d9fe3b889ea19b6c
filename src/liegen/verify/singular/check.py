"""The check at singular points: finite everywhere, and right where there is a derivative.

What a factor declares with ``singular`` and what an operation documents as a hole are left out, by name.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.algebra.casadi_backend import ca
from liegen.manifolds import Node
from liegen.trace import Singular

from .. import reference
from ..backends import Backend
from ..compiled import STATUS
from ..draws import AnyFunction, Samples, batch
from ..natural import is_natural
from ..report import Check
from ..sanity import first_not_finite
from .candidates import Hit, solve
from .compared import wrong
from .cures import Texts, cure, has_cure, hole_of
from .points import Point
from .scale import edges, in_range
from .solve import Arguments

Array = NDArray[np.float64]

NAME = "singular points"
#: An expression that ``singular`` names is 0 below this.
ZERO = 1e-7
#: A finite result that is larger than the arguments by this is that of a pole which no double hits.
POLE = 1e12
#: Points that are named in a message.
NAMED = 3


@dataclass(frozen=True, eq=False)
class Culprit:
    """An operation that is not finite at a hit; ``lacks`` a value, a slope, or only a bound (a pole)."""

    node: Node
    point: Point
    hit: Hit
    lacks: str


def singular_points(function: AnyFunction, drawn: Samples, computed: Sequence[Backend]) -> Check:
    """Solve for singular points, and evaluate every back end there. ``worst`` counts points that fail."""
    hits, space = solve(function, drawn.inside)
    hits = _inside(function, hits)
    texts = Texts(function.plain)
    bad, large = _not_finite(computed, hits)
    poles = large & ~edges(space, [h.row for h in hits])
    found: dict[int, Culprit] = {}
    left: dict[str, None] = {}
    good: list[Hit] = []
    for hit, is_bad, is_pole in zip(hits, bad, poles, strict=True):
        if not is_bad and (hit.away or not is_pole):
            good.append(hit)
            continue
        if not _in_domain(function, hit):
            continue
        culprit = _culprit(function, hit, is_bad=bool(is_bad))
        if not is_bad and not has_cure(culprit.node) and not hole_of(culprit.node):
            continue
        reason = hole_of(culprit.node) or _declared(function, space, hit)
        if reason:
            left.setdefault(f"{_place(texts, culprit.point)}: {reason}")
        elif id(culprit.node) not in found or _fits(culprit) > _fits(found[id(culprit.node)]):
            found[id(culprit.node)] = culprit
    off = wrong(function, [h for h in good if _in_domain(function, h)], computed)
    messages = [_message(texts, c) for c in found.values()]
    messages += [f"{_places(texts, hit)}: {what}" for hit, what in off]
    stated = "; ".join(f"declared singular: {s.message} ({s.site})" for s in function.plain.singular)
    note = "; ".join(messages[:NAMED]) + ("; ..." if len(messages) > NAMED else "") if messages else stated
    where = (
        _places(texts, next(iter(found.values())).hit) if found else _places(texts, off[0][0]) if off else ""
    )
    return Check(
        NAME, not messages, float(len(messages)), 0.0, "", where, len(hits) - len(left), tuple(left), note
    )


def _inside(function: AnyFunction, hits: Sequence[Hit]) -> tuple[Hit, ...]:
    """The hits in the stated domain, as the program tells it, at which doubles do not underflow."""
    if not hits:
        return ()
    arrays = batch(tuple(h.sample("") for h in hits))
    with np.errstate(all="ignore"):
        held = in_range(function.kernel.jacobians, arrays)
        status = function.kernel.value.evaluate({n: tuple(a.T) for n, a in arrays.items()})["status"]
        for condition in status:
            held &= np.asarray(condition) != 0
    return tuple(h for h, inside in zip(hits, held, strict=True) if inside)


def _in_domain(function: AnyFunction, hit: Hit) -> bool:
    """Whether the reference says so too, and roots and logarithms have real values."""
    evaluation = reference.evaluate(function.graph, hit.values)
    return all(evaluation.holds) and is_natural(evaluation)


def _not_finite(
    computed: Sequence[Backend], hits: Sequence[Hit]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """By hit, whether any back end gives an entry that is not finite, and one as large as a pole's."""
    bad, large = (np.zeros(len(hits), dtype=np.bool_) for _ in range(2))
    if not hits:
        return bad, large
    arguments = batch(tuple(h.sample("") for h in hits))
    size = np.max([np.abs(a).max(axis=1) for a in arguments.values()], axis=0)
    for backend in computed:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            results: Mapping[str, Any] = backend.evaluate(arguments)
        for name, array in results.items():
            if name != STATUS:
                flat = np.abs(array.reshape(len(hits), -1))
                bad |= ~np.isfinite(flat).all(axis=1)
                large |= (flat > POLE * np.maximum(1.0, size)[:, None]).any(axis=1)
    return bad, large


def _culprit(function: AnyFunction, hit: Hit, *, is_bad: bool) -> Culprit:
    """The first operation that is not finite, else the one whose singular point it is."""
    graph = function.plain
    node = first_not_finite(graph, hit.values, derivative=True)
    value = first_not_finite(graph, hit.values, derivative=False)
    own = next((p for p in hit.points if p.node is node), hit.points[0])
    if node is None:
        return Culprit(own.node, own, hit, "slope" if is_bad else "pole")
    return Culprit(node, own, hit, "value" if value is node else "slope")


def _fits(culprit: Culprit) -> int:
    """How well a point explains an operation: best where it is its own, alone, and exactly there."""
    return (
        4 * (culprit.point.node is culprit.node) + 2 * (len(culprit.hit.points) == 1) + (not culprit.hit.away)
    )


def _declared(function: AnyFunction, space: Arguments, hit: Hit) -> str:
    """The message of the first ``singular`` that speaks of this hit."""
    for stated in function.plain.singular:
        if not stated.zeros or _vanishes(space, stated, hit):
            return f"declared singular: {stated.message}"
    return ""


def _vanishes(space: Arguments, stated: Singular, hit: Hit) -> bool:
    entries = [x for node in stated.zeros for x in space.scalars[id(node)]]
    value = ca.Function("zeros", [space.stored], [ca.vertcat(*entries)])(hit.row)
    return bool(np.abs(np.array(value)).max() <= max(ZERO, 10 * hit.away))


def _place(texts: Texts, point: Point) -> str:
    """``where norm(d) is 0, factors.py:7``."""
    return f"where {_where(point, texts.of(*point.node.operands))}, {point.node.site}"


def _where(point: Point, text: Callable[[Node], str]) -> str:
    return point.place.where.format(*map(text, point.node.operands))


def _places(texts: Texts, hit: Hit) -> str:
    near = f"{hit.away:g} away from the point " if hit.away else ""
    return near + " and ".join(_place(texts, point) for point in hit.points)


def _message(texts: Texts, culprit: Culprit) -> str:
    """Line, operation and cure."""
    node, point = culprit.node, culprit.point
    text = texts.of(node, *point.node.operands)
    what = {"value": "no finite value", "slope": "no finite derivative", "pole": "no bound"}[culprit.lacks]
    said = f"{texts.definition(node)} has {what} where {_where(point, text)}"
    named = texts.named(said, [node, point.node])
    return (
        f"{node.site}: {said}{named}: "
        f'{cure(node, text)}, or, where there is none by its nature, state singular("...")'
    )
