"""``liegen list`` and ``liegen explain``."""

from __future__ import annotations

import json

import click

from .shared import (
    chart_option,
    chosen,
    groups_option,
    noise_options,
    source_argument,
    table,
    weighed,
)


@click.command("list")
@source_argument
@groups_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def list_factors(source: str | None, groups: tuple[str, ...], as_json: bool) -> None:
    """List the factors of SOURCE (or the functions of groups): signature, residual dimension, meaning."""
    from liegen.explain import summary

    rows = [summary(f) for f in chosen(source, (), groups)]
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
@groups_option
@chart_option
@noise_options
@click.option("--latex", "as_latex", is_flag=True, help="Print the residual and its Jacobians in LaTeX.")
def explain(
    name: str,
    source: str | None,
    groups: tuple[str, ...],
    chart: str | None,
    noise: str | None,
    loss: str | None,
    mode: str | None,
    as_latex: bool,
) -> None:
    """Show the residual, its Jacobians at group level, and the operations after each pass."""
    from liegen.explain import explanation, latex_explanation

    (function,) = weighed(chosen(source, [name], groups, chart), noise, loss, mode)
    click.echo((latex_explanation if as_latex else explanation)(function), nl=False)
