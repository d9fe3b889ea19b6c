"""liegen's kernels alone: one call a factor, a chain of calls, batches of every size, against the machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from liegen.program import Program
from liegen.program.program import FREE
from liegen.temporary import working_folder

from . import draws, ours
from .build import Array, Loaded, load
from .ceilings import Ceilings, Machine, load_loops, whole
from .timing import in_turn
from .variant import FLAGS, Task, Variant, offsets

SIZES = (1, 10, 100, 1_000, 10_000, 100_000, 1_000_000)
#: Sizes whose arrays would take more than this are left out [bytes].
ROOM = 2**30
#: A measurement repeats its call until about so many factors are done.
FACTORS = 20_000
#: Distinct inputs.
DRAWN = 1000
LAYOUTS = ("aos", "soa")


@dataclass(frozen=True)
class Size:
    """A batch of ``n``: ns a factor by layout, and the ratios of the ceilings to the best of them.

    ``arithmetic``: time that the same number of vector multiply-adds takes, over the measured time;
    ``memory``: time of a copy that moves the same bytes, over the measured time.
    """

    n: int
    ns: dict[str, float]
    arithmetic: float
    memory: float


@dataclass(frozen=True)
class Profile:
    """A kernel on this machine. ``scalar`` and ``chain`` are ns a call: independent calls, dependent ones."""

    function: str
    operations: int
    bytes: int
    ceilings: Ceilings
    scalar: float
    scalar_arithmetic: float
    chain: float
    sizes: tuple[Size, ...]
    left_out: tuple[int, ...]


def profile(task: Task, *, sizes: Sequence[int], rounds: int, seed: int, flags: str = "plain") -> Profile:
    """Measure one function: single calls, the chain, and batches, each beside its ceilings in turn."""
    program = task.kernel.jacobians
    moved = 8 * sum(port.size for port in (*task.inputs, *task.outputs))
    inputs = draws.rows(draws.samples(task.function, draws.RANDOM, DRAWN, seed))
    kept = tuple(n for n in sizes if n * moved <= ROOM)
    with working_folder("liegen-bench-") as folder:
        machine = load_loops(folder)
        ceilings = machine.arithmetic(rounds)
        (single,) = ours.variants(task)
        calls = [load(task, v, FLAGS[flags], folder / v.note) for v in (single, chained(task, single))]
        times = in_turn([c.run(inputs, c.buffer()) for c in calls], len(inputs), rounds)
        loaded = {
            layout: load(task, batched(task, layout), FLAGS[flags], folder / layout) for layout in LAYOUTS
        }
        found = tuple(_size(n, loaded, machine, ceilings, inputs, rounds) for n in kept)
    scalar, chain = map(min, times)
    return Profile(
        task.name, program.operations, moved, ceilings, scalar,
        program.operations / ceilings.scalar / scalar, chain, found, tuple(n for n in sizes if n not in kept),
    )  # fmt: skip


def _size(
    n: int, loaded: Mapping[str, Loaded], machine: Machine, ceilings: Ceilings, inputs: Array, rounds: int
) -> Size:
    task = loaded["aos"].task
    source = np.resize(inputs, (n, inputs.shape[1]))
    outputs = sum(port.size for port in task.outputs)
    target, half = np.ones(n * outputs), np.ones(n * (inputs.shape[1] + outputs) // 2 + 1)
    room = np.ones_like(half)
    repeats = max(1, FACTORS // n)
    packed = {layout: arranged(task, source, layout) for layout in LAYOUTS}
    runs = [whole(one.library["drive"], repeats, n, packed[layout], target) for layout, one in loaded.items()]
    runs.append(machine.copy(repeats, half.nbytes, half, room))
    timed = in_turn(runs, n * repeats, rounds if n <= FACTORS else max(3, rounds // 20))
    *layouts, copy = map(min, timed)
    operations = task.kernel.jacobians.operations
    best = min(layouts)
    ideal = operations / (ceilings.vector * ceilings.width)
    return Size(n, dict(zip(loaded, layouts, strict=True)), ideal / best, copy / best)


def arranged(task: Task, rows: Array, layout: str) -> Array:
    """Rows of all arguments as one array after the other: of structures, or structures of arrays."""
    parts = [rows[:, k : k + port.size] for port, k in zip(task.inputs, offsets(task.inputs), strict=True)]
    return np.concatenate([(part if layout == "aos" else part.T).ravel() for part in parts])


def batched(task: Task, layout: str) -> Variant:
    """A batch of n whose arrays lie as :func:`arranged` puts them, the outputs likewise."""
    (packed,) = ours.batches(task)
    lines: list[str] = []
    for array, kind, ports in (("a", "in", task.inputs), ("b", "out", task.outputs)):
        for k, (port, start) in enumerate(zip(ports, offsets(ports), strict=True)):
            stride = f"{port.size}, 1" if layout == "aos" else "1, n"
            index = ", NULL" if kind == "in" else ""
            name = f"{'x' if kind == 'in' else 'y'}{k}"
            lines.append(f"{ours.PACKAGE}_{kind} {name} = {{{array} + {start} * n, {stride}{index}}};")
    call = packed.call[-1].replace("(m,", "(n,")
    return replace(packed, note=layout, call=(*lines, call), driver="bench/whole_driver.c.j2")


def chained(task: Task, single: Variant) -> Variant:
    """Calls of which each needs the deepest result of the one before."""
    tie = f"tie = zero * b[{deepest(task.kernel.jacobians)}];"
    return replace(single, note="chain", call=(*single.call, tie), driver="bench/chain_driver.c.j2")


def deepest(program: Program) -> int:
    """Which number of all outputs has the most instructions one after the other before it."""
    depth: list[int] = []
    for ins in program.code:
        depth.append(max((depth[a] for a in ins.args), default=0) + (ins.op not in FREE))
    flat = [i for indices in program.results for i in indices]
    return max(range(len(flat)), key=lambda k: depth[flat[k]])
