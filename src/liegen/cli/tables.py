"""Tables: ruled on a terminal, plain columns anywhere else, lines where it is narrow. Numbers are whole."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable, Sequence

import click

from liegen.text import one_line, printable

#: Columns of numbers are at least so wide where the terminal is narrow: longer titles are parted.
_NARROW = 8
#: Spaces between columns; one where the terminal is narrow.
_GAP = 2


def table(titles: Sequence[str], rows: Iterable[Sequence[str]], *, right: Collection[int] = ()) -> None:
    """Print a table; the columns ``right`` are numbers."""
    content = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(len(row[k]) for row in [titles, *content]) for k in range(len(titles))]
    if sys.stdout.isatty():
        _ruled(titles, content, right, widths)
        return
    for row in [titles, *content]:
        sized = enumerate(zip(row, widths, strict=True))
        cells = [cell.rjust(w) if k in right else cell.ljust(w) for k, (cell, w) in sized]
        click.echo(printable("  ".join(cells).rstrip()))


def _ruled(
    titles: Sequence[str], content: Sequence[Sequence[str]], right: Collection[int], widths: Sequence[int]
) -> None:
    """Where the terminal is narrow, texts are folded, titles of numbers parted, empty columns left out.

    Where that is not enough, each row stands in lines of its own.
    """
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    narrow = sum(widths) + _GAP * (len(widths) - 1) > console.width
    kept = [k for k in range(len(titles)) if not narrow or any(row[k] for row in content) or not content]
    gap = 0 if narrow else _GAP - 1
    longest = [max((len(row[k]) for row in content), default=0) for k in range(len(titles))]
    shown = [
        parted(title, max(cells, _NARROW)) if narrow and k in right else title
        for k, (title, cells) in enumerate(zip(titles, longest, strict=True))
    ]
    least = [
        max(longest[k], *map(len, shown[k].split("\n"))) if k in right else min(longest[k], _NARROW)
        for k in kept
    ]
    if narrow and sum(least) + len(least) - 1 > console.width:
        for row in content:
            click.echo("\n".join(printable(f"{titles[k]}: {row[k]}") for k in kept) + "\n")
        return
    ruled = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, gap, 0, 0))
    for k in kept:
        number = k in right
        ruled.add_column(
            shown[k], justify="right" if number else "left", no_wrap=number or not narrow, overflow="fold"
        )
    for row in content:
        ruled.add_row(*(Text(row[k]) for k in kept))
    console.print(ruled)


def parted(title: str, width: int) -> str:
    """A title in lines of at most ``width`` characters, broken at spaces, within words with a hyphen."""
    lines: list[str] = []
    for word in title.split():
        rest = word
        if lines and len(lines[-1]) + 1 + len(rest) <= width:
            lines[-1] += f" {rest}"
            continue
        while len(rest) > width:
            half = (len(rest) + 1) // 2 if len(rest) < 2 * width else width - 1
            lines.append(f"{rest[:half]}-")
            rest = rest[half:]
        lines.append(rest)
    return "\n".join(lines)
