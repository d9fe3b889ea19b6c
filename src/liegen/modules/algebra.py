"""The Lie algebra of a group, read off its adjoint, so that a new group needs no further closed form."""

from __future__ import annotations

from functools import cache

from liegen.algebra import Scalar
from liegen.algebra.casadi_backend import ca
from liegen.algebra.linear import Matrix, Vector, dot
from liegen.differentiate.local import symbols
from liegen.manifolds.form import Coords, GroupForm

#: What rounding leaves of an integer.
ROUNDING = 1e-12


@cache
def structure_constants(form: GroupForm) -> Matrix:
    """d Ad(exp(d))/dd at 0: a row for each entry of Ad, row-major, a column for each coordinate of d."""
    d = symbols("d", form.dim)
    entries = [x for row in form.adjoint_matrix(form.exp(d)) for x in row]
    slope = ca.jacobian(ca.SX(ca.vertcat(*entries)), ca.vertcat(*d))
    numbers = ca.Function("slope", [ca.vertcat(*d)], [slope])(0).full()
    return tuple(tuple(_known(float(x)) for x in row) for row in numbers)


def _known(x: float) -> Scalar:
    """Integers are structure: a product with 0 or 1 costs nothing."""
    return round(x) if abs(x - round(x)) < ROUNDING else x


def ad(form: GroupForm, d: Coords) -> Vector:
    """The matrix of the bracket, ad_d e = [d, e], row-major; Ad(exp(d)) = I + ad_d to first order."""
    return tuple(dot(row, d) for row in structure_constants(form))
