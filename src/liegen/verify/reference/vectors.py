"""Operations on vectors, scalars and conditions."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from . import groups
from .calls import Call, Rule, elementwise, is_elementwise, plain
from .logarithms import AMBIGUOUS
from .matrix import Element, Number, Vector, cross, dot, length, mp


def _minimum(a: Number, b: Number) -> Number:
    return a + b if mp.isnan(a) or mp.isnan(b) else min(a, b)


def _maximum(a: Number, b: Number) -> Number:
    return a + b if mp.isnan(a) or mp.isnan(b) else max(a, b)


def _either(name: str, entries: Callable[[Number], Number], group: Rule) -> tuple[str, Rule]:
    """``exp`` and ``log`` name a function of every entry and an operation of groups."""
    of_entries = elementwise(entries)
    return name, lambda call: (of_entries if is_elementwise(call.operation) else group)(call)


def _atan2(call: Call) -> Vector:
    """The angle in [-pi, pi]; it follows the branch across the cut, as a plane rotation's logarithm."""
    near: Vector | None = call.branch.near
    angle = elementwise(mp.atan2)(call)
    if near is not None:
        return tuple(
            a + 2 * mp.pi * mp.nint((b - a) / (2 * mp.pi)) if mp.isfinite(a - b) else a
            for a, b in zip(angle, near, strict=True)
        )
    return tuple(_other_end(a) if call.branch.flip else a for a in angle)


def _other_end(angle: Number) -> Number:
    return angle - 2 * mp.pi * mp.sign(angle) if mp.pi - abs(angle) < AMBIGUOUS else angle


def _condition(test: Callable[[Number, Number], bool]) -> Rule:
    """A comparison keeps its outcome under the small steps that differences take."""

    def rule(call: Call) -> bool:
        (a,), (b,) = call.values
        return bool(test(a, b)) if call.branch.near is None else call.branch.near

    return rule


def _where(condition: bool, a: Vector, b: Vector) -> Vector:
    return a if condition else b


def _and(a: bool, b: bool) -> bool:
    return a and b


def _or(a: bool, b: bool) -> bool:
    return a or b


def _not(a: bool) -> bool:
    return not a


def _dot(a: Vector, b: Vector) -> Vector:
    return (dot(a, b),)


def _norm(v: Vector) -> Vector:
    return (length(v),)


def _take(call: Call) -> Vector:
    (v,) = call.values
    return tuple(v[k] for k in call.operation.parameters)


def _matmul(call: Call) -> Vector:
    (v,), (matrix,) = call.values, call.operation.parameters
    return tuple(dot([mp.mpf(x) for x in row], v) for row in matrix)


def _stack(*parts: Vector) -> Element:
    return tuple(x for part in parts for x in part)


_UNARY: Mapping[str, Callable[[Number], Number]] = {
    "neg": lambda a: -a,
    "abs": lambda a: abs(a),
    "sin": mp.sin,
    "cos": mp.cos,
    "tan": mp.tan,
    "asin": mp.asin,
    "acos": mp.acos,
    "sqrt": mp.sqrt,
}
_BINARY: Mapping[str, Callable[[Number, Number], Number]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "minimum": _minimum,
    "maximum": _maximum,
}

OPERATIONS: Mapping[str, Rule] = {
    **{name: elementwise(function) for name, function in {**_UNARY, **_BINARY}.items()},
    **dict((_either("exp", mp.exp, groups.exp), _either("log", mp.log, groups.log))),
    "atan2": _atan2,
    "lt": _condition(lambda a, b: a < b),
    "le": _condition(lambda a, b: a <= b),
    "and": plain(_and),
    "or": plain(_or),
    "not": plain(_not),
    "where": plain(_where),
    "dot": plain(_dot),
    "cross": plain(cross),
    "norm": plain(_norm),
    "take": _take,
    "stack": plain(_stack),
    "matmul": _matmul,
}
