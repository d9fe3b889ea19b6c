"""Differences that are the same at every point: signs, zeros, units, transposed and exchanged arrays."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from .. import tangents
from .difference import Array, Difference, Subject, constant

#: Constant factors, and what each is.
_SCALES = (
    (180 / np.pi, "degrees where radians are right, or the other way round"),
    (np.pi / 180, "degrees where radians are right, or the other way round"),
    (2.0, "twice"),
    (0.5, "half"),
    (1000.0, "thousandfold"),
    (0.001, "a thousandth"),
)


def of_constants(subject: Subject) -> Iterator[Difference]:
    """All of them."""
    yield from _signs(subject)
    yield from _scales(subject)
    yield from _exchanged(subject)
    if subject.variable is not None:
        yield from _column_blocks(subject)


def _sides(subject: Subject) -> tuple[int, int, int]:
    points, m, n = subject.expected.shape
    return points, m, n


def _signs(subject: Subject) -> Iterator[Difference]:
    points, m, _ = _sides(subject)
    yield Difference("sign", ("the sign is opposite",), 0.9, left=constant(-np.eye(m), points))


def _scales(subject: Subject) -> Iterator[Difference]:
    points, m, _ = _sides(subject)
    for factor, meaning in _SCALES:
        phrase = f"it is scaled by {factor:.6g} ({meaning})"
        yield Difference("scale", (phrase,), 1.1, left=constant(factor * np.eye(m), points))
    yield Difference("scale", ("it is 0 everywhere: left out",), 1.0, left=constant(np.zeros((m, m)), points))


def _exchanged(subject: Subject) -> Iterator[Difference]:
    points, m, n = _sides(subject)
    p = subject.variable
    if p is not None and m == n > 1:
        yield Difference("base", ("it is transposed",), 1.15, base=np.swapaxes(subject.expected, 1, 2))
    if p is not None:
        for k, other in enumerate(subject.function.graph.variables):
            array = subject.sampled.expected[k + 1]
            if other.name != p.name and array.shape == subject.expected.shape:
                phrase = f"the Jacobian by {other.name} stands in its place"
                yield Difference("base", (phrase,), 1.0, base=array)
    if 2 <= m <= 4:
        for order in permutations(range(m)):
            phrase = f"the rows stand in the order {[*order]}"
            yield Difference("rows", (phrase,), 1.1, left=constant(np.eye(m)[[*order]], points))
    if m == 6:
        half = [3, 4, 5, 0, 1, 2]
        phrase = "the first three rows and the last three are exchanged"
        yield Difference("rows", (phrase,), 1.1, left=constant(np.eye(m)[half], points))


def _column_blocks(subject: Subject) -> Iterator[Difference]:
    points, _, n = _sides(subject)
    p = subject.variable
    blocks = () if p is None else tangents.blocks(p.manifold.form, p.chart)
    if len(blocks) < 2:
        return
    for block in blocks:
        label = block.label
        yield _scaled(points, n, block.place, -1.0, f"the sign of the {label} columns is opposite")
        yield _scaled(points, n, block.place, 0.0, f"the {label} columns are 0: left out")
        for factor, meaning in _SCALES:
            phrase = f"the {label} columns are scaled by {factor:.6g} ({meaning})"
            yield _scaled(points, n, block.place, factor, phrase)


def _scaled(points: int, n: int, place: slice, factor: float, phrase: str) -> Difference:
    diagonal: Array = np.ones(n)
    diagonal[place] = factor
    return Difference("block", (phrase,), 1.05, right=constant(np.diag(diagonal), points))
