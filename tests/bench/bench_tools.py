"""Short plans, and results made by hand."""

import pytest

from liegen.bench.race import Entry, Plan, Result, Time
from liegen.bench.variant import AbsentError, Missing, Task, Variant

QUICK = Plan(calls=40, rounds=2, seed=3, flags=("plain",), references=2)


def made(maker, task: Task):
    """The variants of a peer; skips where it is not installed."""
    try:
        return maker(task)
    except AbsentError as reason:
        pytest.skip(str(reason))


def variant(peer, note="", operations=None, **more) -> Variant:
    return Variant(peer, "1.0", note, "", (), {}, operations, 0.01, **more)


def entry(peer, ratio, note="", small=None, operations=None, flags="plain", error=1e-15, **more) -> Entry:
    times = {
        "random": Time(50 * ratio, 52 * ratio, ratio),
        "small": Time(50 * ratio, 52 * ratio, small or ratio),
    }
    kinds = {"mul": operations} if operations else None
    return Entry(variant(peer, note, kinds, **more), flags, times, {"random": error, "small": error})


def wrong(peer) -> Entry:
    return Entry(variant(peer), "plain", {}, {"random": 0.5, "small": float("inf")})


def result(*entries: Entry, missing=()) -> Result:
    return Result("turn", entries, tuple(Missing(*m) for m in missing))
