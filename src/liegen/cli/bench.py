"""``liegen bench``: generated C timed against CasADi's own C."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from .shared import chosen, names_option, source_argument, table


@click.command()
@source_argument
@names_option
@click.option("--calls", default=10_000, show_default=True, help="Distinct random inputs in a round.")
@click.option("--rounds", default=200, show_default=True, help="Rounds; every round runs each variant once.")
@click.option("--seed", default=0, show_default=True, help="Seed of the inputs.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def bench(
    source: str | None, names: tuple[str, ...], calls: int, rounds: int, seed: int, as_json: bool
) -> None:
    """Time the C of factors (default: between_se3), value and all Jacobians.

    Beside it, in turn in one run: CasADi's own C of the same expressions, and of its differentiation
    through the storage. Ratios are medians over the rounds, above 1 where liegen is faster.
    """
    from liegen.bench import FLAGS, compare

    functions = chosen(source, names or (() if source else ("between_se3",)))
    found = {f.name: compare(f, calls=calls, rounds=rounds, seed=seed) for f in functions}
    if as_json:
        content = {name: [asdict(row) for row in rows] for name, rows in found.items()}
        click.echo(
            json.dumps({"flags": FLAGS, "calls": calls, "rounds": rounds, "factors": content}, indent=2)
        )
        return
    rows = [
        (
            name,
            r.name,
            f"{r.minimum_ns:.1f}",
            f"{r.median_ns:.1f}",
            f"{r.ratio:.2f}",
            str(r.operations),
            f"{r.error:.0e}",
        )
        for name, variants in found.items()
        for r in variants
    ]
    table(
        ("factor", "variant", "min ns", "median ns", "ratio", "operations", "difference"),
        rows,
        right=range(2, 7),
    )
    click.echo(f"\n{calls} distinct inputs, {rounds} rounds in turn, {' '.join(FLAGS)}")
