"""The functions of the residual language: what ``numpy`` offers on arrays, on typed vectors."""

from __future__ import annotations

from typing import Any, TypeVar, overload

from liegen.algebra import Scalar, lt, select
from liegen.algebra import atan2 as scalar_atan2
from liegen.algebra.linear import cross as scalar_cross
from liegen.algebra.linear import dot as scalar_dot
from liegen.algebra.linear import negate, skew
from liegen.errors import DefinitionError

from .condition import Condition
from .node import Operation, Value, apply, called, here
from .rn_form import direction, length
from .vector import R1, R3, Vector, VectorLike, as_vector, binary, unary, vector_class

V = TypeVar("V", bound=Vector)


@overload
def sin(v: V) -> V: ...
@overload
def sin(v: float) -> R1: ...
def sin(v: Any) -> Any:
    """Sine of every entry [rad]."""
    return unary("sin", v)


@overload
def cos(v: V) -> V: ...
@overload
def cos(v: float) -> R1: ...
def cos(v: Any) -> Any:
    """Cosine of every entry [rad]."""
    return unary("cos", v)


@overload
def tan(v: V) -> V: ...
@overload
def tan(v: float) -> R1: ...
def tan(v: Any) -> Any:
    """Tangent of every entry [rad]."""
    return unary("tan", v)


@overload
def asin(v: V) -> V: ...
@overload
def asin(v: float) -> R1: ...
def asin(v: Any) -> Any:
    """Arc sine of every entry."""
    return unary("asin", v)


@overload
def acos(v: V) -> V: ...
@overload
def acos(v: float) -> R1: ...
def acos(v: Any) -> Any:
    """Arc cosine of every entry."""
    return unary("acos", v)


@overload
def sqrt(v: V) -> V: ...
@overload
def sqrt(v: float) -> R1: ...
def sqrt(v: Any) -> Any:
    """Square root of every entry."""
    return unary("sqrt", v)


@overload
def exp(v: V) -> V: ...
@overload
def exp(v: float) -> R1: ...
def exp(v: Any) -> Any:
    """Exponential of every entry; the exponential of a group is ``SE3.exp``."""
    return unary("exp", v)


@overload
def log(v: V) -> V: ...
@overload
def log(v: float) -> R1: ...
def log(v: Any) -> Any:
    """Natural logarithm of every entry; the logarithm of a group element is ``x.log()``."""
    return unary("log", v)


@overload
def abs(v: V) -> V: ...
@overload
def abs(v: float) -> R1: ...
def abs(v: Any) -> Any:
    """Absolute value of every entry; its derivative at 0 is 0, the mean of both sides."""
    return unary("abs", v)


def atan2(y: Vector | float, x: Vector | float) -> R1:
    """Angle of the vector (x, y) in (-pi, pi]. No under- or overflow in its derivative."""

    def partials(_: Scalar, y: Scalar, x: Scalar) -> tuple[Scalar, Scalar]:
        (c, s), k = direction((x, y)), 1 / length((x, y))
        return c * k, -s * k

    return binary("atan2", "atan2({0}, {1})", y, x, scalar_atan2, partials)


def _middle(a: Scalar, b: Scalar) -> Scalar:
    """Used where a = b, so that the derivative there is the mean of both sides; NaN if either is."""
    return (a + b) * 0.5


def _minimum(a: Scalar, b: Scalar) -> Scalar:
    return select(lt(a, b), a, select(lt(b, a), b, _middle(a, b)))


def _maximum(a: Scalar, b: Scalar) -> Scalar:
    return select(lt(a, b), b, select(lt(b, a), a, _middle(a, b)))


@overload
def minimum(a: V, b: V | float) -> V: ...
@overload
def minimum(a: float, b: V) -> V: ...
@overload
def minimum(a: VectorLike, b: VectorLike) -> Vector: ...
def minimum(a: Any, b: Any) -> Any:
    """The smaller of both, entry by entry; at a tie the derivative is the mean of both sides."""
    return binary("minimum", "minimum({0}, {1})", a, b, _minimum)


@overload
def maximum(a: V, b: V | float) -> V: ...
@overload
def maximum(a: float, b: V) -> V: ...
@overload
def maximum(a: VectorLike, b: VectorLike) -> Vector: ...
def maximum(a: Any, b: Any) -> Any:
    """The larger of both, entry by entry; at a tie the derivative is the mean of both sides."""
    return binary("maximum", "maximum({0}, {1})", a, b, _maximum)


@overload
def where(condition: Condition, a: V, b: V | float) -> V: ...
@overload
def where(condition: Condition, a: float, b: V) -> V: ...
@overload
def where(condition: Condition, a: VectorLike, b: VectorLike) -> Vector: ...
def where(condition: Condition, a: Any, b: Any) -> Any:
    """``a`` where the condition holds, else ``b``. Both are computed, so both must be finite."""
    if not isinstance(condition, Condition):  # pyright: ignore[reportUnnecessaryIsInstance]
        given = called(condition) if isinstance(condition, Value) else f"a {type(condition).__name__}"
        cure = "(x > 0) & (y > 0) for two of them" if isinstance(condition, list | tuple) else "x > 0"
        said = f"where needs a condition first, got {given}; write one, such as {cure}"
        raise DefinitionError(f"{here()}: {said}")
    x, y = as_vector(a, where="where"), as_vector(b, where="where")
    n = max(len(x), len(y))
    x, y = (as_vector(v * ([1.0] * n) if len(v) == 1 and n > 1 else v, n, "where") for v in (x, y))

    def value(c: Any, p: Any, q: Any) -> Any:
        return tuple(select(c[0], u, w) for u, w in zip(p, q, strict=True))

    def blocks(_: Any, c: Any, _p: Any, _q: Any) -> Any:
        one, zero = select(c[0], 1.0, 0.0), select(c[0], 0.0, 1.0)
        return (None, (_scaled_eye(one, n),), (_scaled_eye(zero, n),))

    cls = vector_class(n)
    return apply(Operation("where", cls, value, blocks, "where({0}, {1}, {2})"), cls, condition, x, y)


def _scaled_eye(k: Scalar, n: int) -> Any:
    return tuple(tuple(k if i == j else 0 for j in range(n)) for i in range(n))


def dot(a: VectorLike, b: VectorLike) -> R1:
    """Scalar product."""
    u, v = as_vector(a, where="dot"), as_vector(b, where="dot")
    as_vector(v, len(u), "dot")
    operation = Operation(
        "dot", R1, lambda x, y: (scalar_dot(x, y),), lambda _, x, y: (((y,),), ((x,),)), "dot({0}, {1})"
    )
    return apply(operation, R1, u, v)


def cross(a: VectorLike, b: VectorLike) -> R3:
    """Vector product of two 3-vectors."""
    operation = Operation(
        "cross",
        R3,
        scalar_cross,
        lambda _, x, y: ((skew(negate(y)),), (skew(x),)),
        "cross({0}, {1})",
    )
    return apply(operation, R3, as_vector(a, 3, "cross"), as_vector(b, 3, "cross"))
