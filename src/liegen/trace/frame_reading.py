"""How the name of a value that may live in frames is read: liegen's names, and those of other libraries.

A name that could mean two things is read as none, with a note that says what to write: an error about frames
that nobody meant is worse than no check.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from .frame_names import split_name

#: What a value has two of, or one: a pose or rotation, a rotation that may be a bearing, a direction, ...
MAP, BEARING, DIRECTION, VECTOR = "map", "bearing", "direction", "vector"


@dataclass(frozen=True)
class Reading:
    """What a name says: the stem, the frames (outer first), and how it was read or why not.

    ``as_`` shows the naming, empty for liegen's own. ``within``: a vector is in the first frame, but is no
    point of it. A note stands where no frames do.
    """

    stem: str
    names: tuple[str, ...] = ()
    as_: str = ""
    within: bool = False
    note: str = ""


#: A frame in small letters: one word, or several that end as the frames of ROS do.
_WORD = r"[a-z][a-z0-9]*(?:(?:_[a-z][a-z0-9]*)*_(?:link|frame|footprint))?"
_CAPITAL = r"[A-Z][A-Za-z0-9]*"
#: One letter or an acronym, with a number.
_SHORT = r"[A-Z]+[0-9]*"
_MAP_STEM = r"[TRSXHPCq]"
_POINT_STEMS = r"p|q|l|t|x|r|point|landmark|position|translation"
_FREE_STEMS = r"v|a|w|g|f|u|n|velocity|acceleration|gravity|force|omega"


@dataclass(frozen=True)
class _Naming:
    """A naming of other libraries; its groups are called outer, inner and stem."""

    shown: str
    pattern: re.Pattern[str]


def _naming(shown: str, pattern: str) -> _Naming:
    return _Naming(shown, re.compile(pattern))


_OF_MAPS = (
    _naming("world_T_body", rf"(?P<outer>{_WORD})_(?P<stem>{_MAP_STEM})_(?P<inner>{_WORD})"),
    _naming("W_T_B", rf"(?P<outer>(?![TRSXK]_){_CAPITAL})_(?P<stem>[TRS])_(?P<inner>{_CAPITAL})"),
    _naming("wTb", r"(?P<outer>[a-z]\d*)(?P<stem>[TRSXP])(?P<inner>[a-z][ijk]?\d*)"),
    _naming("R_GtoI", rf"(?P<stem>[A-Za-z]\w*?)_(?P<inner>{_SHORT})to(?P<outer>{_CAPITAL})"),
    _naming("T_W_from_B", rf"(?:(?P<stem>[A-Za-z]+)_)?(?P<outer>{_CAPITAL})_from_(?P<inner>{_CAPITAL})"),
    _naming("world_from_body", rf"(?:(?P<stem>[A-Z])_)?(?P<outer>{_WORD})_from_(?P<inner>{_WORD})"),
    _naming("T_IinG", rf"(?P<stem>[A-Za-z]\w*?)_(?P<inner>{_SHORT})in(?P<outer>{_CAPITAL})"),
    _naming("T_I_in_G", rf"(?P<stem>[A-Za-z]+)_(?P<inner>{_CAPITAL})_in_(?P<outer>{_CAPITAL})"),
)
_OF_VECTORS = (
    _naming("p_IinG", rf"(?P<stem>[a-z]\w*?)_(?P<inner>{_SHORT})in(?P<outer>{_CAPITAL})"),
    _naming("p_I_in_G", rf"(?P<stem>[a-z]+)_(?P<inner>{_CAPITAL})_in_(?P<outer>{_CAPITAL})"),
    _naming("g_inG", rf"(?P<stem>[a-z]\w*?)_in(?P<outer>{_CAPITAL})"),
    _naming("W_p_B", rf"(?P<outer>{_CAPITAL})_(?P<stem>{_POINT_STEMS}|{_FREE_STEMS})_(?P<inner>{_CAPITAL})"),
)
#: What stands beside a letter or "from" and names no frame.
_NO_FRAMES = re.compile(
    "d|delta|meas|measured|prior|est|estimate|init|prev|next|last|true|gt|pose|rot|rotation|tf|transform|"
    "odometry|loop|gps|ij|jk"
)
#: Names of vectors whose suffix is a sensor, not a frame: biases of accelerometer and gyroscope.
_SENSOR = re.compile(
    r"(?:b|ba|bg|bias|sigma|std|noise)(?:_\w+)?_(?:A|G|M|Acc\w*|Gyr\w*|Mag\w*|ACC|GYRO?|MAG)"
)
_ACRONYMS = re.compile(
    "(?:IMU|CAM|GPS|GNSS|LIDAR|RADAR|LASER|ENU|NED|NWU|FRD|FLU|ECEF|ECI|UTM|MAP|ODOM|BASE|BODY|WORLD|ROBOT)"
    "[0-9]*"
)
_WAY = "what 'to' means differs between libraries: the way of points, or that of frames"
_WORDY = re.compile("[A-Z][a-z]{2,}[0-9]*")
_TOKEN = re.compile("[A-Z][a-z0-9]*")


def read(name: str, kind: str) -> Reading:
    """What a name says of the frames of a value of this kind."""
    if kind == VECTOR and _SENSOR.fullmatch(name):
        return _none(name, "a sensor's bias or noise, no frame")
    for naming in _OF_MAPS if kind in (MAP, BEARING) else _OF_VECTORS if kind == VECTOR else ():
        found = naming.pattern.fullmatch(name)
        if found:
            return _foreign(naming, found.groupdict())
    stem, segments = split_name(name)
    if segments and kind == MAP and re.search("_to_|[A-Za-z]To[A-Z]", name):
        return _none(stem, _WAY)
    if not segments:
        return _none(stem, _complaint(name, kind))
    if len(segments) == 1:
        return _SINGLE[kind](stem, segments[0])
    if len(segments) == 2:
        return _two(stem, segments, kind)
    return _none(stem, f"{len(segments)} frames, {', '.join(segments)}")


def _none(stem: str, note: str) -> Reading:
    return Reading(stem, note=note)


def _foreign(naming: _Naming, groups: dict[str, str | None]) -> Reading:
    stem, outer, inner = groups["stem"] or "", str(groups["outer"]), groups.get("inner")
    if naming.shown == "W_p_B":  # W_p_B, or the numbers in W of something of A and B: W_v_AB
        tokens = _TOKEN.findall(str(inner))
        point = re.fullmatch(_POINT_STEMS, stem) is not None
        return Reading(stem, (outer,), naming.shown, within=point and len(tokens) > 1 and tokens[0] != outer)
    strange = next((word for word in (outer, inner) if word and _NO_FRAMES.fullmatch(word)), None)
    if strange or outer == inner:
        return _none(stem, f"{strange} names no frame" if strange else f"both frames are {outer}")
    names = (outer,) if inner is None else (outer, inner)
    return Reading(stem, names, naming.shown)


def _two(stem: str, segments: tuple[str, ...], kind: str) -> Reading:
    """``T_Map_BaseLink``: the segments are the frames."""
    pair = next((s for s in segments if len(_TOKEN.findall(s)) == 2 and not _words(s)), None)
    if pair:
        return _none(stem, f"{pair} may be one frame or two")
    if kind in (MAP, BEARING) and segments[0] in ("T", "R", "X") and stem != "T":
        return _none(stem, f"{segments[0]} may be a frame, or stand for the value as in W_T_B")
    return _none(stem, "two frames, where one is meant") if kind == DIRECTION else Reading(stem, segments)


def _words(segment: str) -> bool:
    return all(map(_WORDY.fullmatch, _TOKEN.findall(segment)))


def _map(stem: str, segment: str) -> Reading:
    """``T_WB``, ``T_WBi``, ``T_WCam``."""
    tokens = tuple(_TOKEN.findall(segment))
    if len(tokens) == 2 and _words(segment):
        return _none(stem, f"{segment} may be one frame or two, as in {stem}_{'_'.join(tokens)}")
    if re.fullmatch("[A-Z]2[A-Z]", segment):
        return _none(stem, f"{segment} may mean {segment[0]} to {segment[2]}, or the frame {segment[:2]}")
    if segment == "GT":
        return _none(stem, "GT is the true value")
    if len(tokens) == 2:
        return Reading(stem, tokens)
    return _none(stem, "one frame, where two are meant" if len(tokens) == 1 else f"{segment} is not parted")


def _bearing(stem: str, segment: str) -> Reading:
    """``R_WB``, a rotation; ``b_W``, a bearing."""
    one = _TOKEN.fullmatch(segment) or _ACRONYMS.fullmatch(segment)
    return Reading(stem, (segment,)) if one else _map(stem, segment)


def _vector(stem: str, segment: str) -> Reading:
    """``p_W``, ``p_BaseLink``, ``p_ENU`` in one frame, ``t_WB`` from one to another."""
    tokens = tuple(_TOKEN.findall(segment))
    if segment == "GT":
        return _none(stem, "GT is the true value")
    if len(tokens) == 1 or _words(segment) or _ACRONYMS.fullmatch(segment):
        return Reading(stem, (segment,))
    return Reading(stem, tokens) if len(tokens) == 2 else _none(stem, f"{segment} is not parted")


def _direction(stem: str, segment: str) -> Reading:
    """``n_W``."""
    reading = _vector(stem, segment)
    many = len(reading.names) > 1
    return _none(stem, "two frames, where one is meant") if many else reading


_SINGLE: dict[str, Callable[[str, str], Reading]] = {
    MAP: _map, BEARING: _bearing, DIRECTION: _direction, VECTOR: _vector
}  # fmt: skip

#: Names without a suffix in capitals that look as if they meant frames all the same: why they are not read.
_COMPLAINTS = (
    (MAP, r"[TRSXHCq]_[a-z]{2}[0-9]*|[TRSXH][a-z]{2}", "small letters may be indices"),
    (MAP, r"[TRSXHq]_[a-z][a-z0-9]*(_[a-z][a-z0-9]*)+", "words in small letters are not parted"),
    (MAP, r"\w*[a-zA-Z0-9](_to_|To|2)[A-Za-z]\w*", _WAY),
    (MAP, rf"\w+_{_MAP_STEM}_\w+", "the frames around the letter are not both one word"),
    (MAP, r"[TRSXH][A-Z]{2}[0-9]*", "there is no underscore before the frames"),
    (MAP, r"[a-z]{1,4}[TRSX][a-z]{1,4}", "frames of several letters are not parted"),
    (MAP, r"[TRSXH]_[0-9]+(_[0-9]+)?", "numbers are no frames"),
    (VECTOR, rf"[a-z]\w*_(?:p|t|r|v)_[a-z]\w*|(?:{_POINT_STEMS}|v)_[a-z][0-9]*",
     "small letters may be indices"),
    (VECTOR, r"[a-z]\d*[PV][a-z]?\d*", "there is no underscore before the frame"),
)  # fmt: skip
_SUFFIXED = re.compile(r"\w+?_(?:[A-Z][a-z0-9]*)+_[a-z0-9]\w*")


def _complaint(name: str, kind: str) -> str:
    of = MAP if kind == BEARING else kind
    found = (why for which, pattern, why in _COMPLAINTS if which == of and re.fullmatch(pattern, name))
    return next(found, "frames stand at the end of a name" if _SUFFIXED.fullmatch(name) else "")
