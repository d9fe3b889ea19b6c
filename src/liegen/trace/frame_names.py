"""Frames in the names of parameters: ``T_WB`` is the pose of B in W, ``p_W`` a point, ``v_W`` a free vector.

A name is a stem, an underscore and tokens. A token is a capital followed by lower-case letters and digits;
tokens stand side by side or between underscores: ``T_WB``, ``T_WB1``, ``T_WBi``, ``T_World_Cam``. Other names
have no frames.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

from liegen.errors import DefinitionError
from liegen.manifolds import S2, SO2, Calibration, Manifold, Value, Vector
from liegen.manifolds.node import here
from liegen.manifolds.pose import Pose
from liegen.manifolds.rotation import Rotation
from liegen.manifolds.similarity import Similarity

_TOKEN = re.compile("[A-Z][a-z0-9]*")
_TOKENS = re.compile("(?:[A-Z][a-z0-9]*)+")
#: First letter or word of the names of points, and of vectors that translations do not move.
_POINTS = frozenset(("p", "q", "l", "t", "x", "point", "landmark", "position", "translation"))
_FREE = frozenset(
    ("v", "a", "w", "g", "f", "u", "n", "velocity", "acceleration", "gravity", "force", "omega")
)
#: Vectors of these dimensions live in a frame: those of plane and space, and twists of SE(2) and SE(3).
_SPATIAL = (2, 3, 6)


class Kind(Enum):
    """What stands in a frame. Only ``POINT`` is moved by translations."""

    MAP = "map"  # a pose, rotation or calibration: from its inner to its outer frame
    POINT = "point"
    FREE = "free vector"
    DIFFERENCE = "difference of points"  # a free vector; rotated, it may serve as a point
    TANGENT = "tangent vector"
    OPEN = "vector"  # not known which


@dataclass(frozen=True)
class Frames:
    """The frames of a parameter as declared: two of a map (outer, inner), one of a vector or direction."""

    names: tuple[str, ...]
    point: bool | None = None


@dataclass(frozen=True)
class Declared:
    """The frames of a parameter, checked against its manifold."""

    names: tuple[str, ...]
    kind: Kind


def frames(*names: str, point: bool | None = None) -> Frames:
    """Declare the frames of a parameter: ``x: Annotated[SE3, frames("W", "B")]`` is the pose of B in W.

    A vector or direction has one frame; ``point=True`` makes a vector a point, ``point=False`` a free vector.
    ``frames()`` declares that the parameter has none, whatever its name.
    """
    if not all(names):
        raise DefinitionError(f'{here()}: a frame needs a name: frames("W", "B"), not an empty string')
    return Frames(names, point)


def read_name(name: str) -> tuple[str, tuple[str, ...]]:
    """Stem and tokens of a name: ``T_WB1`` gives ``("T", ("W", "B1"))``; no tokens where it has no suffix."""
    segments = name.split("_")
    start = len(segments)
    while start > 1 and _TOKENS.fullmatch(segments[start - 1]):
        start -= 1
    return "_".join(segments[:start]), tuple(t for s in segments[start:] for t in _TOKEN.findall(s))


def print_name(stem: str, tokens: tuple[str, ...]) -> str:
    """The name that reads back as stem and tokens; words are parted by underscores."""
    words = any(len(t) > 2 for t in tokens)
    return "_".join((stem, ("_" if words else "").join(tokens))) if tokens else stem


def is_map(manifold: type[Value]) -> bool:
    """Whether elements have two frames."""
    return issubclass(manifold, Pose | Rotation | Similarity | Calibration)


def needed(manifold: type[Manifold]) -> tuple[int, ...]:
    """How many frames a name may give to an element of a manifold; none where it lives in no frame."""
    if issubclass(manifold, SO2):
        return (2, 1)  # a rotation, or a bearing in one frame
    if is_map(manifold):
        return (2,)
    if issubclass(manifold, Vector):
        return (1, 2) if manifold.form.dim in _SPATIAL else ()  # t_WB: where B is, in W
    return (1,) if issubclass(manifold, S2) else ()


def declared(name: str, manifold: type[Manifold], annotated: Frames | None, what: str) -> Declared | None:
    """The frames of a parameter, from its annotation or else from its name; None where it has none.

    Raises DefinitionError for an annotation with a number of frames that the manifold does not have.
    """
    stem, tokens = read_name(name)
    counts = needed(manifold)
    if annotated is not None:
        tokens = annotated.names
        if tokens and len(tokens) not in counts:
            few = " or ".join(map(str, sorted(counts))) or "no"
            called = manifold.form.name
            raise DefinitionError(
                f"{what}: {called} has {few} frame{'s' if few not in ('1',) else ''}, "
                f"frames({', '.join(map(repr, tokens))}) names {len(tokens)}"
            )
    if len(tokens) not in counts:
        return None
    point = annotated.point if annotated is not None else None
    return Declared(tokens, _kind(stem, manifold, point=point))


def _kind(stem: str, manifold: type[Manifold], *, point: bool | None) -> Kind:
    if issubclass(manifold, S2):
        return Kind.FREE
    if not issubclass(manifold, Vector):
        return Kind.MAP
    if point is not None:
        return Kind.POINT if point else Kind.FREE
    word = stem.partition("_")[0].rstrip("0123456789")
    known = {**dict.fromkeys(_POINTS, Kind.POINT), **dict.fromkeys(_FREE, Kind.FREE)}
    return known.get(word, Kind.OPEN) if manifold.form.dim in (2, 3) else Kind.OPEN
