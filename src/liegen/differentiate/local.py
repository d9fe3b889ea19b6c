"""Local Jacobian blocks: by an operation's rule, or by CasADi through the storage of its operands."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from liegen.algebra import Scalar
from liegen.algebra.casadi_backend import ca, scalar, symbol
from liegen.algebra.linear import Chain, Matrix, is_structural
from liegen.algebra.linear import Vector as Coordinates
from liegen.manifolds import ManifoldForm, Operation, Value

SX = Any


def symbols(name: str, n: int) -> Coordinates:
    """Fresh SX scalars."""
    return tuple(symbol(f"{name}{k}") for k in range(n))


def local_blocks(
    operation: Operation,
    result: Coordinates,
    operands: Sequence[Coordinates],
    manifolds: Sequence[type[Value]],
    wanted: Sequence[bool],
    *,
    through_storage: bool = False,
) -> list[Chain | None]:
    """The derivative of an operation's result by each wanted operand, in tangent spaces.

    ``through_storage`` ignores the rule: the independent second way that tests compare with.
    """
    if operation.blocks is not None and not through_storage:
        blocks = operation.blocks(result, *operands)
        return [chain if want else None for chain, want in zip(blocks, wanted, strict=True)]
    return _storage_blocks(operation, operands, manifolds, wanted)


def _storage_blocks(
    operation: Operation,
    operands: Sequence[Coordinates],
    manifolds: Sequence[type[Value]],
    wanted: Sequence[bool],
) -> list[Chain | None]:
    """d local(y, f(x.retract(d)))/dd at 0 = L(y) df/dx M(x), each factor by CasADi on fresh symbols."""
    fresh = [symbols(f"s{k}_", len(c)) for k, c in enumerate(operands)]
    value = operation.value(*fresh)
    symbolic = [
        ca.jacobian(ca.vertcat(*value), ca.vertcat(*x)) if want else None
        for x, want in zip(fresh, wanted, strict=True)
    ]
    lift = _from_storage(operation.result.form, value)
    blocks: list[Chain | None] = []
    for jacobian, x, manifold in zip(symbolic, fresh, manifolds, strict=True):
        if jacobian is None:
            blocks.append(None)
            continue
        factors = [m for m in (lift, jacobian, _to_storage(manifold.form, x)) if m is not None]
        blocks.append(tuple(_matrix(m, fresh, operands) for m in factors))
    return blocks


def _from_storage(form: ManifoldForm, y: Coordinates) -> SX | None:
    """L(y) = d local(y, u)/du at u = y; None for the identity."""
    if form.storage == form.tangent:
        return None
    lift = form.lift(y)
    if lift is not None:
        return ca.vertcat(*(ca.horzcat(*row) for row in lift))
    a, b, local = _local_slope(form)
    return ca.substitute(ca.substitute(local, b, ca.vertcat(*y)), a, ca.vertcat(*y))


def _to_storage(form: ManifoldForm, x: Coordinates) -> SX | None:
    """M(x) = d retract(x, d)/dd at d = 0; None for the identity."""
    if form.storage == form.tangent:
        return None
    a, slope = _retract_slope(form)
    return ca.substitute(slope, a, ca.vertcat(*x))


@cache
def _local_slope(form: ManifoldForm) -> tuple[SX, SX, SX]:
    a, b = symbols("a", form.size), symbols("b", form.size)
    value = ca.vertcat(*form.local(a, b))
    return ca.vertcat(*a), ca.vertcat(*b), ca.jacobian(value, ca.vertcat(*b))


@cache
def _retract_slope(form: ManifoldForm) -> tuple[SX, SX]:
    a, d = symbols("a", form.size), symbols("d", form.dim)
    slope = ca.jacobian(ca.vertcat(*form.retract(a, d)), ca.vertcat(*d))
    return ca.vertcat(*a), ca.substitute(slope, ca.vertcat(*d), ca.DM.zeros(form.dim))


def _matrix(m: SX, fresh: Sequence[Coordinates], actual: Sequence[Coordinates]) -> Matrix:
    """Put the actual operands into a symbolic matrix; zeros and ones become structure."""
    function = ca.Function("block", [ca.vertcat(*x) for x in fresh], [m])
    filled = function.call([ca.vertcat(*c) for c in actual], True, False)[0]
    rows, columns = filled.shape
    entries: list[list[Scalar]] = [[0] * columns for _ in range(rows)]
    row, column = filled.sparsity().get_triplet()
    for i, j, x in zip(row, column, filled.nonzeros(), strict=True):
        entries[i][j] = structural(scalar(x))
    return tuple(tuple(r) for r in entries)


def structural(x: Scalar) -> Scalar:
    """A constant SX 0, 1 or -1 as a structural integer."""
    if is_structural(x) or not x.is_constant():
        return x
    number = float(x)
    return int(number) if number in (0.0, 1.0, -1.0) else x
