"""``liegen list`` and ``liegen explain``."""

from __future__ import annotations

import json

import click

from .shared import chosen, noise_options, source_argument, table, weighed


@click.command("list")
@source_argument
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def list_factors(source: str | None, as_json: bool) -> None:
    """List the factors of SOURCE: signature, residual dimension, meaning."""
    from liegen.explain import summary

    rows = [summary(f) for f in chosen(source, ())]
    if as_json:
        click.echo(json.dumps([row.as_json() for row in rows], indent=2, ensure_ascii=False))
        return
    table(
        ("factor", "arguments", "result", "meaning"),
        [(row.name, row.arguments, row.results, row.meaning) for row in rows],
    )


@click.command()
@click.argument("name")
@source_argument
@noise_options
def explain(name: str, source: str | None, noise: str | None, loss: str | None, mode: str | None) -> None:
    """Show the residual, its Jacobians at group level, and the operations after each pass."""
    from liegen.explain import explanation

    (function,) = weighed(chosen(source, [name]), noise, loss, mode)
    click.echo(explanation(function), nl=False)
