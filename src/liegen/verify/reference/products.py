"""Products: an element is a tuple of the elements of its parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from .contract import GroupSpace, Space
from .logarithms import Branch
from .matrix import Element, Vector


def _cut(v: Any, sizes: Sequence[int]) -> list[Any]:
    """Consecutive pieces of these lengths."""
    ends = [sum(sizes[:k]) for k in range(len(sizes) + 1)]
    return [v[a:b] for a, b in pairwise(ends)]


def _joined(parts: Sequence[Vector]) -> Vector:
    return tuple(x for part in parts for x in part)


def _branches(branch: Branch, near: Sequence[Any]) -> list[Branch]:
    """The branch of each part: its pieces of ``near``, and its own starting point."""
    start = branch.start or (None,) * len(near)
    return [Branch(n, s, branch.flip) for n, s in zip(near, start, strict=True)]


def product_space(sizes: Sequence[tuple[int, int]], parts: Sequence[Space]) -> Space:
    """The product of manifolds, of which each stores and moves as many numbers as ``sizes`` says."""
    stored, moved = [n for n, _ in sizes], [dim for _, dim in sizes]

    def load(coords: Vector) -> Element:
        return tuple(p.load(c) for p, c in zip(parts, _cut(coords, stored), strict=True))

    def store(x: Element, like: Sequence[float] | None) -> Vector:
        likes = [None] * len(parts) if like is None else _cut(like, stored)
        return _joined([p.store(e, near) for p, e, near in zip(parts, x, likes, strict=True)])

    def retract(x: Element, d: Vector, branch: Branch) -> Element:
        """A part that does not move stays the same object, so that its users are not computed again."""
        branches = _branches(branch, branch.near or (None,) * len(parts))
        rows = zip(parts, x, _cut(d, moved), branches, strict=True)
        return tuple(p.retract(e, step, b) if any(step) else e for p, e, step, b in rows)

    def local(x: Element, y: Element, branch: Branch) -> Vector:
        near = [None] * len(parts) if branch.near is None else _cut(branch.near, moved)
        rows = zip(parts, x, y, _branches(branch, near), strict=True)
        return _joined([p.local(e, f, b) for p, e, f, b in rows])

    return Space(lambda _: sum(moved), load, store, retract, local)


def product_group(sizes: Sequence[tuple[int, int]], parts: Sequence[GroupSpace]) -> GroupSpace:
    """The product of groups."""
    space, moved = product_space(sizes, parts), [dim for _, dim in sizes]

    def each(operation: Callable[[GroupSpace], Callable[..., Any]]) -> Callable[..., Element]:
        def value(*xs: Element) -> Element:
            own = zip(*xs, strict=True)
            return tuple(operation(p)(*of_part) for p, of_part in zip(parts, own, strict=True))

        return value

    def exp(d: Vector) -> Element:
        return tuple(p.exp(step) for p, step in zip(parts, _cut(d, moved), strict=True))

    def log(x: Element, branch: Branch) -> Vector:
        near = [None] * len(parts) if branch.near is None else _cut(branch.near, moved)
        rows = zip(parts, x, near, strict=True)
        return _joined([p.log(e, replace(branch, near=n, start=None)) for p, e, n in rows])

    return GroupSpace(
        space.dim, space.load, space.store, space.retract, space.local,
        each(lambda p: p.compose), each(lambda p: p.inverse), exp, log,
    )  # fmt: skip
