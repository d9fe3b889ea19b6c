"""liegen's stored values as GTSAM's objects and back, one row for each manifold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.errors import ToolError

from .signature import Argument

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """``made(gtsam, stored)`` is an object of GTSAM's class ``name``, ``stored(object)`` its numbers."""

    name: str
    made: Callable[[Any, Array], Any]
    stored: Callable[[Any], Any]


def _rot3(gtsam: Any, q: Array) -> Any:
    return gtsam.Rot3.Quaternion(q[3], q[0], q[1], q[2])


def _quaternion(rotation: Any) -> tuple[float, ...]:
    q = rotation.toQuaternion()
    return q.x(), q.y(), q.z(), q.w()


def _rot2(gtsam: Any, x: Array) -> Any:
    return gtsam.Rot2.fromCosSin(x[0], x[1])


#: By the name of the manifold. Vectors are arrays in GTSAM too, R1 is a float.
ROWS: Mapping[str, Row] = {
    "SO2": Row("Rot2", _rot2, lambda x: (x.c(), x.s())),
    "SE2": Row(
        "Pose2",
        lambda g, x: g.Pose2(_rot2(g, x), x[2:]),
        lambda x: (x.rotation().c(), x.rotation().s(), x.x(), x.y()),
    ),
    "SO3": Row("Rot3", _rot3, _quaternion),
    "SE3": Row(
        "Pose3",
        lambda g, x: g.Pose3(_rot3(g, x), x[4:]),
        lambda x: (*_quaternion(x.rotation()), *x.translation()),
    ),
    "S2": Row("Unit3", lambda g, x: g.Unit3(x), lambda x: x.point3()),
    "NavState": Row(
        "NavState",
        lambda g, x: g.NavState(_rot3(g, x), x[4:7], x[7:]),
        lambda x: (*_quaternion(x.attitude()), *x.position(), *x.velocity()),
    ),
    "Gal3": Row(
        "Gal3",
        lambda g, x: g.Gal3(_rot3(g, x), x[4:7], x[7:10], float(x[10])),
        lambda x: (*_quaternion(x.attitude()), *x.position(), *x.velocity(), x.time()),
    ),
    "Cal3_S2": Row("Cal3_S2", lambda g, x: g.Cal3_S2(*x), lambda x: x.vector()),
    "Cal3DS2": Row("Cal3DS2", lambda g, x: g.Cal3DS2(*x), lambda x: x.vector()),
    "Cal3Bundler": Row(
        "Cal3Bundler",
        lambda g, x: g.Cal3Bundler(*x),
        lambda x: (x.fx(), x.k1(), x.k2(), x.px(), x.py()),
    ),
}


def to_gtsam(gtsam: Any, argument: Argument, stored: Array) -> Any:
    """GTSAM's object. Raises ToolError for a manifold without a row, or whose class this GTSAM lacks."""
    if argument.vector:
        return float(stored[0]) if argument.dim == 1 else stored
    row = ROWS.get(argument.manifold)
    if row is None:
        known = ", ".join(f"{name} ({r.name})" for name, r in ROWS.items())
        raise ToolError(
            f"liegen knows no conversion of {argument.manifold} ({argument.name!r}) to a type of GTSAM; "
            f"it knows those of vectors, {known}; give a Python function that calls the factor instead"
        )
    if not hasattr(gtsam, row.name):
        raise ToolError(
            f"the installed GTSAM has no {row.name}, which {argument.name!r} needs; install a newer one"
        )
    return row.made(gtsam, stored)


def from_gtsam(argument: Argument, found: Any) -> Array | None:
    """The stored numbers of GTSAM's object; None where it is of another class than the argument's."""
    if argument.vector:
        try:
            numbers = np.atleast_1d(np.asarray(found, dtype=np.float64))
        except (TypeError, ValueError):
            return None
        return numbers if numbers.shape == (argument.dim,) else None
    row = ROWS.get(argument.manifold)
    if row is None or type(found).__name__ != row.name:
        return None
    return np.array([*row.stored(found)], dtype=np.float64)
