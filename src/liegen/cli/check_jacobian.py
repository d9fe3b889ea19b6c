"""``liegen check-jacobian``: hold somebody's Jacobians against a formula."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from .ranges import COUNT, SEED, TOLERANCE
from .shared import Convention, chosen, convention_options, count, say, source_argument, table

if TYPE_CHECKING:
    from liegen.foreign import Comparison
    from liegen.sources import AnyFunction


@click.command("check-jacobian")
@click.argument("name")
@source_argument
@click.option(
    "--against", "place", required=True, metavar="PLACE:FUNCTION",
    help="FILE.py:FUNCTION or MODULE:FUNCTION with f(x, y, ...) -> (res, J_x, J_y, ...); the same with a"
    " factor of GTSAM, or gtsam:CLASS; LIBRARY.so:FUNCTION with the signature of the generated C.",
)  # fmt: skip
@click.option(
    "--given", multiple=True, metavar="ARGUMENT=NAME",
    help="Where a factor of GTSAM does not tell an argument of NAME: the object in the same file.",
)  # fmt: skip
@convention_options
@click.option("--samples", type=COUNT, default=24, show_default=True, help="Random samples.")
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the samples.")
@click.option(
    "--tolerance", type=TOLERANCE, default=1e-7, show_default=True,
    help="Largest difference relative to max(1, largest entry).",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def check_jacobian(
    name: str,
    source: str | None,
    place: str,
    given: tuple[str, ...],
    chart: str | None,
    layout: str | None,
    normalise: bool,
    samples: int,
    seed: int,
    tolerance: float,
    as_json: bool,
) -> None:
    """Compare the residual and Jacobians of a function of yours with the factor NAME of SOURCE.

    The function gets the stored arguments in the factor's order; a factor of GTSAM has the variables as its
    keys, in order, and is compared without its noise. Where something differs, a known convention is named
    if one explains it: chart, layout, order of the tangent, side, sign, a factor that is missing, and so on;
    else which entries differ, and at which samples. The function runs in a process of its own.
    """
    from liegen.foreign import compare, separate

    (function,) = chosen(source, [name], (), Convention(chart, layout, normalise))
    named = dict(_pair(text, function) for text in given)
    with separate(place, function, named) as found:
        result = compare(function, found, samples=samples, seed=seed, tolerance=tolerance)
    if as_json:
        click.echo(json.dumps(result.as_json(), indent=2))
    else:
        _print(result)
    if not result.passed:
        raise click.exceptions.Exit(1)


def _print(result: Comparison) -> None:
    table(
        ("output", "worst", "entry", "expected", "found", "verdict"),
        [
            (f.name, f"{f.worst:.1e}", str([*f.entry]), f"{f.expected:.9g}", f"{f.found:.9g}", f.verdict)
            for f in result.findings
        ],
        right=(1, 3, 4),
    )
    for f in result.findings:
        if not f.correct:
            say(f"\n{f.name} is worst at: {f.sample}")
        if f.same:
            say(f"{f.name} is explained as well by: {'; or: '.join(f.same)}")
    if result.convention:
        cure = f"; check it with {result.options}" if result.options else ""
        say(f"\nAll outputs are correct in {result.convention}{cure}")
    say(f"\n{count(result.samples, 'sample')}, tolerance {result.tolerance:g}")
    for why, number in result.left_out:
        say(f"{count(number, 'more sample')} left out: {why}")


def _pair(text: str, function: AnyFunction) -> tuple[str, str]:
    argument, _, name = text.partition("=")
    known = [p.name for p in function.graph.parameters if not p.variable]
    if argument not in known or not name:
        raise click.UsageError(
            f"--given {text}: write ARGUMENT=NAME, with one of {function.name}'s given arguments: "
            f"{', '.join(known)}"
        )
    return argument, name
