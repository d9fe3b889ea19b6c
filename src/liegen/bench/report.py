"""What a comparison says, as rows of a table and as JSON. Losses are called losses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from . import ours
from .batch_variants import Timed
from .batches import Profile
from .callgrind import Instructions
from .draws import RANDOM, SETS, SMALL
from .growth import Growth
from .pose_graph import GraphReport
from .python_batches import BatchRow
from .race import Entry, Plan, Result
from .variant import FLAGS, Missing

TITLES = (
    "function", "variant", "flags", "min ns", "median ns", "ratio", "small", "operations", "calls",
    "generated s", "error",
)  # fmt: skip
#: Kinds that are calls of the mathematics library, by any generator's name; the rest are instructions.
CALLS = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "pow", "call")
#: A variant is faster where its median ratio is below 1 by more than this: less is noise.
NOISE = 0.03


def calls(kinds: Mapping[str, int]) -> int:
    """Calls of the mathematics library among the operations."""
    return sum(n for kind, n in kinds.items() if kind in CALLS)


def rows(result: Result, *, every: bool) -> list[tuple[str, ...]]:
    """A row a variant with its best flags, or one for every flag; then one for every peer that is missing."""
    entries = result.entries if every else result.best
    table = [_row(result.function, entry) for entry in entries]
    blanks = ("",) * (len(TITLES) - 3)
    return table + [(result.function, m.peer, f"missing: {m.reason}", *blanks) for m in result.missing]


def _row(function: str, entry: Entry) -> tuple[str, ...]:
    kinds, seconds = entry.variant.operations, entry.variant.seconds
    if not entry.agrees:
        times = ("wrong", "", "", "")
    else:
        random, small = entry.times[RANDOM], entry.times[SMALL]
        times = (
            f"{random.minimum_ns:.1f}", f"{random.median_ns:.1f}",
            f"{random.ratio:.2f}", f"{small.ratio:.2f}",
        )  # fmt: skip
    return (
        function, entry.variant.label, entry.flags, *times,
        "" if kinds is None else str(sum(kinds.values()) - calls(kinds)),
        "" if kinds is None else str(calls(kinds)),
        "" if seconds is None else f"{seconds:.3f}",
        f"{max(entry.errors.values()):.0e}",
    )  # fmt: skip


def peers_of(result: Result) -> list[Entry]:
    """The best entries of peers' own formulations that are right."""
    return [e for e in result.best if e.agrees and e.variant.peer != ours.NAME and not e.variant.borrowed]


def wrong_ones(result: Result) -> list[Entry]:
    """Entries of liegen itself that disagree with the reference."""
    return [e for e in result.entries if not e.agrees and e.variant.peer == ours.NAME]


def verdict(result: Result) -> str:
    """One line: the fastest peer against liegen with the flags that are best for it."""
    own = [e for e in result.best if e.variant.label == ours.NAME and e.agrees]
    peers = peers_of(result)
    if not own or not peers:
        return f"{result.function}: no peer to compare with"
    fastest = min(peers, key=lambda e: e.times[RANDOM].median_ns)
    ratios = {kind: fastest.times[kind].ratio / own[0].times[kind].ratio for kind in SETS}
    lowest = min(ratios.values())
    word = "faster" if lowest > 1 + NOISE else "LOSS" if lowest < 1 - NOISE else "even"
    counted = [e for e in peers if e.operations is not None]
    fewest = min(counted, key=lambda e: e.operations or 0, default=None)
    ours_count = own[0].operations or 0
    share = (
        f", {ours_count / (fewest.operations or 1):.2f} of the operations of {fewest.variant.peer}"
        if fewest
        else ""
    )
    text = ", ".join(f"{ratio:.2f} ({kind})" for kind, ratio in ratios.items())
    borrowed = [
        e.variant.label
        for e in result.best
        if e.agrees and e.variant.borrowed
        and e.times[RANDOM].ratio < own[0].times[RANDOM].ratio * (1 - NOISE)
    ]  # fmt: skip
    lost = f"; LOSS of code generation to {', '.join(borrowed)}" if borrowed else ""
    return f"{result.function}: {word}: {fastest.variant.label} takes {text} times as long{share}{lost}"


