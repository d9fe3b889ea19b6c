"""``liegen bench``: kernels against the machine, against peers, instruction counts, growth, a pose graph."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from liegen.errors import OutputError, ToolError

from .ranges import SEED, Whole
from .shared import chosen, count, names_option, new_file, old_file, source_argument, table, tracked

if TYPE_CHECKING:
    from liegen.sources import AnyFunction

#: What is measured where no function is named.
DEFAULT = ("between_se3",)
#: Kinds of measurement, and the options that belong to one of them.
MODES = ("peers", "graph", "instructions", "growth")
OPTIONS = {"chart": "peers", "all_flags": "peers", "compare": "instructions", "write": "instructions"}


@click.command()
@source_argument
@names_option
@click.option("--peers", is_flag=True, help="Beside the same functions of wrenfold, SymForce, Ceres, CasADi.")
@click.option(
    "--graph", metavar="FILE", callback=old_file, help="Linearise and solve a g2o file of SE(3) beside GTSAM."
)
@click.option("--instructions", is_flag=True, help="Count the instructions of each call with valgrind.")
@click.option("--growth", is_flag=True, help="Time code generation: cold starts, chains, wide residuals.")
@click.option(
    "--calls", type=Whole(1, 10_000_000), default=10_000, show_default=True,
    help="Distinct inputs in a round (--peers).",
)  # fmt: skip
@click.option(
    "--rounds", type=Whole(1, 100_000), default=100, show_default=True,
    help="Rounds; every round runs each variant once.",
)  # fmt: skip
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the inputs.")
@click.option(
    "--largest", type=Whole(1, 100_000_000), default=1_000_000, show_default=True,
    help="Largest batch.",
)  # fmt: skip
@click.option(
    "--all-flags", is_flag=True, help="A row for every set of compiler flags, not the best (--peers)."
)
@click.option("--chart", metavar="FILE", callback=new_file, help="Write a bar chart as SVG (--peers).")
@click.option("--compare", metavar="FILE", help="Beside counts that were written before (--instructions).")
@click.option("--write", metavar="FILE", callback=new_file, help="Write the counts as JSON (--instructions).")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.pass_context
def bench(context: click.Context, as_json: bool, **options: Any) -> None:
    """Time the C of factors, value and all Jacobians; everything in one run, in turn.

    Alone: single calls, a chain of dependent calls, and batches of growing size, beside what the machine can
    do at most: multiply-adds, copied bytes. Default: between_se3.

    --peers: the published functions beside what other packages generate for them, checked against a 50-digit
    reference first. Ratios are medians over the rounds, above 1 where liegen is faster.
    """
    _refuse_unused(options)
    for name, mode in (("graph", _graph), ("instructions", _instructions), ("growth", _growth)):
        if options[name]:
            content = mode(as_json, **options)
            break
    else:
        content = (_peers if options["peers"] else _profile)(as_json, **options)
    if as_json:
        click.echo(json.dumps(content, indent=2))
    if content.get("failed"):
        context.exit(1)


def _refuse_unused(options: Mapping[str, Any]) -> None:
    """Raise UsageError for two kinds of measurement at once, and for an option of another kind."""
    modes = [name for name in MODES if options[name]]
    if len(modes) > 1:
        raise click.UsageError(f"--{modes[0]} and --{modes[1]} are two measurements; give one of them")
    for option, mode in OPTIONS.items():
        if options[option] and mode not in modes:
            raise click.UsageError(f"--{option.replace('_', '-')} is a part of --{mode}; give both")


def _functions(
    source: str | None, names: Sequence[str], default: Sequence[AnyFunction]
) -> tuple[AnyFunction, ...]:
    """Those asked for, published ones first by their name; the default where nothing is asked for."""
    from liegen.bench.peers import PUBLISHED

    if source is None and names:
        published = {f.name: f for f in PUBLISHED}
        found = [published[name] for name in names if name in published]
        rest = [name for name in names if name not in published]
        return (*found, *(chosen(None, rest) if rest else ()))
    return chosen(source, names) if source or names else tuple(default)


def _profile(
    as_json: bool, *, source: str | None, names: Sequence[str], rounds: int, seed: int, largest: int, **_: Any
) -> dict[str, Any]:
    from liegen.bench.batch_variants import FACTORS, batch_variants
    from liegen.bench.batches import SIZES, profile
    from liegen.bench.build import compiler_version
    from liegen.bench.report import profile_rows, variant_rows
    from liegen.bench.variant import FLAGS, Task

    functions = _functions(source, names, chosen(None, DEFAULT))
    sizes = [n for n in SIZES if n <= largest]
    flags = " ".join(FLAGS["plain"])
    found = [profile(Task(f), sizes=sizes, rounds=rounds, seed=seed) for f in functions]
    variants = [batch_variants(Task(f), rounds=rounds, seed=seed) for f in functions]
    if not as_json:
        for p, timed in zip(found, variants, strict=True):
            click.echo(f"{p.function}: {p.operations} operations, {p.bytes} bytes in and out")
            table(("", "n", "ns a factor", "of arithmetic", "of copying"), profile_rows(p), right=range(1, 5))
            for n in p.left_out:
                click.echo(f"n = {n}: left out, its arrays need {n * p.bytes / 2**30:.1f} GiB")
            c = p.ceilings
            click.echo(
                f"ceilings: {c.scalar:.1f} multiply-adds a ns, {c.vector:.1f} of {c.width} numbers at once; "
                "shares are ceiling over measured time\n"
            )
            titles = (f"batches of {FACTORS}", "operations", "min ns a factor", "median ns")
            table(titles, variant_rows(timed), right=range(1, 4))
            click.echo()
        click.echo(f"{compiler_version()}, {flags}, one thread")
    profiles = [
        asdict(p) | {"variants": [asdict(t) for t in timed]} for p, timed in zip(found, variants, strict=True)
    ]
    return {"compiler": compiler_version(), "flags": flags, "profiles": profiles}


def _peers(
    as_json: bool,
    *,
    source: str | None,
    names: Sequence[str],
    calls: int,
    rounds: int,
    seed: int,
    all_flags: bool,
    chart: str | None,
    **_: Any,
) -> dict[str, Any]:
    from liegen.bench import report
    from liegen.bench.build import compiler_version
    from liegen.bench.chart import svg
    from liegen.bench.peers import PEERS, PUBLISHED, tasks
    from liegen.bench.python_batches import compare_batches
    from liegen.bench.race import Plan, race
    from liegen.bench.variant import FLAGS

    plan = Plan(calls=calls, rounds=rounds, seed=seed)
    todo = tasks(_functions(source, names, PUBLISHED))
    results = [race(task, PEERS, plan) for task in tracked(todo, "race", lambda t: t.name)]
    batches, missing = compare_batches(rounds=rounds, seed=seed)
    if chart:
        _write(chart, svg(results))
    wrong = [f"{r.function}, {e.variant.label}" for r in results for e in report.wrong_ones(r)]
    if not as_json:
        rows = [row for r in results for row in report.rows(r, every=all_flags)]
        table(report.TITLES, rows, right=range(3, len(report.TITLES)))
        click.echo()
        for result in results:
            click.echo(report.verdict(result))
        click.echo("\nFrom Python, between_se3 with both Jacobians, wall clock:")
        table(report.BATCH_TITLES, report.batch_rows(batches, missing), right=range(2, 6))
        flags = "; ".join(f"{name}: {' '.join(FLAGS[name])}" for name in plan.flags)
        click.echo(
            f"\n{compiler_version()}; {flags}\n{calls} distinct inputs, {rounds} rounds in turn; "
            "processor time; ratio: median of the time over liegen's with plain flags; small: near a solution"
        )
    content = report.as_json(results, plan, compiler_version())
    named = {"batches": [asdict(b) for b in batches], "missing": [asdict(m) for m in missing]}
    return {**content, "python": named, "failed": wrong}


def _graph(as_json: bool, *, graph: str, rounds: int, **_: Any) -> dict[str, Any]:
    from liegen.bench.pose_graph import compare_graph
    from liegen.bench.report import graph_rows, solve_rows
    from liegen.bench.variant import AbsentError

    try:
        found = compare_graph(Path(graph), rounds=rounds)
    except AbsentError as reason:
        raise ToolError(f"there is nothing to compare with: {reason}") from None
    if not as_json:
        click.echo(
            f"{Path(graph).name}: {found.edges} edges, {found.poses} poses; GTSAM {found.gtsam} "
            f"({count(found.threads, 'thread')}); largest difference {found.difference:.0e}\n"
        )
        table(
            ("whitened, all edges, medians", "ns an edge, cold", "faster", "warm", "faster"),
            graph_rows(found),
            right=range(1, 5),
        )
        click.echo()
        table(
            ("solve", "s", "in linear systems", "iterations", "error"), solve_rows(found), right=(1, 2, 3, 4)
        )
    return {**asdict(found), "failed": not found.agrees}


def _instructions(
    as_json: bool,
    *,
    source: str | None,
    names: Sequence[str],
    compare: str | None,
    write: str | None,
    **_: Any,
) -> dict[str, Any]:
    from liegen.bench.callgrind import instructions, read
    from liegen.bench.report import instruction_rows

    before = read(Path(compare)) if compare else None
    found = instructions(chosen(source, names))
    if write:
        _write(write, found.text())
    if not as_json:
        titles = ("factor", "value", "before", "with Jacobians", "before")
        table(titles, instruction_rows(found, before), right=range(1, 5))
        click.echo(f"\ninstructions of a call; {found.compiler}, {found.libc}, {' '.join(found.flags)}")
        if before and before.compiler != found.compiler:
            click.echo(f"before: {before.compiler}: another compiler, whose counts differ anyway")
    return asdict(found)


def _write(path: str, text: str) -> None:
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror}") from error


def _growth(as_json: bool, *, rounds: int, **_: Any) -> dict[str, Any]:
    from liegen.bench.growth import OUTPUTS, POSES, chain, cold_starts, growth, wide
    from liegen.bench.report import growth_rows

    found = (growth("composed poses", chain, POSES), growth("outputs", wide, OUTPUTS))
    cold = cold_starts(min(rounds, 5))
    if not as_json:
        for g in found:
            table((g.what, "operations", "seconds"), growth_rows(g), right=range(3))
            click.echo(
                f"over the larger half: seconds ~ size^{g.by_size:.2f} ~ operations^{g.by_operations:.2f}\n"
            )
        rows = [(c.what, "missing" if c.seconds is None else f"{c.seconds:.2f}") for c in cold]
        table(("a new process", "processor s"), rows, right=(1,))
    return {"growth": [asdict(g) for g in found], "cold": [asdict(c) for c in cold]}
