"""Factors that are left out of a Jacobian or put in: Ad, rotations, scales."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations
from typing import Any

import numpy as np

from liegen.manifolds import Group, Vector
from liegen.trace import Parameter

from .. import tangents
from .columns import matrices_of
from .difference import Array, Difference, Subject, constant, matrices
from .rows import logarithm


def of_factors(subject: Subject) -> Iterator[Difference]:
    """All of them, for a Jacobian."""
    p = subject.variable
    if p is None:
        return
    yield from _adjoints(subject, p)
    yield from _rotations(subject, p)
    yield from _scales(subject, p)


def _elements(subject: Subject) -> list[tuple[str, Any]]:
    """The group elements among the arguments, and those between two of them."""
    values = subject.sampled.values
    found: list[tuple[str, Any]] = [
        (name, v) for name, v in values.items() if isinstance(v, Group) and not isinstance(v, Vector)
    ]
    pairs = permutations(found, 2)
    return found + [(f"{a}^-1 {b}", x.between(y)) for (a, x), (b, y) in pairs if x.form == y.form]


def _adjoints(subject: Subject, p: Parameter) -> Iterator[Difference]:
    form: Any = p.manifold.form
    if not issubclass(p.manifold, Group) or issubclass(p.manifold, Vector) or form.dim == 1:
        return
    points = subject.sampled.points
    for text, g in _elements(subject):
        if g.form != form:
            continue
        Ad, inverse = matrices_of(g.adjoint(), points), matrices_of(g.inverse().adjoint(), points)
        for one, other, right in (("put in", "left out", Ad), ("left out", "put in", inverse)):
            phrase = f"a factor Ad({text}) is {one}, or its inverse is {other}"
            yield Difference("factor", (phrase,), 1.1, right=right)
        yield Difference("factor", (f"Ad({text}) stands where its inverse is right",), 1.2, right=Ad @ Ad)
        found = logarithm(subject)
        if found is not None and found[0].form == form:
            r = subject.sampled.expected[0]
            jr = matrices_of(found[0].Jr(r), points)
            jr_inv = matrices_of(found[0].Jr_inv(r), points)
            for meaning, M in (("put in", Ad), ("left out", inverse)):
                phrase = f"a factor Ad({text}) is {meaning} behind Jr^-1(res)"
                yield Difference("factor", (phrase,), 1.2, left=jr_inv @ M @ jr)


def _matrix_of_rotation(v: Any, points: int) -> Array | None:
    rotation = tangents.rotation_of(v.form)
    if rotation is None:
        return None
    return matrices(rotation.matrix(v.coords[: rotation.size]), points)


def _rotations(subject: Subject, p: Parameter) -> Iterator[Difference]:
    points, m = subject.sampled.points, subject.expected.shape[1]
    form = p.manifold.form
    blocks = tangents.blocks(form, p.chart)
    for text, v in _elements(subject):
        R = _matrix_of_rotation(v, points)
        if R is None:
            continue
        n = R.shape[-1]
        for matrix, name in ((R, f"R({text})"), (np.swapaxes(R, 1, 2), f"R({text})^T")):
            for block in blocks:
                if block.size == n:
                    right = np.array(constant(np.eye(form.dim), points))
                    right[:, block.place, block.place] = matrix
                    where = f"in the {block.label} columns " if len(blocks) > 1 else ""
                    phrase = f"{where}a factor {name} is put in on the right, or its inverse is left out"
                    yield Difference("factor", (phrase,), 1.2, right=right)
            if m == n:
                phrase = f"a factor {name} is put in on the left, or its inverse is left out"
                yield Difference("factor", (phrase,), 1.2, left=matrix)


def _scales(subject: Subject, p: Parameter) -> Iterator[Difference]:
    """Factors s and 1/s for the scales of similarities and for numbers, and for e to a number."""
    points = subject.sampled.points
    form = p.manifold.form
    blocks = tangents.blocks(form, p.chart)
    for text, s in _scalars(subject):
        with np.errstate(all="ignore"):
            numbers = ((s, "multiplied"), (1 / s, "divided"))
        for factor, done in numbers:
            for block in blocks:
                right = np.array(constant(np.eye(form.dim), points))
                right[:, block.columns, block.columns] = factor[:, None]
                columns = f"the {block.label} columns are" if len(blocks) > 1 else "it is"
                phrase = f"{columns} {done} by {text} (that factor is put in or left out)"
                yield Difference("factor", (phrase,), 1.2, right=right)


def _scalars(subject: Subject) -> Iterator[tuple[str, Array]]:
    points = subject.sampled.points
    for name, v in subject.sampled.values.items():
        form: Any = v.form
        if form.storage[-1:] == ("s",) and hasattr(form, "scale_of"):
            yield f"the scale of {name}", np.broadcast_to(np.asarray(form.scale_of(v.coords), float), points)
        elif isinstance(v, Vector) and form.dim == 1:
            s = np.broadcast_to(np.asarray(v.coords[0], float), points)
            yield name, s
            with np.errstate(all="ignore"):
                yield f"exp({name})", np.exp(s)
