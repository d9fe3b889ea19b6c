"""The rule of z.local(x.between(y)) as one operation, for groups that offer it (``local_between``)."""

from __future__ import annotations

from collections.abc import Callable

from liegen.algebra.linear import Chain, eye, negate

from .form import Coords, GroupForm

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
