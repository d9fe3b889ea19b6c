"""One function, all variants: generate, compile, check that they agree, time them in turn."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from liegen.temporary import working_folder

from . import draws
from .agreement import Errors, errors
from .build import Array, Loaded, load
from .timing import in_turn, median_ratio
from .variant import FLAGS, AbsentError, Maker, Missing, Task, Variant

#: Variants whose results differ more from the reference, relative to max(1, largest entry), are not timed.
AGREEMENT = 1e-9
#: Rounds after which the fastest variant of a peer is chosen for further flags.
TRIAL = 10


@dataclass(frozen=True)
class Plan:
    """How long and on what: distinct inputs in a round, rounds, their seed, flags, reference samples."""

    calls: int = 10_000
    rounds: int = 100
    seed: int = 0
    flags: tuple[str, ...] = tuple(FLAGS)
    references: int = 6
    workers: int = 2


@dataclass(frozen=True)
class Time:
    """Nanoseconds a call on one set of inputs.

    ``ratio`` is the median over the rounds of this variant's time by that of the first in the same round.
    """

    minimum_ns: float
    median_ns: float
    ratio: float


@dataclass(frozen=True)
class Entry:
    """A variant with certain flags: its times and errors by set of inputs; no times where it is wrong."""

    variant: Variant
    flags: str
    times: Mapping[str, Time]
    errors: Mapping[str, float]

    @property
    def agrees(self) -> bool:
        """Whether it was timed."""
        return bool(self.times)

    @property
    def operations(self) -> int | None:
        """All of them, calls included."""
        kinds = self.variant.operations
        return None if kinds is None else sum(kinds.values())


@dataclass(frozen=True)
class Result:
    """The entries of a function, the first of them the base of the ratios, and the peers that are missing."""

    function: str
    entries: tuple[Entry, ...]
    missing: tuple[Missing, ...]

    @property
    def best(self) -> tuple[Entry, ...]:
        """Every variant once, with the flags that make it fastest on random inputs; wrong ones too."""
        found: dict[str, Entry] = {}
        for entry in self.entries:
            known = found.get(entry.variant.label)
            if known is None or _median(entry) < _median(known):
                found[entry.variant.label] = entry
        return tuple(found.values())


def _median(entry: Entry) -> float:
    return entry.times[draws.RANDOM].median_ns if entry.agrees else float("inf")


def race(task: Task, makers: Mapping[str, Maker], plan: Plan) -> Result:
    """Time the variants of a task in turn; the first maker's first variant is the base.

    All are timed with the first flags, and of every peer the fastest of its own with the other flags too. A
    peer that is not installed, or whose code does not compile, is missing, with the reason.
    """
    made, missing = generated(task, makers)
    drawn = {kind: draws.samples(task.function, kind, plan.calls, plan.seed) for kind in draws.SETS}
    inputs = {kind: draws.rows(samples) for kind, samples in drawn.items()}
    references = {kind: Errors.of(task, samples[: plan.references]) for kind, samples in drawn.items()}
    first, *others = plan.flags
    with working_folder("liegen-bench-") as folder:
        loaded, refused = _loaded(task, [(first, v) for v in made], plan, Path(folder, first))
        if others:
            best = _fastest(loaded, inputs[draws.RANDOM], plan)
            again = [(flags, v) for v in made if v in best for flags in others]
            more, also = _loaded(task, again, plan, Path(folder, "more"))
            loaded, refused = [*loaded, *more], [*refused, *also]
        loaded.sort(key=lambda pair: made.index(pair[1].variant))
        entries = _entries(loaded, inputs, references, plan)
    return Result(task.name, entries, (*missing, *refused))


def _fastest(loaded: Sequence[tuple[str, Loaded]], inputs: Array, plan: Plan) -> list[Variant]:
    """The fastest of every peer's own variants, in a few rounds."""
    times = _times([one for _, one in loaded], inputs, replace(plan, rounds=min(plan.rounds, TRIAL)))
    found: dict[str, tuple[float, Variant]] = {}
    for (_, one), t in zip(loaded, times, strict=True):
        if one.variant.borrowed:
            continue
        key = one.variant.peer if one.variant.rows == 1 else one.variant.label
        if key not in found or t.minimum_ns < found[key][0]:
            found[key] = t.minimum_ns, one.variant
    return [variant for _, variant in found.values()]


def _entries(
    loaded: Sequence[tuple[str, Loaded]],
    inputs: Mapping[str, Array],
    references: Mapping[str, Errors],
    plan: Plan,
) -> tuple[Entry, ...]:
    """Errors of all, and times of those that agree with the reference."""
    found = [{kind: errors(one, references[kind]) for kind in draws.SETS} for _, one in loaded]
    sound = [k for k, error in enumerate(found) if error[draws.RANDOM] <= AGREEMENT]
    times = {kind: _times([loaded[k][1] for k in sound], inputs[kind], plan) for kind in draws.SETS}
    return tuple(
        Entry(
            one.variant,
            flags,
            {kind: times[kind][sound.index(k)] for kind in draws.SETS} if k in sound else {},
            found[k],
        )
        for k, (flags, one) in enumerate(loaded)
    )


def generated(task: Task, makers: Mapping[str, Maker]) -> tuple[list[Variant], list[Missing]]:
    """The variants of all peers that are there."""
    made: list[Variant] = []
    missing: list[Missing] = []
    for peer, maker in makers.items():
        try:
            variants = maker(task)
        except AbsentError as reason:
            missing.append(Missing(peer, str(reason)))
        else:
            made += variants
            if not variants:
                missing.append(Missing(peer, "has no formula of this function"))
    return made, missing


def _loaded(
    task: Task, wanted: Sequence[tuple[str, Variant]], plan: Plan, folder: Path
) -> tuple[list[tuple[str, Loaded]], list[Missing]]:
    def attempt(job: tuple[int, tuple[str, Variant]]) -> Loaded | Missing:
        number, (flags, variant) = job
        try:
            return load(task, variant, FLAGS[flags], folder / str(number))
        except AbsentError as reason:
            return Missing(variant.label, str(reason))

    with ThreadPoolExecutor(plan.workers) as pool:
        done = list(pool.map(attempt, enumerate(wanted)))
    loaded = [(flags, one) for (flags, _), one in zip(wanted, done, strict=True) if isinstance(one, Loaded)]
    refused = {one.peer: one for one in done if isinstance(one, Missing)}
    return loaded, list(refused.values())


def _times(loaded: Sequence[Loaded], inputs: Array, plan: Plan) -> list[Time]:
    shared = max((one.buffer() for one in loaded), key=lambda buffer: buffer.size)
    runs: list[Callable[[], None]] = [one.run(inputs, shared) for one in loaded]
    measured = in_turn(runs, len(inputs), plan.rounds)
    return [
        Time(
            min(ns),
            statistics.median(ns),
            median_ratio(ns, measured[0]),
        )
        for ns in measured
    ]
