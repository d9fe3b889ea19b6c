"""Differences in the columns of a Jacobian: how the variable is perturbed."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations
from typing import Any

import numpy as np

from liegen.algebra.linear import plain, product
from liegen.charts import Preset, form_chart
from liegen.manifolds import Group, Vector
from liegen.trace import Parameter

from .. import tangents
from .chart_candidates import candidates, order_in_words, scale_in_words
from .difference import Array, Difference, Subject, constant, matrices

_TRANSLATION = {
    "world": "is perturbed in the world, t' = t + v",
    "body": "is perturbed in the body, t' = t + R v",
    "coupled": "is perturbed by the exponential of the pose",
}


def of_columns(subject: Subject) -> Iterator[Difference]:
    """Charts of the variable, its side, the order of its tangent's blocks, and half angles."""
    variable = subject.variable
    if variable is None:
        return
    yield from _charts(subject, variable)
    yield from _side(subject, variable)
    yield from _orders(subject, variable)
    turning = tangents.turning(variable.manifold.form, variable.chart)
    if turning.any():
        for factor, meaning in ((2.0, "half of the angle"), (0.5, "twice the angle")):
            scaled = np.diag(np.where(turning, factor, 1.0))
            right = constant(scaled, _points(subject))
            yield Difference("columns", (f"rotations are given by {meaning}",), 1.0, right=right)


def chart_columns(p: Parameter, preset: Preset, x: Any, points: int) -> Array:
    """M with J M for a Jacobian J in the factor's own chart of the variable, J M in that of the preset.

    Raises DefinitionError where the variable has no such chart.
    """
    own = form_chart(p.manifold.form, p.chart)
    there = _columns(form_chart(p.manifold.form, preset), p, x, points)
    if own is None:
        return there
    return np.asarray(np.linalg.solve(_columns(own, p, x, points), there), dtype=np.float64)


def _columns(chart: Any, p: Parameter, x: Any, points: int) -> Array:
    if chart is None:
        return constant(np.eye(p.manifold.form.dim), points)
    return matrices(product(plain(chart.columns(x.coords))), points)


def _points(subject: Subject) -> int:
    return subject.sampled.points


def _charts(subject: Subject, p: Parameter) -> Iterator[Difference]:
    x = subject.sampled.values[p.name]
    for candidate in candidates(p.manifold.form, p.chart):
        if any(field == "rotation" for field, _ in candidate.differing) and not candidate.named:
            continue  # all maps are the same to first order
        right = chart_columns(p, candidate.preset, x, _points(subject))
        differing = [pair for pair in candidate.differing if pair[0] != "rotation"]
        phrases = tuple(_phrase(field, value, p.name) for field, value in differing)
        size = candidate.size(len(phrases))
        yield Difference("columns", phrases, size, right=right, charts=candidate.names)


def _phrase(field: str, value: Any, x: str) -> str:
    if field == "side":
        left = value == "left"
        return f"{x} is perturbed from the {value}, {f'Exp(d) {x}' if left else f'{x} Exp(d)'}"
    if field == "scale":
        return f"rotations are given by {scale_in_words(value)} the angle"
    if field == "translation":
        return f"the translation of {x} {_TRANSLATION[value]}"
    return f"the tangent of {x} has the {order_in_words(value)}"


def _side(subject: Subject, p: Parameter) -> Iterator[Difference]:
    """From the left, for groups whose charts are GTSAM's alone."""
    x: Any = subject.sampled.values[p.name]
    if isinstance(x, Group) and not isinstance(x, Vector):
        right = matrices_of(x.inverse().adjoint(), _points(subject))
        yield Difference("columns", (_phrase("side", "left", p.name),), 1.0, right=right)


def _orders(subject: Subject, p: Parameter) -> Iterator[Difference]:
    """The blocks of the tangent in another order."""
    blocks = tangents.blocks(p.manifold.form, p.chart)
    if not 2 <= len(blocks) <= 4:
        return
    for order in permutations(blocks):
        columns = [c for b in order for c in b.columns]
        right = np.eye(p.manifold.form.dim)[:, columns]
        words = ", ".join(b.label for b in order)
        yield Difference(
            "columns", (f"the tangent of {p.name} has the order {words}",), 1.0,
            right=constant(right, _points(subject)),
        )  # fmt: skip


def matrices_of(array: Any, points: int) -> Array:
    """An array (r, c) or (P, r, c) at every point."""
    numbers = np.asarray(array, dtype=np.float64)
    return np.broadcast_to(numbers, (points, *numbers.shape[-2:]))
