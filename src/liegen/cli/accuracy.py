"""``liegen verify --accuracy``: the table of errors by rotation angle."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import click

from .shared import Convention, bar, chosen, count, table, weighed, weighed_by_name

if TYPE_CHECKING:
    from liegen.accuracy import AccuracyReport, Figure, Undefined
    from liegen.accuracy.peers import PeerReport
    from liegen.sources import AnyFunction

#: Rows of the table for the functions of a group.
FAMILIES = {
    "compose": "products", "inverse": "products", "between": "products", "act": "products",
    "transform_to": "products", "exp": "exp, retract", "retract": "exp, retract", "log": "log, local",
    "local": "log, local", "adjoint": "adjoint, ad", "ad": "adjoint, ad", "Jr": "Jr, Jl", "Jl": "Jr, Jl",
    "Jr_inv": "Jr^-1, Jl^-1", "Jl_inv": "Jr^-1, Jl^-1",
}  # fmt: skip
#: Functions that are named for a point, and figures beyond the bound that are listed.
NAMED, LISTED = 6, 20


def run_accuracy(
    source: str | None,
    names: Sequence[str],
    groups: Sequence[str],
    chart: str | None,
    noise: str | None,
    *,
    samples: int | None,
    seed: int,
    peers: bool,
    as_json: bool,
) -> None:
    """Measure, print, and exit with 1 where a figure is beyond the bound."""
    from functools import partial

    from liegen.accuracy import SAMPLES, accuracy
    from liegen.accuracy.peers import measure_peers

    everything = source is None and not groups and noise is None
    functions = weighed(_chosen(source, names, groups, everything=everything), noise, None, None)
    reload = partial(_reload, source, tuple(groups), noise, everything=everything)
    with bar("accuracy", "measured chart") as told:
        report = accuracy(
            functions, preset=chart, samples=samples or SAMPLES, seed=seed, progress=told, reload=reload
        )
    others = measure_peers(functions, samples=samples or SAMPLES, seed=seed) if peers else None
    if as_json:
        content = report.content() | ({"peers": others.content()} if others else {})
        click.echo(json.dumps(content, indent=1, allow_nan=False))
    else:
        print_report(report)
        if others:
            click.echo()
            print_peers(others)
    if not report.passed:
        raise click.exceptions.Exit(1)


def _chosen(
    source: str | None, names: Sequence[str], groups: Sequence[str], *, everything: bool
) -> tuple[AnyFunction, ...]:
    """As :func:`chosen`; without source and groups the library and all groups."""
    if not everything:
        return chosen(source, names, groups)
    from liegen.sources import select
    from liegen.verify.run import everything as known

    return select(tuple(known().values()), names)


def _reload(
    source: str | None, groups: Sequence[str], noise: str | None, *, everything: bool
) -> dict[str, AnyFunction]:
    if not everything:
        return weighed_by_name(source, groups, Convention(), noise, None, None)
    from liegen.verify.run import everything as known

    return {f.name: f for f in weighed(tuple(known().values()), noise, None, None)}


def print_report(report: AccuracyReport) -> None:
    """The table, figures beyond the bound, points without a value, presets that do not apply, a summary."""
    from liegen.accuracy import BOUND, COLUMNS

    figures: dict[tuple[str, str], list[Figure]] = {}
    for row in report.rows:
        for f in row.measured.figures:
            figures.setdefault((_title(row.function), "value" if f.is_value else "Jacobian"), []).append(f)
    lines = [[name, what, *cells(of)] for (name, what), of in figures.items()]
    table(("worst error, all presets", "", *COLUMNS), lines, right=range(2, 2 + len(COLUMNS)))
    click.echo()
    _print_excesses(report)
    click.echo("Points where no value is defined, and what the code gives there:")
    for line in _points(report.undefined):
        click.echo(f"- {line}")
    for line in _remarks(report):
        click.echo(line)
    every = [f for row in report.rows for f in row.measured.figures]
    worst = [max((f.largest for f in every if f.is_value is v), default=0.0) for v in (True, False)]
    samples = sum(row.measured.samples for row in report.rows)
    names = {row.function for row in report.rows}
    click.echo()
    click.echo(
        f"{count(len(names), 'function')}, {count(len(report.rows), 'different chart')} of them, "
        f"{count(samples, 'sample')} (seed {report.seed}): worst value {worst[0]:.1e}, "
        f"worst Jacobian {worst[1]:.1e}, bound {BOUND:.0e} relative to max(1, s)"
    )
    targets = f"NumPy, and C compiled with {report.compiler}" if report.compiler else "NumPy; no C compiler"
    exceeding = len(report.excesses)
    click.echo(
        f"{targets}; {count(exceeding, 'figure')} beyond the bound"
        if exceeding
        else f"{targets}; none beyond"
    )
    for name in report.unmeasured:
        click.echo(f"{name}: nothing could be compared")


def _title(function: str) -> str:
    """The row of a function: its own, or that of its family in its group."""
    group, _, operation = function.partition("_")
    from liegen.modules import groups

    known = {name.lower(): name for name in groups()}
    return f"{known[group]} {FAMILIES[operation]}" if group in known and operation in FAMILIES else function


def cells(figures: Sequence[Figure]) -> list[str]:
    """The worst figure of each column; a dot where there is none, ! beyond the bound."""
    from liegen.accuracy import BOUND, COLUMNS, largest

    found = [largest(figures, k) for k in range(len(COLUMNS))]
    return ["." if x is None else f"{x:.0e}{'' if x <= BOUND else '!'}" if x else "0" for x in found]


def _print_excesses(report: AccuracyReport) -> None:
    for e in report.excesses[:LISTED]:
        click.echo(
            f"BEYOND: {e.function}, {e.block}, {e.target}, chart {'/'.join(e.presets)}, angle {e.column}, "
            f"{e.kind}: {e.error:.1e}"
        )
    if len(report.excesses) > LISTED:
        click.echo(f"and {len(report.excesses) - LISTED} more (--json lists all)")
    if report.excesses:
        click.echo()


def _points(points: Sequence[Undefined]) -> Iterable[str]:
    """Each point once, with what the code gives for whom."""
    places: dict[tuple[str, str], list[str]] = {}
    for p in points:
        places.setdefault((p.where, p.reason), []).append(f"{p.returns} ({_some(p.functions)})")
    for (where, reason), returns in places.items():
        yield f"{where}: {reason}; the code gives: {'; '.join(returns)}"


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:NAMED])
    return f"{shown} and {len(names) - NAMED} more" if len(names) > NAMED else shown


def _remarks(report: AccuracyReport) -> Iterable[str]:
    from liegen.charts import PRESETS

    reasons: dict[str, list[str]] = {}
    for remark in report.remarks:
        every = len(remark.presets) == len(PRESETS)
        presets = "all presets" if every else ", ".join(remark.presets)
        reasons.setdefault(f"{presets}: {remark.reason}", []).append(remark.function)
    for reason, names in reasons.items():
        yield f"{_some(names)}: {reason}"


def print_peers(peers: PeerReport) -> None:
    """Each operation of each library beside liegen's."""
    from liegen.accuracy import COLUMNS, NO_ANGLE

    columns = NO_ANGLE
    lines: list[list[str]] = []
    for row in peers.rows:
        chart = "" if row.preset == "gtsam" else f" ({row.preset})"
        lines.append([row.function + chart, row.block, "liegen", *cells(row.ours)[:columns]])
        lines += [["", "", name, *cells([figure])[:columns]] for name, figure in row.theirs]
    click.echo(
        "Beside other libraries, each in its own chart and from the same stored numbers (! beyond 1e-14):"
    )
    table(("function (chart)", "block", "library", *COLUMNS[:columns]), lines, right=range(3, 3 + columns))
    click.echo()
    for line in peers.lines():
        click.echo(line)
