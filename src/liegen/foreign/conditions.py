"""At which samples something holds, in words: "the rotation angle of x is below 0.01 rad"."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import Group, Vector

from . import tangents
from .points import AnyFunction, Array, Sampled, Values, at, evaluated, some

Mask = NDArray[np.bool_]
#: Whether the foreign function is right at a point; None where there is nothing to compare.
Judge = Callable[[Values], bool | None]
#: Steps of the bisection for a threshold.
_STEPS = 40


@dataclass(frozen=True)
class Feature:
    """A number that every sample has: its name, its unit, and how it is computed."""

    name: str
    unit: str
    of: Callable[[AnyFunction, Values], Array]


def features(function: AnyFunction) -> Iterator[Feature]:
    """Those of the residual, of the arguments, and of pairs of them."""
    node = function.graph.outputs[0][1]
    output = function.graph.outputs[0][0]
    if node.operation.name in ("local", "log"):
        group: Any = node.operands[0].manifold
        turning = tangents.turning(group.form, function.graph.chart)
        if turning.any():
            yield Feature(
                f"the rotation angle of {output}", " rad",
                lambda f, v: np.linalg.norm(evaluated(f, v)[0][:, turning], axis=1),
            )  # fmt: skip
    manifolds: dict[str, Any] = {p.name: p.manifold for p in function.graph.parameters}
    groups = [n for n, m in manifolds.items() if issubclass(m, Group) and not issubclass(m, Vector)]
    for name in groups:
        if tangents.turning(manifolds[name].form).any():
            yield Feature(f"the rotation angle of {name}", " rad", lambda _, v, n=name: _angle(v[n]))
    for a, b in combinations(groups, 2):
        if manifolds[a] is manifolds[b] and tangents.turning(manifolds[a].form).any():
            yield Feature(
                f"the rotation angle between {a} and {b}",
                " rad",
                lambda _, v, a=a, b=b: _between(v[a], v[b]),
            )
    yield Feature(f"the length of {output}", "", lambda f, v: np.linalg.norm(evaluated(f, v)[0], axis=1))
    for name, manifold in manifolds.items():
        if issubclass(manifold, Vector):
            yield Feature(f"the length of {name}", "", lambda _, v, n=name: _norms(v[n].coords))


def _angle(x: Any) -> Array:
    rotation = tangents.rotation_of(x.form)
    with np.errstate(all="ignore"):
        turned = rotation.log(x.coords[: rotation.size])
    return _norms(turned)


def _between(a: Any, b: Any) -> Array:
    return _angle(a.between(b))


def _norms(coords: Sequence[Any]) -> Array:
    columns = np.stack(np.broadcast_arrays(*coords), axis=-1).astype(np.float64)
    return np.atleast_1d(np.linalg.norm(columns, axis=-1))


def condition(function: AnyFunction, sampled: Sampled, wrong: Mask, judge: Judge | None) -> str:
    """Where the samples ``wrong`` are: a condition that they meet and no other sample does; else their kinds.

    ``judge`` finds the threshold between a wrong and a right sample; None leaves it roughly known.
    """
    values = some(sampled.values, sampled.firsts)
    negative = _negative_quaternion(values, wrong)
    if negative:
        return negative
    for feature in features(function):
        numbers = feature.of(function, values)
        bad, good = numbers[wrong], numbers[~wrong]
        if bad.max() < good.min():
            return _below(function, feature, values, numbers, wrong, judge)
        if bad.min() > good.max():
            return _above(feature, float(good.max()), float(bad.min()))
    kinds = dict.fromkeys(k for k, w in zip(sampled.kinds, wrong, strict=True) if w)
    listed = ", ".join([*kinds][:4]) + (", ..." if len(kinds) > 4 else "")
    return f"at {int(wrong.sum())} of {len(wrong)} samples ({listed})"


def _negative_quaternion(values: Values, wrong: Mask) -> str:
    for name, v in values.items():
        for start in v.form.quaternions:
            w = np.asarray(v.coords[start + 3]) < 0
            if np.array_equal(w, wrong):
                return f"where the quaternion of {name} has w < 0"
    return ""


def _above(feature: Feature, good: float, bad: float) -> str:
    if "angle" in feature.name and bad > 3.0:
        return f"where {feature.name} is within {max(np.pi - good, 1e-16):.2g}{feature.unit} of half a turn"
    return f"where {feature.name} is {_short(bad)}{feature.unit} or more"


def _below(
    function: AnyFunction, feature: Feature, values: Values, numbers: Array, wrong: Mask, judge: Judge | None
) -> str:
    bad = int(np.flatnonzero(wrong)[np.argmax(numbers[wrong])])
    good = int(np.flatnonzero(~wrong)[np.argmin(numbers[~wrong])])
    if numbers[bad] < 1e-11:
        size = float(numbers[bad])
        return f"where {feature.name} is {'0' if size < 1e-13 else f'{_short(size)} or less'}"
    threshold = float(numbers[good])
    if judge is not None:
        threshold = _threshold(function, feature, at(values, bad), at(values, good), judge) or threshold
    return f"where {feature.name} is below {_short(threshold)}{feature.unit}"


def _short(number: float) -> str:
    return f"{number:.2g}"


def _threshold(
    function: AnyFunction, feature: Feature, bad: dict[str, Any], good: dict[str, Any], judge: Judge
) -> float | None:
    """The feature at which wrong becomes right, on the way from the bad point to the good one."""
    low, high = 0.0, 1.0
    for _ in range(_STEPS):
        middle = (low + high) / 2
        right = judge(_on_the_way(bad, good, middle))
        if right is None:
            return None
        low, high = (low, middle) if right else (middle, high)
    return float(feature.of(function, _on_the_way(bad, good, high))[0])


def _on_the_way(bad: dict[str, Any], good: dict[str, Any], part: float) -> dict[str, Any]:
    return {n: v.retract(part * np.asarray(v.local(good[n]))) for n, v in bad.items()}
