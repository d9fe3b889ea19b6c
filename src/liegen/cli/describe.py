"""``liegen list`` and ``liegen explain``."""

from __future__ import annotations

import json

import click

from liegen.text import in_json

from .shared import (
    Convention,
    chosen,
    convention_options,
    groups_option,
    noise_options,
    say,
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
        click.echo(in_json(json.dumps([row.as_json() for row in rows], indent=2, ensure_ascii=False)))
        return
    table(
        ("factor", "arguments", "result", "meaning"),
        [(row.name, row.arguments, row.results, row.meaning) for row in rows],
    )


@click.command()
@click.argument("name")
@source_argument
@groups_option
@convention_options
@noise_options
@click.option("--latex", "as_latex", is_flag=True, help="Print the residual and its Jacobians in LaTeX.")
def explain(
    name: str,
    source: str | None,
    groups: tuple[str, ...],
    chart: str | None,
    layout: str | None,
    normalise: bool,
    noise: str | None,
    loss: str | None,
    mode: str | None,
    as_latex: bool,
) -> None:
    """Show the residual, its Jacobians at group level, and the operations after each pass."""
    from liegen.explain import explanation, latex_explanation

    convention = Convention(chart, layout, normalise)
    (function,) = weighed(chosen(source, [name], groups, convention), noise, loss, mode)
    say((latex_explanation if as_latex else explanation)(function), nl=False)
