"""What was measured, as frozen values and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from .figures import BOUND, Figure, Measured
from .points import COLUMNS
from .undefined import Undefined
from .variants import Remark

UNIT = (
    "relative to max(1, s), s the largest absolute entry of the reference's block (small: of the inputs); on "
    "S2 times the sine of an angle beyond a quarter turn; retract by the vector part of a quaternion times "
    "w = cos(angle/2), its Jacobian by d times w^2"
)


@dataclass(frozen=True)
class Row:
    """A function in a chart; ``presets`` are those that have this chart for it."""

    function: str
    presets: tuple[str, ...]
    measured: Measured


@dataclass(frozen=True)
class Excess:
    """A figure beyond the bound."""

    function: str
    presets: tuple[str, ...]
    block: str
    target: str
    column: str
    kind: str
    error: float


@dataclass(frozen=True)
class AccuracyReport:
    """All figures. ``compiler`` is empty where there is none."""

    rows: tuple[Row, ...]
    undefined: tuple[Undefined, ...]
    remarks: tuple[Remark, ...]
    samples: int
    seed: int
    compiler: str

    @property
    def excesses(self) -> tuple[Excess, ...]:
        """Every figure beyond the bound, not a number included, the largest first."""
        found = [
            Excess(row.function, row.presets, f.block, f.target, COLUMNS[k], f.where[k], error)
            for row in self.rows
            for f in row.measured.figures
            for k, error in enumerate(f.worst)
            if error is not None and not error <= BOUND
        ]
        return tuple(sorted(found, key=lambda e: -e.error))

    @property
    def unmeasured(self) -> tuple[str, ...]:
        """Functions of which nothing could be compared."""
        compared = {
            row.function
            for row in self.rows
            if any(x is not None for f in row.measured.figures for x in f.worst)
        }
        return tuple(dict.fromkeys(r.function for r in self.rows if r.function not in compared))

    @property
    def passed(self) -> bool:
        """Whether something was compared of every function and no figure is beyond the bound."""
        return not self.excesses and not self.unmeasured

    def content(self) -> dict[str, Any]:
        """The report as plain values; numbers that are not finite become strings."""
        return {
            "passed": self.passed,
            "bound": BOUND,
            "unit": UNIT,
            "samples": self.samples,
            "seed": self.seed,
            "compiler": self.compiler,
            "angles": list(COLUMNS),
            "figures": [entry for row in self.rows for entry in _entries(row)],
            "exceeding": [_plain(asdict(e)) for e in self.excesses],
            "left_out": [
                {"function": row.function, "presets": row.presets, **asdict(left)}
                for row in self.rows
                for left in row.measured.left
            ],
            "undefined": [asdict(u) for u in self.undefined],
            "presets_that_do_not_apply": [asdict(r) for r in self.remarks],
        }

    def to_json(self) -> str:
        """The report as JSON."""
        return json.dumps(self.content(), indent=1, allow_nan=False) + "\n"


def largest(figures: Sequence[Figure], column: int) -> float | None:
    """The worst of some figures in a column; None where none of them has one."""
    return max((x for f in figures if (x := f.worst[column]) is not None), default=None)


def figure_entry(figure: Figure) -> dict[str, Any]:
    """A figure as plain values."""
    return {
        "block": figure.block,
        "kind": "value" if figure.is_value else "Jacobian",
        "target": figure.target,
        "worst": [_number(x) for x in figure.worst],
    }


def _entries(row: Row) -> list[dict[str, Any]]:
    return [
        {"function": row.function, "presets": row.presets, **figure_entry(f)} for f in row.measured.figures
    ]


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    return {key: _number(x) if isinstance(x, float) else x for key, x in values.items()}


def _number(x: float | None) -> float | str | None:
    return x if x is None or math.isfinite(x) else str(x)
