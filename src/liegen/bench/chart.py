"""A bar chart of a comparison as SVG: time over that of liegen. The same data give the same bytes."""

from __future__ import annotations

import importlib
import io
from collections.abc import Sequence
from typing import Any

from liegen.errors import ToolError

from . import ours
from .draws import RANDOM
from .race import Entry, Result
from .report import peers_of

COLOURS = {"wrenfold": "#2f6f8f", "SymForce": "#c0792a", "Ceres": "#6b8f3a", "CasADi": "#8a5fa0"}
OTHER = "#777777"


def svg(results: Sequence[Result]) -> str:
    """One group of bars a function, one bar a peer: its best formulation and flags. Raises ToolError."""
    matplotlib = _library()
    figures: Any = importlib.import_module("matplotlib.figure")
    bars = {r.function: _bars(r) for r in results}
    names = list(dict.fromkeys(name for group in bars.values() for name in group))
    with matplotlib.rc_context({"svg.hashsalt": "liegen", "svg.fonttype": "none"}):
        figure = figures.Figure(figsize=(8, 1 + 0.28 * sum(len(g) + 1 for g in bars.values())))
        axes = figure.add_subplot()
        y, ticks = 0.0, list[float]()
        for group in bars.values():
            for name, ratio in group.items():
                axes.barh(y, ratio, color=COLOURS.get(name, OTHER), height=0.8)
                axes.text(ratio, y, f" {ratio:.1f}", va="center", fontsize=8)
                y += 1
            ticks.append(y - (len(group) + 1) / 2)
            y += 1
        axes.set_yticks(ticks, list(bars))
        axes.invert_yaxis()
        axes.axvline(1.0, color="black", linewidth=0.8)
        axes.set_xlabel("time over liegen's, value and all Jacobians (1: as fast)")
        handles = [axes.barh(0, 0, color=COLOURS.get(name, OTHER), label=name) for name in names]
        if handles:
            axes.legend(fontsize=8)
        figure.tight_layout()
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines()) + "\n"


def _library() -> Any:
    try:
        return importlib.import_module("matplotlib")
    except ImportError as error:
        raise ToolError(f"the chart needs matplotlib ({error}): pip install liegen[bench]") from None


def _bars(result: Result) -> dict[str, float]:
    own = next((e for e in result.best if e.variant.label == ours.NAME and e.agrees), None)
    best: dict[str, Entry] = {}
    for entry in peers_of(result):
        known = best.get(entry.variant.peer)
        if known is None or entry.times[RANDOM].median_ns < known.times[RANDOM].median_ns:
            best[entry.variant.peer] = entry
    return {peer: e.times[RANDOM].ratio / own.times[RANDOM].ratio for peer, e in best.items()} if own else {}
