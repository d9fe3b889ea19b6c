"""``liegen verify``: run the verification suite."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import click

from .accuracy import run_accuracy
from .ranges import COUNT, SEED
from .shared import (
    Convention,
    bar,
    chosen,
    convention_options,
    count,
    groups_option,
    names_option,
    noise_options,
    say,
    say_left,
    source_argument,
    table,
    weighed,
    weighed_by_name,
)

if TYPE_CHECKING:
    from liegen.verify import Check, FactorReport, Report

#: Checks whose worst figure has a column: relative errors, and the slope of the remainder (2 is right).
MEASURED = {
    "value": "value",
    "Jacobian": "Jacobian",
    "gradient": "gradient",
    "differences": "differences",
    "Taylor": "slope",
}
#: Those of checks that not every run has.
ASKED = {"Gauss-Newton": "J^T J"}
#: How the checks of functions on floats begin, a line for all factors.
SINGLE = "single"
#: The note of a factor without a stated domain, not worth a line.
EVERYWHERE = "everywhere"
#: The check whose samples are its own.
SOLVED = "singular points"
#: Skipped cases that are named for a factor.
LISTED = 6


@click.command()
@source_argument
@names_option
@groups_option
@noise_options
@click.option("--samples", type=COUNT, help="Samples a factor; every special case by default.")
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the samples.")
@convention_options
@click.option("--accuracy", is_flag=True, help="The worst errors by rotation angle, in every chart; without"
    " SOURCE and --group of the library and all groups. --samples are those of an angle.")  # fmt: skip
@click.option("--peers", is_flag=True, help="With --accuracy: the same of GTSAM, SymForce, jaxlie and Sophus,"
    " where they are installed.")  # fmt: skip
@click.option("--gauss-newton", is_flag=True, help="Also the Gauss-Newton terms of factors.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def verify(
    source: str | None,
    names: tuple[str, ...],
    groups: tuple[str, ...],
    chart: str | None,
    layout: str | None,
    normalise: bool,
    noise: str | None,
    loss: str | None,
    mode: str | None,
    samples: int | None,
    seed: int,
    accuracy: bool,
    peers: bool,
    gauss_newton: bool,
    as_json: bool,
) -> None:
    """Check NumPy and C of SOURCE against an independent reference and against differences."""
    if peers and not accuracy:
        raise click.UsageError("--peers is a part of --accuracy; give both")
    if accuracy:
        if loss or mode:
            raise click.UsageError("--accuracy is of factors without a loss")
        run_accuracy(
            source, names, groups, chart, noise, samples=samples, seed=seed, peers=peers, as_json=as_json
        )
        return
    from liegen.verify import verify as run
    from liegen.verify.run import SAMPLES

    convention = Convention(chart, layout, normalise)
    functions = weighed(chosen(source, names, groups, convention), noise, loss, mode)
    say_left(functions, [noise, loss, mode, gauss_newton])
    started = time.monotonic()
    with bar("verify", "verified") as told:
        report = run(
            functions,
            samples=samples or SAMPLES,
            seed=seed,
            progress=(lambda f, done, total: told(f.factor, done, total)) if told else None,
            reload=partial(weighed_by_name, source, groups, convention, noise, loss, mode),
            gauss_newton=gauss_newton,
        )
    if as_json:
        click.echo(report.to_json(), nl=False)
    else:
        _print(report, time.monotonic() - started)
    if not report.passed:
        raise click.exceptions.Exit(1)


def _print(report: Report, seconds: float) -> None:
    done = {check.name for f in report.factors for check in f.checks}
    columns = MEASURED | {name: title for name, title in ASKED.items() if name in done}
    table(
        ("factor", "checks", *columns.values(), "samples", "skipped"),
        [_row(f, columns) for f in report.factors],
        right=range(2, 4 + len(columns)),
    )
    for factor in report.factors:
        for line in _remarks(factor):
            say(line)
    for line in _skipped(report.factors, report.samples):
        say(line)
    _print_single(report.factors)
    _print_off_unit(report.factors)
    click.echo()
    failed = [f.factor for f in report.factors if not f.passed]
    total, which = count(len(report.factors), "factor"), f": {', '.join(failed)}" if failed else ""
    settings = f"{count(report.samples, 'sample')} each, seed {report.seed}, {seconds:.0f} s"
    click.echo(f"{total}, {len(failed)} failed{which} ({settings})")
    if report.compiler:
        click.echo(f"C was compiled with {report.compiler}")
    else:
        click.echo("C was not checked: there is no C compiler (install gcc or clang, or set CC)")


def _print_single(factors: Iterable[FactorReport]) -> None:
    """The worst of the functions in single precision."""
    found = [
        (c.worst, f.factor, c) for f in factors for c in f.checks if c.name.startswith(SINGLE) and c.checked
    ]
    if found:
        worst, name, check = max(found, key=lambda entry: entry[0])
        click.echo(f"Single precision: the largest error is {worst:.2f} {check.unit} ({name})")


def _print_off_unit(factors: Iterable[FactorReport]) -> None:
    """What arguments off unit length do, as the code is and with --normalise."""
    measured = [f for f in factors if f.off_unit]
    if not measured:
        return
    click.echo("\nLargest error, relative to max(1, s), for quaternions and the like off unit length:")
    offs = [f"off by {o.off:g}" for o in measured[0].off_unit]
    table(
        ("factor", *(title for off in offs for title in (off, "normalised"))),
        [(f.factor, *(f"{x:.1e}" for o in f.off_unit for x in (o.as_is, o.normalised))) for f in measured],
        right=range(1, 1 + 2 * len(offs)),
    )


def _row(factor: FactorReport, columns: Iterable[str]) -> tuple[str, ...]:
    done = {c.name: c for c in factor.checks if c.checked}
    good = sum(c.passed for c in done.values())
    verdict = f"{good} passed" if good == len(done) else f"{len(done) - good} of {len(done)} FAILED"
    figures = [_figure(done[name]) if name in done else "" for name in columns]
    kept = max((c.kept for c in done.values()), default=0)
    skipped = max((len(c.skipped) for c in done.values()), default=0)
    return factor.factor, verdict, *figures, str(kept), str(skipped)


def _figure(check: Check) -> str:
    if check.name != "Taylor":
        return f"{check.worst:.1e}"
    return "linear" if check.worst == float("inf") else f"{check.worst:.2f}"


def _remarks(factor: FactorReport) -> Iterable[str]:
    """What failed and where, and the notes of the rest."""
    for check in factor.checks:
        if not check.passed and not check.unit:
            yield f"\n{factor.factor}: {check.name} failed: {check.note}"
        elif not check.passed:
            note = f" ({check.note})" if check.note else ""
            yield (
                f"\n{factor.factor}: {check.name} failed: {check.worst:.3g} {check.unit} where "
                f"{check.bound:.3g} is allowed, at: {check.where or 'no sample'}{note}"
            )
        elif check.name == "differences" and not check.checked:
            yield f"{factor.factor}: differences, Taylor: {check.note}"
        elif check.note not in ("", EVERYWHERE) and check.checked:
            yield f"{factor.factor}: {check.name}: {check.note}"


def _skipped(factors: Iterable[FactorReport], samples: int) -> Iterable[str]:
    """The samples that were left out, once for all factors with the same."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for factor in factors:
        groups.setdefault(tuple(_left_out(factor.checks, samples)), []).append(factor.factor)
    for said, names in groups.items():
        if said:
            yield f"{', '.join(names)}: left out: {'; '.join(said)}"


def _left_out(checks: Iterable[Check], samples: int) -> Iterable[str]:
    """``12 of 128 in Taylor (why): identity, coincident``, one reason in the same checks together."""
    checked: dict[tuple[str, str], list[str]] = {}
    counts: Counter[tuple[str, str]] = Counter()
    for check in checks:
        for entry, times in Counter(check.skipped).items():
            case, _, reason = entry.partition(": ")
            checked.setdefault((reason, case), []).append(check.name)
            counts[reason, case] = max(counts[reason, case], times)
    cases: dict[tuple[str, str], list[str]] = {}
    for (reason, case), names in checked.items():
        cases.setdefault((reason, ", ".join(names)), []).append(case)
    for (reason, names), where in cases.items():
        total = sum(counts[reason, case] for case in where)
        of = "" if names == SOLVED else f" of {samples}"
        shown = ", ".join(where[:LISTED]) + (", ..." if len(where) > LISTED else "")
        yield f"{total}{of} in {names} ({reason}): {shown}"
