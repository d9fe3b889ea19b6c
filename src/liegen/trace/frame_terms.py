"""Frames that are known, frames that are sought, and the solver that makes them equal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from .frame_names import Kind


@dataclass(frozen=True)
class Known:
    """A frame that a name declares."""

    name: str


@dataclass(frozen=True, eq=False)
class Sought:
    """A frame that is not declared. ``label`` says what it is while nothing else is known.

    What an ``untyped`` frame teaches may inform a report but never causes an error.
    """

    label: str = ""
    untyped: bool = True


Frame = Known | Sought


@dataclass(frozen=True)
class Framed:
    """The frames of a value. Only maps have an inner frame that differs from the outer one."""

    outer: Frame
    inner: Frame
    kind: Kind


def _follows(a: Sought, b: Sought) -> bool:
    """Which of two frames points to the other: what is untyped must not taint, what has a label stays."""
    return (a.untyped, not a.label) > (b.untyped, not b.label)


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
            return untyped
        if not isinstance(x, Sought) or (isinstance(y, Sought) and _follows(y, x)):
            x, y = y, x
        assert isinstance(x, Sought)
        self._bound[x] = (y, untyped)
        return True

    def name(self, frame: Frame) -> str | None:
        """The name of a frame, if it is known or inferred."""
        found, _ = self._find(frame)
        return found.name if isinstance(found, Known) else None

    def said(self, frame: Frame) -> str | None:
        """The name of a frame, or a description such as ``the body frame of x``."""
        found, _ = self._find(frame)
        if isinstance(found, Known):
            return found.name
        own = frame.label if isinstance(frame, Sought) else ""
        return own or found.label or None

    def declared(self, frame: Frame) -> bool:
        """Whether the frame is known from declared names alone."""
        found, untyped = self._find(frame)
        return isinstance(found, Known) and not untyped

    def same(self, a: Frame, b: Frame) -> bool:
        """Whether two frames are known to be one."""
        x, y = self.name(a), self.name(b)
        return x is not None and x == y


def vector(frame: Frame, kind: Kind) -> Framed:
    """A vector or direction in a frame."""
    return Framed(frame, frame, kind)


def mapping(outer: Frame, inner: Frame) -> Framed:
    """A map from its inner to its outer frame."""
    return Framed(outer, inner, Kind.MAP)


def sought(outer: str = "", inner: str = "", *, is_map: bool) -> Framed:
    """A value of which nothing is declared."""
    if is_map:
        return mapping(Sought(outer), Sought(inner))
    return vector(Sought(outer), Kind.OPEN)


def common(kinds: Sequence[Kind]) -> Kind:
    """The kind that all have, else open."""
    return kinds[0] if len(set(kinds)) == 1 else Kind.OPEN
