"""The functions of a group module, written once for all groups.

Equation numbers are those of Sola, Deray, Atchuthan, "A micro Lie theory" (2018).
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Any

from liegen import manifolds
from liegen.algebra.linear import Matrix
from liegen.algebra.linear import Vector as Coordinates
from liegen.define import Function
from liegen.errors import SourceError
from liegen.manifolds import Group, Manifold, Value, Vector, matrix_class
from liegen.manifolds.form import Coords, GroupForm
from liegen.manifolds.node import Operation, apply
from liegen.manifolds.vector import vector_class
from liegen.trace import Signature

from .algebra import ad
from .sampling import sampler

AnyFunction = Function[..., Any]
Formula = Callable[..., Any]
#: From coordinates to the entries of a matrix, row-major.
Closed = Callable[[Coords], Coordinates]
#: Methods that apply an element to a vector, and its inverse; the first that a group has counts.
ACT = ("transform_from", "rotate")
TRANSFORM_TO = ("transform_to", "unrotate")


def groups() -> dict[str, type[Group]]:
    """The groups that have a module, by name: all that liegen knows but the vectors."""
    return {
        name: value
        for name, value in vars(manifolds).items()
        if isinstance(value, type)
        and issubclass(value, Group)
        and hasattr(value, "form")
        and not issubclass(value, Vector)
    }


def group_named(name: str) -> type[Group]:
    """The group of a name. Raises SourceError with the names that there are."""
    known = groups()
    if name not in known:
        near = difflib.get_close_matches(name.upper(), known, 1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise SourceError(f"there is no group {name!r}; {hint}there are: {', '.join(known)}")
    return known[name]


def every_function() -> dict[str, AnyFunction]:
    """The functions of all groups by name; other processes load them with it."""
    return {f.name: f for group in groups().values() for f in group_functions(group)}


@cache
def group_functions(group: type[Group]) -> tuple[AnyFunction, ...]:
    """All functions of a group: those with Jacobians, then those whose result is a matrix.

    Their names begin with the group's in lower case: ``se3_compose``. Actions on vectors are there for
    groups that have one.
    """
    return (*_operations(group), *_matrices(group))


def _operations(group: type[Any]) -> tuple[AnyFunction, ...]:
    tangent = vector_class(group.form.dim)

    def make(name: str, formula: Formula, doc: str, **arguments: type[Manifold]) -> AnyFunction:
        return _function(group, name, formula, doc, arguments, variable=True)

    actions = [
        make(name, formula, doc, x=group, p=vector_class(group.form.space))
        for name, methods, doc in (
            ("act", ACT, "x p: a vector of the body in the world."),
            ("transform_to", TRANSFORM_TO, "x^-1 p: a vector of the world in the body."),
        )
        for formula in [getattr(group, method) for method in methods if hasattr(group, method)][:1]
    ]
    return (
        make("compose", group.compose, "The product x y (micro Lie, eq. 63-64).", x=group, y=group),
        make("inverse", group.inverse, "The inverse x^-1 (micro Lie, eq. 62).", x=group),
        make("between", group.between, "x^-1 y: y as seen from x.", x=group, y=group),
        *actions,
        make("exp", group.exp, f"The exponential of a tangent vector of {group.__name__}.", d=tangent),
        make("log", group.log, "The logarithm, the short way round (micro Lie, eq. 79).", x=group),
        make(
            "retract",
            group.retract,
            "Where the tangent vector d at x leads (micro Lie, eq. 25, 82-83).",
            x=group,
            d=tangent,
        ),
        make(
            "local",
            group.local,
            "The tangent vector at x that leads to y (micro Lie, eq. 26, 84).",
            x=group,
            y=group,
        ),
    )


def _matrices(group: type[Any]) -> tuple[AnyFunction, ...]:
    form: GroupForm = group.form

    def make(name: str, show: str, closed: Closed, doc: str, argument: str = "d") -> AnyFunction:
        operation = Operation(name, matrix_class(form.dim, form.dim), closed, None, show, (group,))
        manifold = group if argument == "x" else vector_class(form.dim)

        def formula(v: Value) -> Value:
            return apply(operation, operation.result, v)

        return _function(group, name, formula, doc, {argument: manifold}, variable=False)

    def of_tangent(name: str, closed: Closed, doc: str) -> AnyFunction:
        return make(name, f"{group.__name__}.{name}({{0}})", closed, doc)

    poles = "Any rotation but 2 pi n, n >= 1, where it does not exist."
    return (
        make("adjoint", "{0}.adjoint()", _flat(form.adjoint_matrix), "Ad: x exp(d) = exp(Ad d) x.", "x"),
        of_tangent("ad", partial(ad, form), "ad: ad e = [d, e], and Ad of exp(d) is exp(ad)."),
        of_tangent("Jr", _flat(form.Jr), "Right Jacobian: exp(d + e) = exp(d) exp(Jr e) to first order."),
        of_tangent("Jl", _flat(form.Jl), "Left Jacobian: exp(d + e) = exp(Jl e) exp(d) to first order."),
        of_tangent("Jr_inv", _flat(form.Jr_inv), f"Inverse of the right Jacobian. {poles}"),
        of_tangent("Jl_inv", _flat(form.Jl_inv), f"Inverse of the left Jacobian. {poles}"),
    )


def _flat(closed: Callable[[Coords], Matrix]) -> Closed:
    return lambda c: tuple(x for row in closed(c) for x in row)


def _function(
    group: type[Group],
    name: str,
    formula: Formula,
    doc: str,
    arguments: Mapping[str, type[Manifold]],
    *,
    variable: bool,
) -> AnyFunction:
    """All arguments are positional; they are variables where there are Jacobians."""
    declared = tuple(Signature(n, m, variable, positional=True) for n, m in arguments.items())
    full = f"{group.__name__.lower()}_{name}"
    return Function(formula, declared, full, doc, False, sampler(group, arguments), in_place=True)
