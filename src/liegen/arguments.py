"""What a call gives to a function: typed values from arrays, with errors that name the argument."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from keyword import iskeyword
from math import prod
from typing import Any

import numpy as np

from liegen.errors import DefinitionError
from liegen.layouts import Storage
from liegen.manifolds import Manifold, Value
from liegen.manifolds.given import real_numbers
from liegen.manifolds.node import batch_of, called, shown_storage
from liegen.trace import Signature


def bound(
    call: str, free: Sequence[Signature], args: tuple[Any, ...], kwargs: Mapping[str, Any]
) -> dict[str, Any]:
    """What is given to each free argument, defaults where nothing is.

    ``call`` is where the call is and whom it calls. Raises DefinitionError for missing and unknown arguments.
    """
    positional = [s.name for s in free if s.variable] or [s.name for s in free]
    given = dict(zip(positional, args, strict=False)) | dict(kwargs)
    missing = [s.name for s in free if s.name not in given and s.default is None]
    unknown = [k for k in given if k not in {s.name for s in free}]
    if missing or unknown or len(args) > len(positional) or len(given) < len(args) + len(kwargs):
        named = [f"{s.name}=" if s.default is None else f"[{s.name}=]" for s in free
                 if s.name not in positional]  # fmt: skip
        twice = [name for name in positional[: len(args)] if name in kwargs]
        found = {"missing": missing, "unknown": unknown, "given twice": twice}
        problems = [f"{what} {', '.join(names)}" for what, names in found.items() if names]
        too_many = [f"{len(args)} arguments without a name"] if len(args) > len(positional) else []
        why = "; ".join([*problems, *too_many])
        where, _, name = call.rpartition(": ")
        raise DefinitionError(f"{where}: call it as {name}({', '.join([*positional, *named])}) ({why})")
    return {s.name: given.get(s.name, s.default) for s in free}


def coerced(
    what: str, manifold: type[Manifold], stored: Storage, shape: tuple[int, ...], given: Any
) -> Value:
    """The typed value of an array (..., *shape) in the argument's layout, or a typed value as it is.

    Raises DefinitionError, which begins with ``what``, for anything else.
    """
    if isinstance(given, Value):
        if given.form != manifold.form:
            raise DefinitionError(f"{what} must be {manifold.form.name}, got {called(given)}")
        return given
    names = f" ({shown_storage(stored.names)})" if len(shape) == 1 else ""
    needed = f"{what}: an array of shape (..., {', '.join(map(str, shape))}) is needed{names}"
    numbers = real_numbers(given, needed)
    if numbers.ndim == 0 and shape == (1,):
        numbers = numbers[None]
    if numbers.shape[-len(shape) :] != shape:
        cure = "; a batch of scalars is array[:, None]" if shape == (1,) else ""
        raise DefinitionError(f"{needed}, this one has shape {numbers.shape}{cure}")
    flat = numbers.reshape(*numbers.shape[: numbers.ndim - len(shape)], prod(shape))
    coords = [flat[..., k][()] for k in range(flat.shape[-1])]
    return manifold.holding(coords if stored.own else stored.read(coords))


def check_batches(call: str, values: Mapping[str, Value]) -> None:
    """Raise DefinitionError unless the leading dimensions broadcast, and for a batch inside of a formula."""
    batches = {name: batch_of(v) for name, v in values.items() if not v.traced}
    if len(batches) < len(values):
        for name, batch in batches.items():
            if batch:
                raise DefinitionError(
                    f"{call}: argument {name!r} is a batch of shape {batch}; a formula is of single elements"
                )
    try:
        np.broadcast_shapes(*batches.values())
    except ValueError:
        got = ", ".join(f"{name} {batch}" for name, batch in batches.items())
        raise DefinitionError(f"{call}: leading dimensions do not broadcast: {got}") from None


def text_of(given: Any, what: str) -> str:
    """A text that a user gives. Raises DefinitionError, which begins with ``what``, for another type."""
    if not isinstance(given, str):
        raise DefinitionError(f"{what} is a text, got {given!r}")
    return given


def name_of(given: Any, what: str) -> str:
    """A name that a user gives, or none. Raises DefinitionError for what is no identifier."""
    name = text_of(given, what)
    if name and (not name.isidentifier() or iskeyword(name)):
        raise DefinitionError(f"{what} is a name in Python, with letters, digits and _, got {given!r}")
    return name


def known(call: str, names: Collection[Any], possible: Sequence[str]) -> None:
    """Raise DefinitionError for a name that no argument has."""
    for name in names:
        if name not in possible:
            raise DefinitionError(f"{call} has no free argument {name!r}; it has {', '.join(possible)}")


def callable_of(given: Any, what: str) -> Any:
    """A function that a user gives, or none. Raises DefinitionError, which begins with ``what``."""
    if given is not None and not callable(given):
        raise DefinitionError(f"{what} is a function (draw, case) -> {{argument: value}}, got {given!r}")
    return given
