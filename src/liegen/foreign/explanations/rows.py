"""Differences in the rows: in which chart the residual is taken, and what is made of its Jacobian Jr^-1."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from liegen.algebra.linear import plain, product
from liegen.charts import form_chart
from liegen.manifolds import Group, Vector

from .. import tangents
from ..points import columns_of, every
from .chart_candidates import candidates, order_in_words, scale_in_words
from .columns import matrices_of
from .difference import Array, Difference, Subject, constant, matrices
from .nodes import value_of

_MAP = {
    "exp": "the rotation vector",
    "cayley": "the vector 2 tan(angle / 2) u",
    "quaternion-vector": "the vector 2 sin(angle / 2) u of the quaternion",
}
#: Coordinates beyond that are those of a chart near the end of its domain.
_LARGEST = 1e4
_TRANSLATION = {"world": "in the world", "body": "in the body", "coupled": "by the logarithm of the pose"}


def logarithm(subject: Subject) -> tuple[Any, Any] | None:
    """(group, z) of a residual z.local(y) or log(y): z is at the points; None for other residuals."""
    node = subject.function.graph.outputs[0][1]
    if node.operation.name not in ("local", "log"):
        return None
    manifold: Any = node.operands[0].manifold
    if not issubclass(manifold, Group) or issubclass(manifold, Vector):
        return None
    if node.operation.name == "log":
        return manifold, manifold.identity()
    return manifold, value_of(subject.function.graph, node.operands[0], subject.sampled.values)


def of_rows(subject: Subject) -> Iterator[Difference]:
    """Charts of the residual, and what stands for Jr^-1(res)."""
    found = logarithm(subject)
    if found is None:
        return
    manifold, z = found
    if subject.variable is not None:
        yield from _jr(subject, manifold, z)
    yield from _charts(subject, manifold, z)


def _residual(subject: Subject) -> Array:
    return subject.sampled.expected[0]


def _charts(subject: Subject, manifold: Any, z: Any) -> Iterator[Difference]:
    form, preset = manifold.form, subject.function.graph.chart
    points = subject.sampled.points
    own = form_chart(form, preset) or form
    r = tuple(_residual(subject).T)
    y = tuple(own.retract(z.coords, r))
    own_rows = _local_rows(own, r, z.coords, y, points)
    for candidate in candidates(form, preset):
        side = candidate.chart or form
        with np.errstate(all="ignore"):
            value = tuple(side.local(z.coords, y))
        stacked = columns_of(value, points)
        known = every(np.abs(stacked) < _LARGEST)
        phrases = tuple(_phrase(field, text) for field, text in candidate.differing)
        size = candidate.size(len(phrases))
        if subject.variable is None:
            base = np.where(known[:, None], stacked, np.nan)[..., None]
            yield Difference("rows", phrases, size, base=base, charts=candidate.names)
            continue
        rows = _local_rows(side, value, z.coords, y, points)
        if rows is None or own_rows is None:
            continue
        with np.errstate(all="ignore"):
            left = np.where(known[:, None, None], _solved(own_rows, rows), np.nan)
        yield Difference("rows", phrases, size, left=left, charts=candidate.names)


def _solved(own: Array, rows: Array) -> Array:
    """rows own^-1, NaN where own has no inverse."""
    good = every(np.isfinite(own))
    safe = np.where(good[:, None, None], own, np.eye(own.shape[-1]))
    left = np.swapaxes(np.linalg.solve(np.swapaxes(safe, 1, 2), np.swapaxes(rows, 1, 2)), 1, 2)
    return np.where(good[:, None, None], left, np.nan)


def _local_rows(chart: Any, r: Any, z: Any, y: Any, points: int) -> Array | None:
    """The Jacobian of local at z by a right perturbation of y."""
    rule: Any = chart.local_blocks()
    if rule is None:
        return None
    with np.errstate(all="ignore"):
        return matrices(product(plain(rule(r, z, y)[1])), points)


def _phrase(field: str, value: Any) -> str:
    if field == "side":
        return f"the residual is taken from the {value}"
    if field == "scale":
        return f"the residual's rotation is {scale_in_words(value)} the angle"
    if field == "translation":
        return f"the residual's translation is {_TRANSLATION[value]}"
    if field == "rotation":
        return f"the residual's rotation is {_MAP[value]}"
    return f"the tangent of the residual has the {order_in_words(value)}"


def _jr(subject: Subject, manifold: Any, z: Any) -> Iterator[Difference]:
    form, points = manifold.form, subject.sampled.points
    r = _residual(subject)
    chart = form_chart(form, subject.function.graph.chart)
    if form.dim == 1:
        return
    if chart is not None:
        y = tuple(chart.retract(z.coords, tuple(r.T)))
        rows = _local_rows(chart, tuple(r.T), z.coords, y, points)
        if rows is not None:
            phrase = "the Jacobian of local at res is missing (right at zero residual only)"
            yield Difference("jr", (phrase,), 1.0, left=_solved(rows, constant(np.eye(form.dim), points)))
        return
    jr = matrices_of(manifold.Jr(r), points)
    jl = matrices_of(manifold.Jr(-r), points)
    jr_inv, jl_inv = matrices_of(manifold.Jr_inv(r), points), matrices_of(manifold.Jr_inv(-r), points)
    first = constant(np.eye(form.dim), points) + _ad(manifold, r, points) / 2
    uncoupled = jr_inv * _within_blocks(form)
    yield Difference("jr", ("Jr^-1(res) is missing (right at zero residual only)",), 1.0, left=jr)
    for meaning, left, size in (
        ("Jl^-1(res) stands where Jr^-1(res) is right", jl_inv @ jr, 1.0),
        ("Jr(res) stands where Jr^-1(res) is right", jr @ jr, 1.1),
        ("Jl(res) stands where Jr^-1(res) is right", jl @ jr, 1.1),
        ("the coupling block of Jr^-1(res) is left out", uncoupled @ jr, 1.1),
        ("Jr^-1(res) is taken to first order, I + ad(res) / 2", first @ jr, 1.1),
        ("Jr^-1(res) is put in once more", jr_inv, 1.1),
        ("Jl^-1(res) is put in", jl_inv, 1.1),
    ):
        yield Difference("jr", (meaning,), size, left=left)


def _within_blocks(form: Any) -> Array:
    mask = np.zeros((form.dim, form.dim))
    for block in tangents.blocks(form):
        mask[block.place, block.place] = 1.0
    return mask


def _ad(manifold: Any, r: Array, points: int) -> Array:
    """ad(r), the derivative of Ad(exp(h r)) by h at 0, by differences of fourth order."""
    h = 1e-3
    one, two = (
        matrices_of(manifold.exp(k * h * r).adjoint(), points)
        - matrices_of(manifold.exp(-k * h * r).adjoint(), points)
        for k in (1, 2)
    )
    return (8 * one - two) / (12 * h)
