"""Defaults of a factor's arguments: constants that a call may leave out."""

from __future__ import annotations

from numbers import Real
from typing import Any

import numpy as np

from liegen.errors import DefinitionError
from liegen.manifolds import Manifold, Value
from liegen.manifolds.given import spoken
from liegen.manifolds.node import batch_of, called, has_numbers


def default_of(given: Any, manifold: type[Manifold], what: str, *, variable: bool) -> Value | None:
    """The default of an argument; None where it has none, which ``inspect`` marks by ``Parameter.empty``.

    A given argument may have one: a typed value, or a number for a scalar. Raises DefinitionError, which
    begins with ``what``, for any other, and for a variable.
    """
    if isinstance(given, type) and given.__name__ == "_empty":
        return None
    name = manifold.form.name
    if variable:
        raise DefinitionError(
            f"{what} is a variable and has a default, but a call always gives the variables; "
            "put it after the * if it is only given, or remove the default"
        )
    number = type(given) is not bool and isinstance(given, Real)
    scalar = number and manifold.form.size == 1
    value = manifold.from_storage(given) if scalar else given
    if not isinstance(value, Value):
        cure = f"write a typed value, as in {manifold.__name__}(...)"
        raise DefinitionError(f"{what} has {spoken(given)} as its default, it needs one {name}; {cure}")
    if value.form != manifold.form:
        raise DefinitionError(f"{what} has the default {called(value)}, it needs one {name}")
    constant(value, f"{what}: the default")
    return value


def constant(value: Value, what: str) -> None:
    """Raise DefinitionError, which begins with ``what``, unless it is one element with finite numbers."""
    if not has_numbers(value):
        raise DefinitionError(f"{what} is a value of another formula, which has no numbers")
    if batch_of(value):
        raise DefinitionError(f"{what} is a batch of shape {batch_of(value)}; give one {value.form.name}")
    if not all(np.isfinite(float(c)) for c in value.coords):
        raise DefinitionError(f"{what} is not finite: {value!r}")