def as_json(results: Sequence[Result], plan: Plan, compiler: str) -> dict[str, Any]:
    """Everything that was measured."""
    return {
        "compiler": compiler,
        "flags": {name: " ".join(FLAGS[name]) for name in plan.flags},
        "plan": asdict(plan),
        "functions": {
            r.function: {
                "entries": [_entry(e) for e in r.entries],
                "missing": [asdict(m) for m in r.missing],
                "verdict": verdict(r),
            }
            for r in results
        },
    }


def _entry(entry: Entry) -> dict[str, Any]:
    return {
        "peer": entry.variant.peer,
        "version": entry.variant.version,
        "formulation": entry.variant.note,
        "flags": entry.flags,
        "agrees": entry.agrees,
        "times": {kind: asdict(t) for kind, t in entry.times.items()},
        "operations": entry.variant.operations,
        "seconds": entry.variant.seconds,
        "errors": {kind: e if e < float("inf") else None for kind, e in entry.errors.items()},
    }


def profile_rows(profile: Profile) -> list[tuple[str, ...]]:
    """Single calls, the chain, then batches: ns a factor, shares of the ceilings."""
    found = [
        ("single calls", "1", f"{profile.scalar:.1f}", f"{profile.scalar_arithmetic:.2f}", ""),
        ("chain, each call needs the last", "1", f"{profile.chain:.1f}", "", ""),
    ]
    for size in profile.sizes:
        shares = (f"{size.arithmetic:.2f}", f"{size.memory:.2f}")
        best = min(size.ns.values())
        found += [
            (
                f"batch, {LAYOUT_NAMES[layout]}",
                str(size.n),
                f"{ns:.1f}",
                *(shares if ns == best else ("", "")),
            )
            for layout, ns in size.ns.items()
        ]
    return found


def variant_rows(found: Sequence[Timed]) -> list[tuple[str, ...]]:
    """A row a variant of a batch."""
    return [(t.what, str(t.operations), f"{t.minimum:.1f}", f"{t.median:.1f}") for t in found]


LAYOUT_NAMES = {"aos": "array of structures", "soa": "structure of arrays"}
BATCH_TITLES = ("n", "variant", "min ns", "median ns", "ratio", "difference")


def batch_rows(found: Sequence[BatchRow], missing: Sequence[Missing]) -> list[tuple[str, ...]]:
    """A row a size and variant."""
    rows = [
        (
            str(b.n), b.what, f"{b.minimum_ns:.1f}", f"{b.median_ns:.1f}",
            f"{b.ratio:.2f}", f"{b.difference:.0e}",
        )
        for b in found
    ]  # fmt: skip
    return [*rows, *(("", m.peer, f"missing: {m.reason}", "", "", "") for m in missing)]


def graph_rows(found: GraphReport) -> list[tuple[str, ...]]:
    """Ways to linearise."""
    return [
        (r.what, f"{r.cold_ns:.0f}", f"{r.cold_faster:.1f}", f"{r.warm_ns:.0f}", f"{r.warm_faster:.1f}")
        for r in found.rows
    ]


def solve_rows(found: GraphReport) -> list[tuple[str, ...]]:
    """Whole solves."""
    return [
        (
            s.what, f"{s.seconds:.2f}", "" if s.systems is None else f"{s.systems:.2f}",
            str(s.iterations), f"{s.error:.4f}",
        )
        for s in found.solves
    ]  # fmt: skip


def growth_rows(found: Growth) -> list[tuple[str, ...]]:
    """A row a size."""
    return [(str(p.size), str(p.operations), f"{p.seconds:.3f}") for p in found.points]


def instruction_rows(found: Instructions, before: Instructions | None) -> list[tuple[str, ...]]:
    """A row a kernel; the counts before beside those that changed."""

    def pair(name: str, kind: str) -> tuple[str, str]:
        now = found.counts[name].get(kind)
        then = before.counts.get(name, {}).get(kind) if before else None
        return "" if now is None else str(now), "" if then in (None, now) else str(then)

    return [(name, *pair(name, "value"), *pair(name, "jacobians")) for name in found.counts]
