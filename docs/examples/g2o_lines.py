"""The lines of a `.g2o` file: which there are, and what is on each.

One record a line, numbers apart by spaces, `#` starts a comment, metres and radians:

    VERTEX_SE2 id  x y theta                    EDGE_SE2 i j  dx dy dtheta  I11 I12 I13 I22 I23 I33
    VERTEX_SE3:QUAT id  x y z qx qy qz qw       EDGE_SE3:QUAT i j  x y z qx qy qz qw  I11 I12 ... I66
    VERTEX_XY id  x y                           EDGE_SE2_XY i j  x y  I11 I12 I22
    VERTEX_TRACKXYZ id  x y z                   EDGE_SE3_TRACKXYZ i j offset  x y z  I11 ... I33
    FIX id ...                                  PARAMS_SE3OFFSET id  x y z qx qy qz qw

`EDGES` has the other edges. A line that is wrong or unknown is an error with its number: a measurement that
is left out would change the result.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
#: Numbers as C reads them: float("1_0") is 10 in Python, a slip in a file.
WHOLE = re.compile(r"[+-]?[0-9]{1,18}")
REAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE)
SHOWN = 5  # wrong lines in one message


class G2oError(ValueError):
    """A file that is no usable pose graph; the message has the file, the line and the cure."""


@dataclass(frozen=True)
class Kind:
    """How elements of one manifold are written."""

    manifold: str
    space: int  # 2 or 3 dimensions
    numbers: str
    to_storage: Callable[[Floats], Floats]  # (..., width) in the file's order -> liegen's storage
    to_file: Callable[[Floats], Floats]  # and back
    tangent: tuple[int, ...]  # liegen's tangent order in terms of the file's

    @property
    def width(self) -> int:
        return len(self.numbers.split())


@dataclass(frozen=True)
class EdgeKind:
    """A measurement of one or two vertices."""

    ends: tuple[str, ...]  # tags of the vertices
    measured: Kind
    offset: bool = False  # the line names the pose of the sensor on the body, a PARAMS_SE3OFFSET


def se2_storage(values: Floats) -> Floats:
    x, y, theta = np.moveaxis(values, -1, 0)
    return np.stack([np.cos(theta), np.sin(theta), x, y], axis=-1)


def se2_numbers(stored: Floats) -> Floats:
    cos, sin, x, y = np.moveaxis(stored, -1, 0)
    return np.stack([x, y, np.arctan2(sin, cos)], axis=-1)


def se3_storage(values: Floats) -> Floats:
    """Files print few digits, so quaternions are made unit again."""
    translation, quaternion = values[..., :3], values[..., 3:]
    norm = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return np.concatenate([quaternion / norm, translation], axis=-1)


def se3_numbers(stored: Floats) -> Floats:
    return np.concatenate([stored[..., 4:], stored[..., :4]], axis=-1)


def so2_storage(values: Floats) -> Floats:
    return np.concatenate([np.cos(values), np.sin(values)], axis=-1)


def so2_numbers(stored: Floats) -> Floats:
    return np.arctan2(stored[..., 1:], stored[..., :1])


def as_it_is(values: Floats) -> Floats:
    return values


POSE2 = Kind("SE2", 2, "x y theta", se2_storage, se2_numbers, (0, 1, 2))
POSE3 = Kind("SE3", 3, "x y z qx qy qz qw", se3_storage, se3_numbers, (3, 4, 5, 0, 1, 2))
POINT2 = Kind("R2", 2, "x y", as_it_is, as_it_is, (0, 1))
POINT3 = Kind("R3", 3, "x y z", as_it_is, as_it_is, (0, 1, 2))
ANGLE = Kind("SO2", 2, "angle", so2_storage, so2_numbers, (0,))

POSE = {"VERTEX_SE2": POSE2, "VERTEX_SE3:QUAT": POSE3}
VERTEX = POSE | {"VERTEX_XY": POINT2, "VERTEX_TRACKXYZ": POINT3}
EDGES = {
    # pose j, a point, and its direction, in the frame of pose i
    "EDGE_SE2": EdgeKind(("VERTEX_SE2", "VERTEX_SE2"), POSE2),
    "EDGE_SE3:QUAT": EdgeKind(("VERTEX_SE3:QUAT", "VERTEX_SE3:QUAT"), POSE3),
    "EDGE_SE2_XY": EdgeKind(("VERTEX_SE2", "VERTEX_XY"), POINT2),
    "EDGE_SE3_TRACKXYZ": EdgeKind(("VERTEX_SE3:QUAT", "VERTEX_TRACKXYZ"), POINT3, offset=True),
    "EDGE_BEARING_SE2_XY": EdgeKind(("VERTEX_SE2", "VERTEX_XY"), ANGLE),
    # the vector from point i to point j, in the world
    "EDGE_POINTXY": EdgeKind(("VERTEX_XY", "VERTEX_XY"), POINT2),
    "EDGE_POINTXYZ": EdgeKind(("VERTEX_TRACKXYZ", "VERTEX_TRACKXYZ"), POINT3),
    # a pose, its position alone, a point, in the world
    "EDGE_PRIOR_SE2": EdgeKind(("VERTEX_SE2",), POSE2),
    "EDGE_SE3_PRIOR": EdgeKind(("VERTEX_SE3:QUAT",), POSE3, offset=True),
    "EDGE_PRIOR_SE2_XY": EdgeKind(("VERTEX_SE2",), POINT2),
    "EDGE_SE3_XYZ_PRIOR": EdgeKind(("VERTEX_SE3:QUAT",), POINT3, offset=True),
    "EDGE_PRIOR_XY": EdgeKind(("VERTEX_XY",), POINT2),
    "EDGE_POINTXYZ_PRIOR": EdgeKind(("VERTEX_TRACKXYZ",), POINT3),
}
OFFSET = "PARAMS_SE3OFFSET"
FIX = "FIX"
KNOWN = (*VERTEX, *EDGES, FIX, OFFSET)


@dataclass(frozen=True)
class Record:
    line: int
    tag: str
    ids: tuple[int, ...]
    values: tuple[float, ...]
    offset: int | None = None  # the id of a PARAMS_SE3OFFSET


def parse(name: str, lines: Sequence[str]) -> list[Record]:
    """The records of a file. Raises `G2oError` with each line that is wrong, the first five of many."""
    records: list[Record] = []
    wrong: list[str] = []
    for number, text in enumerate(lines, start=1):
        tag, *words = text.partition("#")[0].split() or [""]
        if not tag:
            continue
        try:
            records.append(parse_record(number, tag, words))
        except ValueError as error:
            wrong.append(f"{name}:{number}: {error}")
    if wrong:
        more = [f"and {len(wrong) - SHOWN} more wrong lines"] if len(wrong) > SHOWN else []
        raise G2oError("\n".join([*wrong[:SHOWN], *more]))
    return records


def parse_record(line: int, tag: str, words: Sequence[str]) -> Record:
    """Raises ValueError with what is wrong in the line."""
    if tag not in KNOWN:
        raise ValueError(
            f"no factor for {tag!r:.60}, and without the line the result would be another one. Remove it, or "
            f"bring it into one of {', '.join(KNOWN)}."
        )
    n_ids, layout = expected(tag, len(words))
    needed = len(layout) if tag != FIX else max(len(words), 1)
    shown = " ".join(layout)
    if len(words) != needed:
        raise ValueError(
            f"{tag} needs {needed} numbers ({shown}) but has {len(words)}. "
            "Is the line cut short, or are two lines joined?"
        )
    for word, form in zip(words, [WHOLE] * n_ids + [REAL] * (needed - n_ids), strict=True):
        if not form.fullmatch(word):
            what = "an id is a whole number of at most 18 digits" if form is WHOLE else "that is no number"
            raise ValueError(f"{tag} needs numbers ({shown}), ids whole: {word!r:.60}: {what}.")
    ids, values = [int(w) for w in words[:n_ids]], tuple(float(w) for w in words[n_ids:])
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{tag} has a number that is not finite. Remove or correct the line.")
    start = layout.index("qx") - n_ids if "qx" in layout else None
    if start is not None and abs(np.linalg.norm(values[start : start + 4]) - 1) > 0.01:
        raise ValueError(
            f"the quaternion of {tag} has length {np.linalg.norm(values[start : start + 4]):.4g}, not 1. "
            "The order is x y z qx qy qz qw."
        )
    offset = ids.pop() if tag in EDGES and EDGES[tag].offset else None
    return Record(line, tag, tuple(ids), values, offset)


def expected(tag: str, found: int) -> tuple[int, list[str]]:
    """How many ids a line with this tag begins with, and the names of all its numbers."""
    if tag == FIX:
        return found, ["id", "..."]
    if tag == OFFSET or tag in VERTEX:
        return 1, ["id", *VERTEX.get(tag, POSE3).numbers.split()]
    kind = EDGES[tag]
    ids = [*"ij"[: len(kind.ends)], *["offset"] * kind.offset]
    k = len(kind.measured.tangent)
    information = [f"I{row + 1}{column + 1}" for row in range(k) for column in range(row, k)]
    return len(ids), [*ids, *kind.measured.numbers.split(), *information]
