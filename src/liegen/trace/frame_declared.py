"""What is declared of the frames of a parameter and of its parts: by names, or by ``Annotated``.

The names of a product's parts are read as those of parameters are; each argument of that class may rename
the frames, ``x_B1: State``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from liegen.errors import DefinitionError
from liegen.manifolds import S2, SO2, Calibration, Gal3, Manifold, Product, Value, Vector
from liegen.manifolds.extended import ExtendedPose
from liegen.manifolds.pose import Pose
from liegen.manifolds.rotation import Rotation
from liegen.manifolds.similarity import Similarity

from .frame_names import Frames, Kind, read_name
from .frame_reading import BEARING, DIRECTION, MAP, VECTOR, Reading, read

#: First letter or word of the names of points, and of vectors that translations do not move.
_POINTS = frozenset(("p", "q", "l", "t", "x", "point", "landmark", "position", "translation"))
_FREE = frozenset(
    ("v", "a", "w", "g", "f", "u", "n", "velocity", "acceleration", "gravity", "force", "omega")
)
#: Vectors of these dimensions live in a frame: those of plane and space, and twists of groups in MAPS.
_SPATIAL = (2, 3, 6, 7, 9, 10)
#: Classes whose elements have two frames, with how a report describes them. They compose, invert and move
#: vectors as poses do; an operation of their own, if they have any, needs a rule in frame_rules. The first
#: entry that fits counts.
MAPS: Mapping[type[Manifold], str] = {
    Calibration: "calibration, from {1} to {0}",
    Rotation: "rotation from {1} to {0}",
    Pose: "pose of {1} in {0}",
    ExtendedPose: "extended pose of {1} in {0}",
    Gal3: "event of {1} in {0}",
    Similarity: "similarity from {1} to {0}",
}


@dataclass(frozen=True)
class Declared:
    """The frames of a parameter, checked against its manifold.

    Of a product they are those that its parts name, in the order in which they first occur there.
    """

    names: tuple[str, ...]
    kind: Kind


@dataclass(frozen=True)
class Piece:
    """A value without parts, alone or in a product: where it is read (``x.T_WB``), and its frames."""

    path: str
    manifold: type[Manifold]
    declared: Declared | None


def is_map(manifold: type[Value]) -> bool:
    """Whether elements have two frames."""
    return issubclass(manifold, tuple(MAPS))


def map_kind(manifold: type[Value]) -> Kind:
    """The kind of an element with two frames."""
    return Kind.CAMERA if issubclass(manifold, Calibration) else Kind.MAP


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
    if issubclass(manifold, Product):
        return _of_product(name, manifold, annotated, what)
    counts = needed(manifold)
    if annotated is not None:
        if annotated.names and len(annotated.names) not in counts:
            _miscounted(manifold, annotated.names, counts, what)
        stem, point = read_name(name)[0], annotated.point
        return Declared(annotated.names, _kind(stem, manifold, point=point)) if annotated.names else None
    reading = as_read(name, manifold)
    if len(reading.names) not in counts:
        return None
    return Declared(reading.names, _kind(reading.stem, manifold, point=False if reading.within else None))


def as_read(name: str, manifold: type[Manifold]) -> Reading:
    """What the name of a value says of its frames; nothing of a product, or of what lives in none."""
    counts = needed(manifold)
    kinds: Mapping[tuple[int, ...], str] = {(2, 1): BEARING, (2,): MAP, (1, 2): VECTOR, (1,): DIRECTION}
    return read(name, kinds[counts]) if counts and not issubclass(manifold, Product) else Reading(name)


def _miscounted(manifold: type[Manifold], names: Sequence[str], counts: Sequence[int], what: str) -> None:
    few = " or ".join(map(str, sorted(counts))) or "no"
    own = class_frames(manifold) if issubclass(manifold, Product) else ()
    listed = f" ({', '.join(own)})" if own else ""
    raise DefinitionError(
        f"{what}: {manifold.form.name} has {few} frame{'s' if few not in ('1',) else ''}{listed}, "
        f"frames({', '.join(map(repr, names))}) names {len(names)}"
    )


def _kind(stem: str, manifold: type[Manifold], *, point: bool | None) -> Kind:
    if issubclass(manifold, S2):
        return Kind.FREE
    if not issubclass(manifold, Vector):
        return map_kind(manifold)
    if point is not None:
        return Kind.POINT if point else Kind.FREE
    word = stem.partition("_")[0].rstrip("0123456789")
    known = {**dict.fromkeys(_POINTS, Kind.POINT), **dict.fromkeys(_FREE, Kind.FREE)}
    return known.get(word, Kind.OPEN) if manifold.form.dim in (2, 3) else Kind.OPEN


# products


def _of_product(name: str, cls: type[Product], annotated: Frames | None, what: str) -> Declared | None:
    """The frames that the class names, renamed by the argument.

    A token of the argument's name renames the (longest) frame of the class that it begins with: ``x_B1``
    makes B of ``T_WB`` B1. A name that does not fit so says nothing. ``Annotated`` gives all of them in
    order. Where the class names none, two frames are those of its poses and rotations.
    """
    for part, kind, note in _notes(cls):  # mistakes of the class, found where it is used
        declared(part, kind, note, f"{what}: part {part!r}")
    own = class_frames(cls)
    if annotated is not None:
        counts = (len(own),) if own else (2,) if any(map(is_map, cls.part_classes.values())) else ()
        if annotated.names and len(annotated.names) not in counts:
            _miscounted(cls, annotated.names, counts, what)
        return Declared(annotated.names, Kind.OPEN) if annotated.names else None
    _, tokens = read_name(name)
    if not own:
        return Declared(tokens, Kind.OPEN) if len(tokens) == 2 else None
    meant = [max((f for f in own if token.startswith(f)), key=len, default="") for token in tokens]
    fits = "" not in meant and len(set(meant)) == len(meant)
    renamed = dict(zip(meant, tokens, strict=True))
    return Declared(tuple(renamed.get(frame, frame) if fits else frame for frame in own), Kind.OPEN)


def class_frames(cls: type[Product]) -> tuple[str, ...]:
    """The frames that the parts of a product name, in the order in which they first occur."""
    named = [d.names for _, _, d in _parts(cls) if d is not None]
    return tuple(dict.fromkeys(name for names in named for name in names))


def placed_frames(cls: type[Product]) -> tuple[str, ...]:
    """Those of them that a part places, as ``T_WB`` places B: every argument has its own."""
    maps = [p.declared for p in pieces("", cls, as_written(cls)) if is_map(p.manifold)]
    inner = {d.names[1] for d in maps if d is not None and len(d.names) > 1}
    return tuple(name for name in class_frames(cls) if name in inner)


def pieces(path: str, manifold: type[Manifold], stated: Declared | None) -> Iterator[Piece]:
    """The values without parts of which a value is made, each with its frames; of others the value itself."""
    if not issubclass(manifold, Product):
        yield Piece(path, manifold, stated)
        return
    for name, kind, frames in parts(manifold, stated):
        yield from pieces(f"{path}.{name}", kind, frames)


def parts(
    cls: type[Product], stated: Declared | None
) -> Iterator[tuple[str, type[Manifold], Declared | None]]:
    """Name, class and frames of each part of a product whose frames are stated."""
    own = class_frames(cls)
    names = dict(zip(own, stated.names if stated else (), strict=False))
    for name, kind, frames in _parts(cls):
        if stated is None:
            yield name, kind, None
        elif frames is not None:
            yield name, kind, Declared(tuple(names[n] for n in frames.names), frames.kind)
        else:
            pose = not own and is_map(kind)
            yield name, kind, Declared(stated.names, map_kind(kind)) if pose else None


def _parts(cls: type[Product]) -> Iterator[tuple[str, type[Manifold], Declared | None]]:
    """Name, class and frames of each part as the class writes them."""
    for name, kind, note in _notes(cls):
        yield name, kind, declared(name, kind, note, f"{cls.__name__}: part {name!r}")


def _notes(cls: type[Product]) -> Iterator[tuple[str, type[Manifold], Frames | None]]:
    for name, kind in cls.part_classes.items():
        found = (note for note in cls.part_notes.get(name, ()) if isinstance(note, Frames))
        yield name, kind, next(found, None)


def as_written(cls: type[Product]) -> Declared:
    """The frames of a product as its class names them."""
    return Declared(class_frames(cls), Kind.OPEN)
