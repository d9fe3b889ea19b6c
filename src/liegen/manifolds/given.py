"""What a user gives where numbers are wanted: real numbers in, a clear error for anything else."""

from __future__ import annotations

from numbers import Real
from operator import index
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.errors import DefinitionError

#: The largest dimension of a vector: longer ones are a batch and a sum over it.
LARGEST = 1000
#: What NumPy's kinds of numbers are called, that are no real ones.
_KINDS = {"c": "complex numbers", "U": "text", "S": "text", "M": "dates", "m": "times"}


def real_numbers(given: Any, what: str) -> NDArray[np.float64]:
    """An array of doubles. Raises DefinitionError, which begins with ``what``, for what is no real number."""
    if np.ma.is_masked(given):
        raise DefinitionError(f"{what}, got an array with masked entries, which have no number")
    try:
        array = np.asarray(given)
    except (TypeError, ValueError):
        raise DefinitionError(f"{what}, got {spoken(given)} whose rows differ in length") from None
    if array.dtype.kind in "fiub":
        return array.astype(np.float64, copy=False)
    if array.dtype.kind == "O" and array.size and all(isinstance(x, Real) for x in array.flat):
        try:
            return array.astype(np.float64)  # whole numbers beyond 64 bits, fractions
        except OverflowError:
            raise DefinitionError(f"{what}, got a number that is too large for a double") from None
    raise DefinitionError(f"{what}, got {spoken(given)}")


def spoken(given: object) -> str:
    """What was given, in words of a message: ``text``, ``None``, ``complex numbers``, ``a dict``."""
    kind = type(given)
    if given is None:
        return "None"
    if issubclass(kind, str | bytes):
        return "text"
    if issubclass(kind, complex | list | tuple | np.ndarray | np.generic):
        try:
            array: NDArray[Any] = np.asarray(given)
        except ValueError:
            return f"a {kind.__name__}"
        if array.dtype.kind in _KINDS:
            return _KINDS[array.dtype.kind]
        odd = [x for x in array.flat if not isinstance(x, Real)] if array.dtype.kind == "O" else []
        if odd:
            return f"a {kind.__name__} that holds {spoken(odd[0])}"
    return f"a {kind.__name__}"


def dimension(given: Any, cls: str, usage: str) -> int:
    """A dimension that a class of vectors declares.

    Raises DefinitionError, with the name of the class and the limit, unless it is a whole number from 1 to
    :data:`LARGEST`.
    """
    try:
        size = -1 if type(given) in (bool, np.bool_) else index(given)
    except TypeError:
        size = -1
    if not 1 <= size <= LARGEST:
        got = repr(given) if isinstance(given, float | int | str | bytes | None) else spoken(given)
        got = got if len(got) <= 40 else f"{got[:37]}..."
        raise DefinitionError(f"{cls}: dim is a whole number from 1 to {LARGEST}, got {got}; write {usage}")
    return size
