"""The matrices of a group by differences of exponentials and logarithms of matrices, in 80 digits."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .calls import Call, Rule
from .logarithms import PRINCIPAL
from .matrix import Element, Matrix, Number, Vector, length, mp, scale, transpose
from .spaces import GroupSpace, group_of

#: Truncation is the square of the step, rounding the working precision over the step.
STEP = 25


def _group(call: Call) -> GroupSpace:
    """The group that the operation names: its operand may be a plain vector."""
    return group_of(call.operation.parameters[0])


def _differenced(dim: int, curve: Callable[[Vector], Vector]) -> Matrix:
    """Columns (f(h e_k) - f(-h e_k)) / 2h."""
    h = mp.mpf(10) ** -STEP
    columns: list[Vector] = []
    for k in range(dim):
        forth, back = (curve(tuple(s if i == k else mp.zero for i in range(dim))) for s in (h, -h))
        columns.append(tuple((f - b) / (2 * h) for f, b in zip(forth, back, strict=True)))
    return transpose(tuple(columns))


def adjoint(group: GroupSpace, x: Element) -> Matrix:
    """Column k: the slope of log(x exp(t e_k) x^-1)."""
    back = group.inverse(x)

    def turned(e: Vector) -> Vector:
        return group.log(group.compose(group.compose(x, group.exp(e)), back), PRINCIPAL)

    return _differenced(group.dim(x), turned)


def ad(group: GroupSpace, d: Vector) -> Matrix:
    """|d| times the slope of Ad(exp(t d/|d|)) at 0: linear in d, so that tiny ones keep their digits."""
    size = length(d)
    if not size:
        return ((mp.zero,) * len(d),) * len(d)
    u = scale(1 / size, d)
    h = mp.mpf(10) ** -STEP
    forth, back = (adjoint(group, group.exp(scale(s, u))) for s in (h, -h))
    k: Number = size / (2 * h)
    return tuple(
        tuple(k * (f - b) for f, b in zip(*rows, strict=True)) for rows in zip(forth, back, strict=True)
    )


def right(group: GroupSpace, d: Vector) -> Matrix:
    """Column k: the slope of log(exp(d)^-1 exp(d + t e_k))."""
    back = group.inverse(group.exp(d))
    return _differenced(len(d), lambda e: group.log(group.compose(back, group.exp(_sum(d, e))), PRINCIPAL))


def left(group: GroupSpace, d: Vector) -> Matrix:
    """Column k: the slope of log(exp(d + t e_k) exp(d)^-1)."""
    back = group.inverse(group.exp(d))
    return _differenced(len(d), lambda e: group.log(group.compose(group.exp(_sum(d, e)), back), PRINCIPAL))


def _sum(a: Vector, b: Vector) -> Vector:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def inverted(a: Matrix) -> Matrix:
    """The inverse matrix; not a number where there is none."""
    try:
        return tuple(map(tuple, (mp.matrix(a) ** -1).tolist()))
    except ZeroDivisionError:
        return tuple((mp.nan,) * len(a) for _ in a)


def _rule(function: Callable[[GroupSpace, Element], Matrix]) -> Rule:
    return lambda call: function(_group(call), call.values[0])


def _inverse_rule(function: Callable[[GroupSpace, Vector], Matrix]) -> Rule:
    return lambda call: inverted(function(_group(call), call.values[0]))


OPERATIONS: Mapping[str, Rule] = {
    "adjoint": _rule(adjoint),
    "ad": _rule(ad),
    "Jr": _rule(right),
    "Jl": _rule(left),
    "Jr_inv": _inverse_rule(right),
    "Jl_inv": _inverse_rule(left),
}
