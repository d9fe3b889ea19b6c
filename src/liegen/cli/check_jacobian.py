"""``liegen check-jacobian``: hold somebody's Jacobians against a formula."""

from __future__ import annotations

import json

import click

from .shared import chosen, count, source_argument, table


@click.command("check-jacobian")
@click.argument("name")
@source_argument
@click.option(
    "--against", "place", required=True, metavar="PLACE:FUNCTION",
    help="FILE.py:FUNCTION or MODULE:FUNCTION with f(x, y, ...) -> (res, J_x, J_y, ...), or"
    " LIBRARY.so:FUNCTION with the signature of the generated C.",
)  # fmt: skip
@click.option("--samples", type=click.IntRange(min=1), default=24, show_default=True, help="Random samples.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the samples.")
@click.option(
    "--tolerance", type=click.FloatRange(min=0, min_open=True), default=1e-7, show_default=True,
    help="Largest difference relative to max(1, largest entry).",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def check_jacobian(
    name: str, source: str | None, place: str, samples: int, seed: int, tolerance: float, as_json: bool
) -> None:
    """Compare the residual and Jacobians of a function of yours with the factor NAME of SOURCE.

    The function gets the stored arguments in the factor's order. Where it differs, a known convention is
    named if one explains it: order of the tangent, side, sign, missing Jr^-1, half angles.
    """
    from liegen.foreign import compare, foreign

    (function,) = chosen(source, [name])
    result = compare(
        function, foreign(place, function.kernel), samples=samples, seed=seed, tolerance=tolerance
    )
    if as_json:
        click.echo(json.dumps(result.as_json(), indent=2))
    else:
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
                click.echo(f"\n{f.name} is worst at: {f.sample}")
        click.echo(f"\n{count(result.samples, 'sample')}, tolerance {tolerance:g}")
    if not result.passed:
        raise click.exceptions.Exit(1)
