"""What operations on vectors ask of the frames of their operands, and the frame of their result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NoReturn

from .frame_names import Kind
from .frame_step import Step
from .frame_terms import Framed, common, made_of, sought, vector

FREE = (Kind.FREE, Kind.DIFFERENCE)
Rule = Callable[[Step], Framed]


def one_frame(s: Step) -> Framed:
    """Vectors in one frame; scalars fit anywhere. The first of them."""
    dim = s.node.manifold.form.dim
    dims = [n.manifold.form.dim for n in s.node.operands]
    wide = max((n for n in dims if n), default=dim)
    places = [k for k, n in enumerate(dims) if n == wide]
    if wide == 1:  # angles and other numbers
        known = (x for x in s.operands if s.solver.name(x.outer))
        return next(known, s.operands[places[0]])
    for k in places[1:]:
        first, other = s.operands[places[0]], s.operands[k]
        if not s.solver.equal(first.outer, other.outer):
            _differ(s, places[0], k)
    return s.operands[places[0]]


def _differ(s: Step, i: int, k: int) -> NoReturn:
    (a, b), (x, y) = (s.operands[i], s.operands[k]), (s.texts[i], s.texts[k])
    ways = (s.route(k, b.kind, a.outer), s.route(i, a.kind, b.outer))
    # rather an argument than what was computed
    route = next(filter(None, ways if not s.node.operands[k].operands else ways[::-1]), None)
    cure = f"write {route}" if route else s.cure(None)
    s.refuse(f"{x} is in {s.solver.name(a.outer)}, {y} is in {s.solver.name(b.outer)}; {cure}")


def _add(s: Step) -> Framed:
    x = one_frame(s)
    a, b = s.kind(0), s.kind(1)
    if _scalar_with_vector(s) or Kind.OPEN in (a, b):
        return vector(x.outer, Kind.OPEN)
    points = (a, b).count(Kind.POINT)
    return vector(x.outer, (_both(a, b), Kind.POINT, Kind.OPEN)[points])


def _sub(s: Step) -> Framed:
    x = one_frame(s)
    return _minus(s, x, 0, 1)


def _minus(s: Step, x: Framed, i: int, j: int) -> Framed:
    """Operand i minus operand j."""
    a, b = s.kind(i), s.kind(j)
    if _scalar_with_vector(s) or Kind.OPEN in (a, b):
        return vector(x.outer, Kind.OPEN)
    if b is Kind.POINT and a in FREE:
        s.refuse(
            f"{s.texts[i]} is a free vector and {s.texts[j]} a point, both in {s.solver.name(x.outer)}: "
            "their difference is neither; move points with a pose (a rotation alone gives the vector from "
            "the origin), subtract the other way round, or give a point a name such as p_W"
        )
    if b is Kind.POINT:
        return vector(x.outer, Kind.DIFFERENCE if a is Kind.POINT else Kind.OPEN)
    return vector(x.outer, Kind.POINT if a is Kind.POINT else _both(a, b))


def _both(a: Kind, b: Kind) -> Kind:
    return a if a is b else Kind.FREE


def _scalar_with_vector(s: Step) -> bool:
    dims = {n.manifold.form.dim for n in s.node.operands}
    return len(dims) > 1


def _scaled(s: Step) -> Framed:
    """A multiple of a point is none; a multiple of a free vector is one."""
    x = one_frame(s)
    wide = [k for k, n in enumerate(s.node.operands) if n.manifold.form.dim == s.node.manifold.form.dim]
    divides = s.node.operation.name == "div" and wide[-1] == 1
    if len(wide) == 1 and not divides:
        return replace(_multiple(s.operands[wide[0]]), outer=x.outer, inner=x.inner)
    return vector(x.outer, Kind.OPEN)


def _choice(s: Step) -> Framed:
    x = one_frame(s)
    kinds = [s.kind(k) for k, n in enumerate(s.node.operands) if n.manifold.form.dim]
    return vector(x.outer, common(kinds))


def _cross(s: Step) -> Framed:
    x = one_frame(s)
    return vector(x.outer, Kind.OPEN if Kind.OPEN in (s.kind(0), s.kind(1)) else Kind.FREE)


def _number(s: Step) -> Framed:
    one_frame(s)
    return sought()


def _take(s: Step) -> Framed:
    """A part of a vector in a known frame is in that frame; single entries are numbers."""
    x, positions = s.operands[0], s.node.operation.parameters
    if len(positions) == 1:
        return sought()
    first, last = min(positions), max(positions)
    for part in x.flat():
        if (part.start, part.stop) == (first, last + 1):
            return part.value
        if part.start <= first and last < part.stop:
            x = part.value
    if s.solver.name(x.outer) is None:
        return sought()
    return vector(x.outer, Kind.FREE if x.kind is Kind.TANGENT else x.kind)


def _stack(s: Step) -> Framed:
    """Vectors of one declared frame keep it, as in a twist; anything else is in none."""
    dims = [n.manifold.form.dim for n in s.node.operands]
    joined = made_of(s.operands, dims)
    names = {s.solver.name(x.outer) if s.solver.declared(x.outer) else None for x in s.operands}
    if len(names) > 1 or None in names or 1 in dims:
        return joined
    return replace(vector(s.operands[0].outer, Kind.OPEN), parts=joined.parts)


def first(s: Step) -> Framed:
    """The frames of the first operand."""
    return s.operands[0]


def _negative(s: Step) -> Framed:
    return _multiple(s.operands[0])


def _multiple(x: Framed) -> Framed:
    """A multiple of a point is none, all else keeps its kind."""
    kind = Kind.OPEN if x.kind is Kind.POINT else x.kind
    return replace(x, kind=kind, parts=tuple(replace(p, value=_multiple(p.value)) for p in x.parts))


def _reversed_sub(s: Step) -> Framed:
    """other - self."""
    return _minus(s, one_frame(s), 1, 0)


#: The rules by operation.
VECTORS: Mapping[str, Rule] = {
    "compose": _add, "inverse": _negative, "between": _reversed_sub, "local": _reversed_sub, "retract": _add,
    "add": _add, "sub": _sub, "neg": _negative, "mul": _scaled, "div": _scaled, "dot": _number,
    "norm": _number, "cross": _cross, "minimum": _choice, "maximum": _choice, "where": _choice, "take": _take,
    "stack": _stack,
}  # fmt: skip
