"""What rounding leaves of a difference that should be 0, by the operations that it comes from.

x^-1 y of a stored rotation with itself is the identity to 1e-17 only, and R p + t - q is 0 to the rounding of
p, t and q. The direction of such a rest is noise, so the gradient of its norm there is 0, as at 0 itself.
Differences of stored numbers are exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import prod

from liegen.algebra import Scalar, sqrt
from liegen.algebra.linear import Vector as Coordinates
from liegen.algebra.linear import dot
from liegen.manifolds import ManifoldForm, Node, Operation
from liegen.trace import topological

#: A size: a number times the lengths of values, each to the power 1 or -1. The rounding is an ulp of it.
Term = tuple[float, tuple[tuple[Node, int], ...]]
Terms = tuple[Term, ...]
#: The sizes for each entry of a tangent; none where all but its own last digits is exact.
Entries = tuple[Terms, ...]

UNIT: Terms = ((1.0, ()),)
#: Operations whose results are numbers of the operands as they are stored.
_READ = frozenset((
    "take", "part", "stack", "product", "neg", "rotation", "translation", "position", "velocity", "time",
    "scale", "pose", "pose_of", "extended_pose", "event", "similarity", "vector",
))  # fmt: skip
_SUMS = frozenset(["add", "sub", "compose", "retract", "transform_from", "local_between"])
#: Sums that are differences of the numbers that are stored, where it is those that are given.
_DIFFERENCES = frozenset(["add", "sub", "between", "local", "transform_to"])
_SAME = frozenset(["neg", "abs", "inverse", "exp", "log"])


def near_zero(operation: Operation, size: Scalar) -> Operation:
    """The operation with its blocks for an operand that is known to the rounding of ``size``."""
    assert operation.near_zero is not None
    return replace(operation, blocks=operation.near_zero(size))


def size_of(node: Node, scalars: Mapping[int, Coordinates]) -> Scalar | None:
    """The size of what the operand of ``node`` is a difference of; None where that is exact."""
    known: dict[int, Entries] = {}
    for n in topological(node.operands):
        known[id(n)] = _entries(n, [known[id(m)] for m in n.operands])
    terms = _all(known[id(node.operands[0])])
    if not terms:
        return None
    if terms == UNIT:
        return 1.0
    squares = [
        prod([_square(n, scalars) ** power for n, power in factors], start=gain**2) for gain, factors in terms
    ]
    return sqrt(sum(squares[1:], start=squares[0]))


def _square(node: Node, scalars: Mapping[int, Coordinates]) -> Scalar:
    lengths = [scalars[id(node)][k] for k in _lengths(node.manifold.form)]
    return dot(lengths, lengths)


def _entries(node: Node, given: list[Entries]) -> Entries:
    name, dim = node.operation.name, node.manifold.form.dim
    if name == "take":
        taken: tuple[int, ...] = node.operation.parameters
        return tuple(given[0][k] for k in taken)
    if name == "stack":
        return tuple(entry for entries in given for entry in entries)
    if name in _SAME and len(given[0]) == dim:
        return given[0]
    if name == "mul":
        return _products(node, given)
    if name == "div":
        return tuple(_times(_at(given[0], k), node.operands[1], -1) for k in range(dim))
    below = _all(entry for entries in given for entry in entries)
    if name == "matmul":
        rows: list[list[float]] = node.operation.parameters[0]
        gain = max(sum(map(abs, row)) for row in rows)
        return (tuple((gain * g, factors) for g, factors in below),) * dim
    if name in ("rotate", "unrotate"):
        return (_all([*given[1], _times(_all(given[0]), node.operands[1], 1)]),) * dim
    if name in ("rotation", "translation", "position", "velocity"):
        angles = _angles(node.operands[0].manifold.form)
        asked = name == "rotation"
        return (_all(e for e, angle in zip(given[0], angles, strict=True) if angle is asked),) * dim
    if name in _SUMS | _DIFFERENCES:
        return _summed(node, below)
    return (below,) * dim


def _products(node: Node, given: list[Entries]) -> Entries:
    """Entry by entry, the rounding of one factor times the other."""
    a, b = node.operands
    return tuple(
        _all([_times(_at(given[0], k), b, 1), _times(_at(given[1], k), a, 1)])
        for k in range(node.manifold.form.dim)
    )


def _summed(node: Node, below: Terms) -> Entries:
    """Angles are rounded by an ulp of 1, other sums by one of what is added."""
    exact = node.operation.name in _DIFFERENCES
    added = [n for n in node.operands if not (exact and _read(n)) and _lengths(n.manifold.form)]
    moved = _all([below, tuple((1.0, ((n, 1),)) for n in added)])
    turned = _all([UNIT, moved])
    forms = [n.manifold.form for n in node.operands[:1]] if node.operation.name != "transform_to" else []
    angles = _angles(forms[0]) if forms and forms[0].dim == node.manifold.form.dim else ()
    if any(angles) and node.operation.parameters:  # a chart may have another order
        angles = (True,) * len(angles)
    return tuple(turned if angle else moved for angle in angles or (False,) * node.manifold.form.dim)


def _times(terms: Terms, node: Node, power: int) -> Terms:
    return tuple((gain, (*factors, (node, power))) for gain, factors in terms)


def _at(entries: Entries, k: int) -> Terms:
    return entries[k if len(entries) > 1 else 0]


def _all(entries: Iterable[Terms]) -> Terms:
    """All terms, each once, in their order."""
    return tuple(dict.fromkeys(term for terms in entries for term in terms))


def _read(node: Node) -> bool:
    """Whether a value is stored numbers, no result of a calculation."""
    return not node.operands or (node.operation.name in _READ and all(map(_read, node.operands)))


def _angles(form: ManifoldForm) -> tuple[bool, ...]:
    """Which entries of a tangent are angles, or the logarithm of a scale: they have no unit of length."""
    return tuple("[rad]" in t or "log scale" in t for t in form.tangent)


def _lengths(form: ManifoldForm) -> tuple[int, ...]:
    """Which stored numbers are not those of a unit quaternion, (cos, sin) or a direction."""
    if form.parts:
        starts = [sum(p.size for p in form.parts[:k]) for k in range(len(form.parts))]
        return tuple(s + k for s, p in zip(starts, form.parts, strict=True) for k in _lengths(p))
    unit = {q + k for q in form.quaternions for k in range(4)}
    unit |= {0, 1} if form.storage[:2] == ("c", "s") else set()
    return () if form.name == "S2" else tuple(k for k in range(form.size) if k not in unit)
