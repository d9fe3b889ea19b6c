"""Whether given values fit where frames are declared: arguments of a call, parts of a product."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from liegen.manifolds import Manifold, Product

from .frame_declared import Declared, is_map, pieces
from .frame_names import Kind
from .frame_terms import Frame, Framed, Solver


def misfit(
    name: str,
    manifold: type[Manifold],
    stated: Declared | None,
    given: Framed,
    solver: Solver,
    meant: Callable[[str], Frame],
) -> str | None:
    """Why a value does not fit what is declared of ``name``; None where it does.

    ``meant`` is the frame that a declared name stands for; it is found from the values given so far.
    """
    for piece, value in zip(pieces(name, manifold, stated), leaves(manifold, given), strict=True):
        d = piece.declared
        if d is None:
            continue
        ends = (value.outer, value.inner) if is_map(piece.manifold) else (value.outer,)
        for frame, own in zip(ends, d.names, strict=False):
            if not solver.equal(frame, meant(own)):
                return (
                    f"{piece.path!r} is given with frame {solver.name(frame)} "
                    f"where its {own} is {solver.name(meant(own))} by the others"
                )
        kind = value.kind if solver.declared(value.outer) else Kind.OPEN
        if {d.kind, kind} == {Kind.POINT, Kind.FREE}:
            return f"{piece.path!r} is a {d.kind.value} in {d.names[0]}, it is given a {kind.value}"
    return None


def leaves(manifold: type[Manifold], value: Framed) -> Iterator[Framed]:
    """The frames of what :func:`pieces` lists."""
    if not issubclass(manifold, Product):
        yield value
        return
    for kind, part in zip(manifold.part_classes.values(), value.parts, strict=True):
        yield from leaves(kind, part.value)
