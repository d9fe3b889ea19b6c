"""Operations that are cheaper as one, Jacobians included: z.local(x.between(y)), x.retract(a x.local(y))."""

from __future__ import annotations

from collections.abc import Callable

from liegen.algebra.linear import Chain, Vector, column, eye, matadd, negate, product, scale

from .form import Compute, Coords, GroupForm, Rule

#: The blocks by z, x and y from the result and the operands.
RelativeRule = Callable[[Coords, Coords, Coords, Coords], tuple[Chain, Chain, Chain]]


def relative_rule(form: GroupForm) -> RelativeRule:
    """d/dz = -Jl^-1(r), d/dx = -Jr^-1(r) Ad(c^-1), d/dy = Jr^-1(r) with c = x^-1 y."""
    minus = tuple(negate(row) for row in eye(form.dim))

    def blocks(r: Coords, z: Coords, x: Coords, y: Coords) -> tuple[Chain, Chain, Chain]:
        own = form.Jr_inv(r, principal=True)
        by_x = (minus, own, *form.adjoint_inverse(form.between(x, y)))
        return (minus, form.Jl_inv(r, principal=True)), by_x, (own,)

    return blocks


def interpolation(form: GroupForm) -> tuple[Compute, Rule]:
    """Value and rule of x exp(a log(x^-1 y)) on (x, y, a).

    d/dy = a Jr(a r) Jr^-1(r) with r = log(x^-1 y), d/dx = I - d/dy (with x and y moved on the right by the
    same e the result moves by e), d/da = r.
    """

    def value(x: Coords, y: Coords, a: Coords) -> Vector:
        return form.compose(x, form.exp(scale(a[0], form.local(x, y))))

    def blocks(_: Coords, x: Coords, y: Coords, a: Coords) -> tuple[Chain, Chain, Chain]:
        r = form.local(x, y)
        by_y = product(form.part_way(r, a[0]))
        by_x = matadd(eye(form.dim), tuple(negate(row) for row in by_y))
        return (by_x,), (by_y,), (column(r),)

    return value, blocks
