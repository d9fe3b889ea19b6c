"""Figures of peers, at the samples and against the reference of liegen's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from liegen.verify.backends import workspace
from liegen.verify.draws import AnyFunction
from liegen.verify.expected import Expected

from ..figures import Figure, figures_of, reference_blocks, target_figures
from ..points import Point, draw_points
from ..report import figure_entry
from . import gtsam_peer, jaxlie_peer, sophus_peer, symforce_peer
from .contract import Operation, Peer

LOADERS: Mapping[str, Callable[[], Peer]] = {
    "gtsam": gtsam_peer.load,
    "symforce": symforce_peer.load,
    "jaxlie": jaxlie_peer.load,
    "sophuspy": sophus_peer.load,
}
#: The operations that peers are asked for, in the order of the table.
ASKED = tuple(
    name
    for group in ("so3", "se3", "se2")
    for name in (
        f"between_{group}",
        f"{group}_log",
        f"{group}_exp",
        f"{group}_Jr",
        f"{group}_Jr_inv",
    )
)


@dataclass(frozen=True)
class PeerRow:
    """A block: liegen's figures of C and NumPy in the chart of the libraries, and theirs by name."""

    function: str
    preset: str
    block: str
    ours: tuple[Figure, ...]
    theirs: tuple[tuple[str, Figure], ...]


@dataclass(frozen=True)
class PeerReport:
    """The rows, the libraries with their versions, and those that are missing, with the reason."""

    rows: tuple[PeerRow, ...]
    peers: tuple[Peer, ...]
    missing: tuple[tuple[str, str], ...]

    def lines(self) -> list[str]:
        """Which libraries were measured and how, and which are missing."""
        found = [f"{p.name} {p.version}: {p.note}" for p in self.peers]
        return found + [f"{name}: missing ({reason})" for name, reason in self.missing]

    def content(self) -> dict[str, Any]:
        """The report as plain values."""
        return {
            "libraries": [{"name": p.name, "version": p.version, "note": p.note} for p in self.peers],
            "missing": [{"name": name, "reason": reason} for name, reason in self.missing],
            "figures": [
                {"function": r.function, "preset": r.preset, "library": library, **figure_entry(f)}
                for r in self.rows
                for library, f in [*(("liegen", f) for f in r.ours), *r.theirs]
            ],
        }


def measure_peers(functions: Sequence[AnyFunction], *, samples: int, seed: int) -> PeerReport:
    """Figures of all installed peers, of those operations that are among ``functions``."""
    peers: list[Peer] = []
    missing: list[tuple[str, str]] = []
    for name, load in LOADERS.items():
        try:
            peers.append(load())
        except ImportError as error:
            missing.append((name, str(error)))
    known = {f.name: f for f in functions}
    charts = dict.fromkeys((o.function, o.preset) for p in peers for o in p.operations)
    wanted = sorted((c for c in charts if c[0] in known), key=lambda c: ASKED.index(c[0]))
    rows = [
        row
        for name, preset in wanted
        for row in _rows(known[name].in_chart(preset), preset, peers, samples, seed)
    ]
    return PeerReport(tuple(rows), tuple(peers), tuple(missing))


def _rows(
    function: AnyFunction, preset: str, peers: Sequence[Peer], samples: int, seed: int
) -> list[PeerRow]:
    points, _ = draw_points(function, samples, seed)
    expected, _ = reference_blocks(function, points)
    with workspace([function.kernel]) as place:
        ours = target_figures(function, place, expected, points)
    theirs = [
        (peer.name, figure)
        for peer in peers
        for operation in peer.operations
        if (operation.function, operation.preset) == (function.name, preset)
        for figure in _figures(operation, peer.name, expected, points)
    ]
    return [
        PeerRow(
            function.name,
            preset,
            block.name,
            tuple(f for f in ours if f.block == block.name),
            tuple((name, f) for name, f in theirs if f.block == block.name),
        )
        for block in expected.blocks
    ]


def _figures(operation: Operation, name: str, expected: Expected, points: Sequence[Point]) -> list[Figure]:
    rows = [
        operation.evaluate({n: np.array(v, dtype=np.float64) for n, v in p.sample.values.items()})
        for p in points
    ]
    arrays = {block: np.stack([np.asarray(row[block]).ravel() for row in rows]) for block in rows[0]}
    return figures_of(expected, points, name, [arrays])
