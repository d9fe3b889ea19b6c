"""Frames in the names of parameters: ``T_WB`` is the pose of B in W, ``p_W`` a point, ``v_W`` a free vector.

A name is a stem, an underscore and tokens. A token is a capital followed by lower-case letters and digits,
and tokens stand side by side, or it is what stands between underscores: ``T_WB``, ``T_WB1``, ``T_WBi``,
``T_Map_BaseLink``. ``frame_reading.py`` says what is made of it, and of the names of other libraries.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

from liegen.errors import DefinitionError
from liegen.manifolds.node import here

_TOKEN = re.compile("[A-Z][a-z0-9]*")
_TOKENS = re.compile("(?:[A-Z][a-z0-9]*)+")


class Kind(Enum):
    """What stands in a frame. Only ``POINT`` is moved by translations."""

    MAP = "map"  # a pose or rotation: from its inner to its outer frame
    CAMERA = "calibration"  # a map too, but its tangent is in no frame
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


def frames(*names: str, point: bool | None = None) -> Frames:
    """Declare the frames of a parameter: ``x: Annotated[SE3, frames("W", "B")]`` is the pose of B in W.

    A vector or direction has one frame; ``point=True`` makes a vector a point, ``point=False`` a free vector.
    ``frames()`` declares that the parameter has none, whatever its name.
    """
    if not all(isinstance(name, str) and name for name in names):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise DefinitionError(f'{here()}: a frame needs a name: frames("W", "B"), not an empty string')
    return Frames(names, point)


def split_name(name: str) -> tuple[str, tuple[str, ...]]:
    """Stem and what stands in capitals behind it: ``T_Map_BaseLink`` gives ``("T", ("Map", "BaseLink"))``."""
    segments = name.split("_")
    start = len(segments)
    while start > 1 and _TOKENS.fullmatch(segments[start - 1]):
        start -= 1
    return "_".join(segments[:start]), tuple(segments[start:])


def read_name(name: str) -> tuple[str, tuple[str, ...]]:
    """Stem and tokens of a name: ``T_WB1`` gives ``("T", ("W", "B1"))``; no tokens where it has no suffix.

    Segments between underscores are tokens where there are several.
    """
    stem, segments = split_name(name)
    return stem, segments if len(segments) > 1 else tuple(t for s in segments for t in _TOKEN.findall(s))


def print_name(stem: str, tokens: tuple[str, ...]) -> str:
    """The name that reads back as stem and tokens; words are parted by underscores."""
    words = any(len(t) > 2 for t in tokens)
    return "_".join((stem, ("_" if words else "").join(tokens))) if tokens else stem
