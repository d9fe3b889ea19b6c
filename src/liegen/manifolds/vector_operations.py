"""The operations of vectors as records: values and tangent-space blocks on scalars of any backend."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import Any

from liegen.algebra import Scalar, call
from liegen.algebra.linear import Chain, Matrix, column, diagonal, matvec, selection, transpose
from liegen.algebra.linear import Vector as Coordinates
from liegen.errors import DefinitionError

from .form import Blocks, Rule
from .given import spoken
from .node import Operation, Value, called, formula, here
from .rn_form import direction_or_rounding, direction_or_zero, length

#: An entry of the result from the operands' entries.
Elementwise = Callable[[Any], Scalar] | Callable[[Any, Any], Scalar]
#: Its derivatives from the result's and the operands' entries; a tuple of factors is a product that may be
#: multiplied out from the left, so that what is in front of it is shared.
Partials = Callable[[Any, Any], tuple[Scalar, ...]] | Callable[[Any, Any, Any], tuple[Scalar, ...]]
#: Value, derivatives (by a, by b), and how it is shown.
ARITHMETIC: dict[str, tuple[Elementwise, Partials, str]] = {
    "add": (lambda a, b: a + b, lambda _r, _a, _b: (1, 1), "{0} + {1}"),
    "sub": (lambda a, b: a - b, lambda _r, _a, _b: (1, -1), "{0} - {1}"),
    "mul": (lambda a, b: a * b, lambda _r, a, b: (b, a), "{0} * {1}"),
    "div": (lambda a, b: a / b, lambda r, _a, b: (1 / b, (1 / b, -r)), "{0} / {1}"),
}


def elementwise(
    cls: type[Value], n: int, name: str, show: str, f: Elementwise, partials: Partials | None
) -> Operation:
    """``f`` on each of n entries, scalars repeated; without ``partials`` CasADi differentiates it."""

    def entries(coords: Sequence[Coordinates]) -> list[tuple[Scalar, ...]]:
        return [tuple(c[k if len(c) > 1 else 0] for c in coords) for k in range(n)]

    def value(*coords: Coordinates) -> Coordinates:
        return tuple(f(*entry) for entry in entries(coords))

    def blocks(result: Coordinates, *coords: Coordinates) -> Blocks:
        assert partials is not None
        slopes = [partials(r, *entry) for r, entry in zip(result, entries(coords), strict=True)]
        by_operand = ([s[k] for s in slopes] for k in range(len(coords)))
        return tuple(_block(d, len(c)) for c, d in zip(coords, by_operand, strict=True))

    rounded = _absolute_near_zero if name == "abs" else None
    return Operation(name, cls, value, blocks if partials else None, show, near_zero=rounded)


def _absolute_near_zero(size: Scalar) -> Rule:
    """The slope of ``abs`` is 0 where an entry is but rounding."""
    return lambda _, a: ((diagonal([direction_or_rounding((x,), size)[0] for x in a]),),)


def _block(slopes: Sequence[Any], size: int) -> Chain:
    """The derivative by an operand that has an entry for each of the result, or one for all."""
    factors: list[tuple[Scalar, ...]] = [s if isinstance(s, tuple) else (s,) for s in slopes]
    *inner, last = zip(*factors, strict=True)
    return (*map(diagonal, inner), column(last) if size == 1 else diagonal(last))


def comparison(cls: type[Value], name: str, show: str) -> Operation:
    """A comparison of two scalars."""

    def value(x: Coordinates, y: Coordinates) -> Coordinates:
        return (call(name, x[0], y[0]),)

    return Operation(name, cls, value, None, show)


def positions(x: Value, n: int, index: Any) -> Sequence[int]:
    """The entries that an index means. Raises DefinitionError for what is none, and for no entry."""
    has = f"{called(x)} has the entries 0 to {n - 1}"
    entries: Any = range(n)
    try:
        found: Any = entries[index]
    except TypeError:
        given: Sequence[Any] = index if index.__class__ in (list, tuple) else ()
        several = given and all(type(k) is int for k in given)
        cure = f"; write stack({', '.join(f'{formula(x)}[{k}]' for k in given)})" if several else ""
        raise DefinitionError(
            f"{here()}: {has}; an index is a whole number or a slice, got {spoken(index)}{cure}"
        ) from None
    except IndexError:
        raise DefinitionError(f"{here()}: {has}, there is no [{index}]") from None
    picked: Sequence[int] = found if index.__class__ is slice else [found]
    if not picked:
        raise DefinitionError(f"{here()}: an empty slice: {has}")
    return picked


def spoken_as(v: Value, of_vector: str) -> str:
    """A scalar as it is, ``of_vector`` of a longer vector."""
    if v.form.size > 1:
        return of_vector.format(formula(v, "p"))
    return formula(v) if v.traced else f"{float(v):g}"


def length_of(cls: type[Value]) -> Operation:
    """The length of a vector."""
    return Operation(
        "norm",
        cls,
        lambda a: (length(a),),
        lambda _, a: (((direction_or_zero(a),),),),
        "norm({0})",
        near_zero=lambda size: lambda _, a: (((direction_or_rounding(a, size),),),),
    )


def take(cls: type[Value], n: int, positions: Sequence[int], *, single: bool) -> Operation:
    """Some of n entries; ``single`` is shown as an index."""
    text = str(positions[0]) if single else _slice_text(positions)
    return Operation(
        "take",
        cls,
        lambda a: tuple(a[k] for k in positions),
        lambda _, _a: ((selection(n, positions),),),
        f"{{0}}[{text}]",
        tuple(positions),
    )


def _slice_text(positions: Sequence[int]) -> str:
    step = positions[1] - positions[0] if len(positions) > 1 else 1
    ends = f"{positions[0]}:{positions[-1] + 1}"
    return ends if step == 1 else f"{', '.join(map(str, positions))}"


def constant_product(cls: type[Value], numbers: list[list[float]]) -> Operation:
    """M v with a constant matrix."""
    rows: Matrix = tuple(tuple(_plain(x) for x in row) for row in numbers)
    return Operation(
        "matmul", cls, lambda a: matvec(rows, a), lambda _, _a: ((rows,),), "M @ {0}", (numbers,)
    )


def _plain(x: float) -> float | int:
    """Zeros and ones of a constant matrix are structure."""
    return int(x) if x in (0.0, 1.0, -1.0) else x


def join(cls: type[Value], sizes: Sequence[int]) -> Operation:
    """Vectors of the given sizes one after the other."""
    n = sum(sizes)
    starts = list(accumulate(sizes[:-1], initial=0))

    def value(*coords: Coordinates) -> Coordinates:
        return tuple(x for part in coords for x in part)

    def blocks(*_: Coordinates) -> Blocks:
        places = [range(start, start + size) for start, size in zip(starts, sizes, strict=True)]
        return tuple((transpose(selection(n, place)),) for place in places)

    show = "stack(" + ", ".join(f"{{{k}}}" for k in range(len(sizes))) + ")"
    return Operation("stack", cls, value, blocks, show)
