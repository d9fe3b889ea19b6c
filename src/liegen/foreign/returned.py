"""What a foreign Python function returned, checked: a residual and a Jacobian for each variable."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.errors import LiegenError, ToolError
from liegen.text import exception_text

from .signature import Signature

Array = NDArray[np.float64]
Shape = tuple[int, ...]


class RaisedError(ToolError):
    """The foreign function raised an exception: that may be so at this sample only."""


def checked(
    function: Callable[..., Any], place: str, expected: Signature
) -> Callable[[Sequence[Array]], tuple[Array, ...]]:
    """The function from a list of stored arguments to arrays of the right shapes.

    A Jacobian has as many columns as the variable's tangent has coordinates, or as it has stored scalars. A
    call raises RaisedError for what the function raises, and ToolError for what is no real array of such a
    shape.
    """
    variables, m = expected.variables, expected.rows
    names = ["the residual", *(f"the Jacobian by {v.name}" for v in variables)]
    shapes: list[tuple[Shape, ...]] = [((expected.size,),), *(((m, v.dim), (m, v.size)) for v in variables)]

    def call(arguments: Sequence[Array]) -> tuple[Array, ...]:
        try:
            results: Any = function(*arguments)
        except (LiegenError, KeyboardInterrupt) as error:
            if isinstance(error, LiegenError):
                raise ToolError(f"{place}: {error}") from error
            raise
        except BaseException as error:  # a user's function may raise anything
            raise RaisedError(f"{place} raised {exception_text(error)}") from error
        if not isinstance(results, (tuple, list)) or len(results) != len(shapes):  # pyright: ignore[reportUnknownArgumentType]
            raise ToolError(f"{place} must return {len(shapes)} arrays: {', '.join(names)}")
        given: list[Any] = [*results]  # pyright: ignore[reportUnknownArgumentType]
        return tuple(
            _array(value, possible, f"{place}: {name}")
            for value, possible, name in zip(given, shapes, names, strict=True)
        )

    return call


def _array(value: Any, possible: Sequence[Shape], what: str) -> Array:
    try:
        given = np.asarray(value)
    except (TypeError, ValueError):
        raise ToolError(f"{what} is no array: its rows differ in length") from None
    if given.dtype.kind not in "fiub":
        kind = "complex numbers" if given.dtype.kind == "c" else f"{type(value).__name__} ({given.dtype})"
        raise ToolError(f"{what} must hold real numbers, it holds {kind}")
    array = given.astype(np.float64)
    for shape in possible:
        fits = array.shape == shape or (array.ndim != len(shape) and array.size == np.prod(shape))
        if fits:
            return array.reshape(shape)
    raise ToolError(f"{what} has shape {array.shape}, {possible[0]} is needed")
