"""The coordinates of a tangent: their names, and which of them belong together."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.charts import GTSAM, Preset, form_chart
from liegen.charts.poses import PoseChart
from liegen.manifolds import ManifoldForm
from liegen.manifolds.form import PoseForm, RotationForm

#: What coordinates with a unit are, of a manifold that has several kinds of them.
_KINDS = {"rad": "rotation", "m": "translation", "m/s": "velocity", "s": "time", "px": "intrinsic"}


@dataclass(frozen=True)
class Block:
    """Coordinates of one kind, one after the other."""

    label: str
    place: slice

    @property
    def size(self) -> int:
        """How many coordinates it has."""
        return len(self.columns)

    @property
    def columns(self) -> range:
        """Their indices."""
        return range(self.place.start, self.place.stop)


def names(form: ManifoldForm, preset: Preset = GTSAM) -> tuple[str, ...]:
    """The names of the tangent's coordinates with units, in the order of the chart."""
    own = tuple(form.tangent)
    chart = form_chart(form, preset)
    if not isinstance(chart, PoseChart) or not isinstance(form, PoseForm):
        return own
    n = form.rotation.dim if form.rotation_first else form.rotation.space
    first, second = own[:n], own[n:]
    return own if chart.rotation_first == form.rotation_first else (*second, *first)


def blocks(form: ManifoldForm, preset: Preset = GTSAM) -> tuple[Block, ...]:
    """The coordinates of each kind."""
    kinds = [_kind(name) for name in names(form, preset)]
    found: list[Block] = []
    start = 0
    for kind, members in groupby(kinds):
        stop = start + len(list(members))
        found.append(Block(kind, slice(start, stop)))
        start = stop
    return tuple(found)


def _kind(name: str) -> str:
    if "log scale" in name:
        return name.replace("log scale", "scale")
    before, _, unit = name.partition(" [")
    part = before.rpartition("_")[0]
    kind = _KINDS.get(unit.rstrip("]"), "")
    return f"{part} {kind}".strip()


def turning(form: ManifoldForm, preset: Preset = GTSAM) -> NDArray[np.bool_]:
    """Which coordinates are rotations."""
    marked = np.zeros(form.dim, dtype=bool)
    if form.turns or form.parts:
        for block in blocks(form, preset):
            marked[block.place] = block.label.endswith("rotation")
    return marked


def rotation_of(form: Any) -> Any:
    """The rotations within a group's elements; None where there are none."""
    return form if isinstance(form, RotationForm) else getattr(form, "rotation", None)
