"""A picture of a pose graph, before and after. Needs matplotlib: `pip install liegen[examples]`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from g2o import Floats, Graph
from g2o_lines import EDGES, POSE

State = tuple[Mapping[str, Floats], float]  # vertices by manifold, and the error there


def new_figure() -> Any:
    """Raises RuntimeError where matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise RuntimeError(
            "the picture needs matplotlib: pip install liegen[examples], or use --no-picture"
        ) from error
    return Figure(figsize=(12, 6), layout="constrained")


def require_picture(out: Path) -> None:
    """What would fail after the solve fails before it. Raises RuntimeError with the cure."""
    known = new_figure().canvas.get_supported_filetypes()
    if out.suffix[1:].lower() not in known:
        raise RuntimeError(f"--out {out}: end the name of the picture with one of .{', .'.join(known)}")
    if not out.absolute().parent.is_dir() or out.is_dir():
        raise RuntimeError(f"--out {out}: give a file in a folder that exists")


def draw(graph: Graph, before: State, after: State, out: Path) -> None:
    """Two panels; edges between neighbours (odometry) in blue, all others (loop closures) in orange."""
    figure = new_figure()
    pairs = pairs_of_poses(graph)
    ids = graph.vertices[graph.group].ids[pairs]
    neighbours = np.abs(ids[:, 0] - ids[:, 1]) == 1
    points = next((name for name in graph.vertices if name != graph.group), None)
    for panel, (title, (values, error)) in enumerate([("before", before), ("after", after)], start=1):
        space = int(graph.group[-1])
        axes = figure.add_subplot(1, 2, panel, projection="3d" if space == 3 else None)
        ends = values[graph.group][:, -space:]
        gap = np.full((len(pairs), space), np.nan)  # lifts the pen between two edges
        lines = np.stack([ends[pairs[:, 0]], ends[pairs[:, 1]], gap], axis=1)
        axes.plot(*lines[~neighbours].reshape(-1, space).T, color="tab:orange", linewidth=0.4)
        axes.plot(*lines[neighbours].reshape(-1, space).T, color="tab:blue", linewidth=0.7)
        if points:
            axes.plot(*values[points].T, "k+", markersize=3)
        axes.set_title(f"{title}: error {error:.8g}")
        axes.set_aspect("equal")
    figure.savefig(out, dpi=120, bbox_inches="tight")


def pairs_of_poses(graph: Graph) -> Any:
    """(E, 2): the edges between two poses."""
    between = [e.ends for tag, e in graph.edges.items() if [t in POSE for t in EDGES[tag].ends] == [True] * 2]
    return np.concatenate([np.empty((0, 2), dtype=np.int64), *between])
