"""Frames that are known, frames that are sought, and the solver that makes them equal."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate

from .frame_names import Kind

_WORD = re.compile("[a-z_]{3,}")


@dataclass(frozen=True)
class Known:
    """A frame that a name declares."""

    name: str


@dataclass(frozen=True, eq=False)
class Sought:
    """A frame that is not declared. ``label`` says what it is while nothing else is known.

    What an ``untyped`` frame teaches may inform a report but never causes an error, except that it is none
    of ``others``: frames that the class of a product tells apart from it. With such it is a frame by itself,
    named by its label.
    """

    label: str = ""
    untyped: bool = True
    others: tuple[str, ...] = ()


Frame = Known | Sought


@dataclass(frozen=True)
class Framed:
    """The frames of a value. Only maps have an inner frame that differs from the outer one.

    Products, and vectors that are stacked or of a product's tangent, have parts with frames of their own.
    """

    outer: Frame
    inner: Frame
    kind: Kind
    parts: tuple[Part, ...] = ()

    def flat(self, start: int = 0) -> Iterator[Part]:
        """The parts of all parts, by their place in the tangent; none where there is only one value."""
        for part in self.parts:
            inner = list(part.value.flat(start + part.start))
            yield from inner or [Part(part.value, start + part.start, start + part.stop)]


@dataclass(frozen=True)
class Part:
    """The frames of a part, and its coordinates in the tangent (``stop`` not counted)."""

    value: Framed
    start: int
    stop: int


def _follows(a: Sought, b: Sought) -> bool:
    """Which of two frames points to the other: what is untyped must not taint, what has a label stays."""
    return (not a.others, a.untyped, not a.label) > (not b.others, b.untyped, not b.label)


@dataclass
class Solver:
    """Equations between the frames of one graph."""

    #: What a sought frame was found to be, and whether only untyped names say so.
    _bound: dict[Sought, tuple[Frame, bool]] = field(default_factory=dict[Sought, tuple[Frame, bool]])

    def _find(self, frame: Frame) -> tuple[Frame, bool]:
        untyped = False
        while isinstance(frame, Sought):
            untyped |= frame.untyped
            found = self._bound.get(frame)
            if found is None:
                break
            frame, untyped = found[0], untyped or found[1]
        return frame, untyped

    def equal(self, a: Frame, b: Frame) -> bool:
        """Make two frames one. False where declared names say that they differ."""
        (x, x_untyped), (y, y_untyped) = self._find(a), self._find(b)
        untyped = x_untyped or y_untyped
        if x == y:
            return True
        if not isinstance(x, Sought) and not isinstance(y, Sought):
            return untyped or alike(x.name, y.name)
        if not isinstance(x, Sought) or (isinstance(y, Sought) and _follows(y, x)):
            x, y = y, x
        assert isinstance(x, Sought)
        if isinstance(y, Known) and y.name in x.others:
            return False
        if not (isinstance(y, Sought) and x.others and y.others):  # two by themselves are not one
            self._bound[x] = (y, untyped)
        return True

    def name(self, frame: Frame) -> str | None:
        """The name of a frame, if it is known or inferred."""
        found, _ = self._find(frame)
        if isinstance(found, Known):
            return found.name
        return found.label if found.others else None

    def said(self, frame: Frame) -> str | None:
        """The name of a frame, or a description such as ``the body frame of x``."""
        found, _ = self._find(frame)
        own = frame.label if isinstance(frame, Sought) else ""
        return self.name(frame) or own or (found.label if isinstance(found, Sought) else "") or None

    def declared(self, frame: Frame) -> bool:
        """Whether the frame is known from declared names alone."""
        found, untyped = self._find(frame)
        return isinstance(found, Known) and not untyped

    def same(self, a: Frame, b: Frame) -> bool:
        """Whether two frames are known to be one."""
        x, y = self.name(a), self.name(b)
        return x is not None and x == y


def alike(a: str, b: str) -> bool:
    """Whether two names may mean one frame: ``w`` and ``W``, ``W`` and ``world``; never ``B`` and ``B1``."""
    short, long = sorted((a.casefold(), b.casefold()), key=len)
    return short == long or (len(short) == 1 and long.startswith(short) and _WORD.fullmatch(long) is not None)


def vector(frame: Frame, kind: Kind) -> Framed:
    """A vector or direction in a frame."""
    return Framed(frame, frame, kind)


def mapping(outer: Frame, inner: Frame, kind: Kind = Kind.MAP) -> Framed:
    """A map from its inner to its outer frame."""
    return Framed(outer, inner, kind)


def sought(label: str = "") -> Framed:
    """A vector of which nothing is declared."""
    return vector(Sought(label), Kind.OPEN)


def made_of(values: Sequence[Framed], dims: Sequence[int]) -> Framed:
    """A value of these parts, whose tangents have these dimensions."""
    ends = list(accumulate(dims, initial=0))
    return replace(
        sought(),
        parts=tuple(Part(v, a, b) for v, a, b in zip(values, ends, ends[1:], strict=False)),
    )


def common(kinds: Sequence[Kind]) -> Kind:
    """The kind that all have, else open."""
    return kinds[0] if len(set(kinds)) == 1 else Kind.OPEN
