"""What several commands share: arguments, tables, progress. Imports of weight stand inside functions."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from liegen.errors import DefinitionError
from liegen.text import one_line, printable

from .tables import table as table

if TYPE_CHECKING:
    from liegen.sources import AnyFunction

T = TypeVar("T")


def new_file(context: click.Context, parameter: click.Parameter, value: str | None) -> str | None:
    """A file to write, in a folder that is there: checked before anything is measured."""
    if value is not None:
        path = Path(value)
        if path.is_dir():
            raise click.BadParameter(f"{value} is a folder; give the name of a file", context, parameter)
        if not path.parent.is_dir():
            raise click.BadParameter(f"there is no folder {path.parent}; make it first", context, parameter)
    return value


def old_file(context: click.Context, parameter: click.Parameter, value: str | None) -> str | None:
    """A file to read."""
    if value is not None and not Path(value).is_file():
        what = "is a folder" if value and Path(value).is_dir() else "does not exist"
        raise click.BadParameter(f"{value or 'the file'} {what}; give the name of a file", context, parameter)
    return value


def new_folder(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A folder to write to."""
    if not value:
        raise click.BadParameter(
            "the name of the output folder is empty; '.' is this folder", context, parameter
        )
    return value


source_argument = click.argument("source", required=False)
names_option = click.option(
    "-f", "--factor", "names", multiple=True, metavar="NAME", help="Only this factor; may be repeated."
)


def convention_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--chart``, ``--layout`` and ``--normalise`` of a command; names are checked where they are used."""
    options = (
        click.option(
            "--chart", metavar="PRESET", help="Chart of local, retract and the Jacobians' columns: gtsam "
            "(default), gtsam-4.2, symforce, sophus, manif, ceres, g2o, ros. A factor that states its chart "
            "keeps it."),
        click.option(
            "--layout", metavar="NAME", help="What rotations and poses are stored as: xyzw (default), wxyz, "
            "matrix, 4x4, 3x4 (these also with -col), or the name of a preset. A factor that states its "
            "layout keeps it."),
        click.option(
            "--normalise", is_flag=True, help="Bring quaternions, (cos, sin) and directions of arguments to "
            "unit length."),
    )  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


groups_option = click.option(
    "--group", "groups", multiple=True, metavar="GROUP",
    help="The functions of this Lie group (SE3, ...) instead of factors; may be repeated.",
)  # fmt: skip


def noise_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--noise``, ``--loss`` and ``--mode`` of a command; their names are checked where they are used."""
    options = (
        click.option("--noise", metavar="MODEL", help="Whiten: full, packed, diagonal or isotropic."),
        click.option("--loss", metavar="LOSS", help="Robust loss: huber, cauchy, tukey, barron, ..."),
        click.option("--mode", metavar="MODE", help="How the loss is applied: irls (default) or triggs."),
    )
    for option in reversed(options):
        command = option(command)
    return command


def weighed(
    functions: Sequence[AnyFunction], noise: str | None, loss: str | None, mode: str | None
) -> tuple[AnyFunction, ...]:
    """The factors with noise and loss; those of before where none is given.

    A ``@function`` has no residual to weigh and stays as it is. Raises DefinitionError where there is no
    factor.
    """
    if noise is loss is mode is None:
        return tuple(functions)
    some = any(f.is_factor for f in functions)
    return tuple(f if some and not f.is_factor else f.whitened(noise, loss, mode) for f in functions)


def say_left(functions: Sequence[AnyFunction], options: Collection[object]) -> None:
    """A note on the functions that options of factors leave as they are, where one of the options is given.

    Raises DefinitionError where there is no factor.
    """
    left = [f for f in functions if not f.is_factor]
    if not any(options) or not left:
        return
    names = ", ".join(f.name for f in left)
    options_of = "--noise, --loss, --mode and --gauss-newton are of factors, which have a residual"
    if len(left) == len(functions):
        raise DefinitionError(f"{left[0].plain.site}: {options_of}; there is none: {names}")
    click.echo(printable(f"note: {options_of}; left as they are: {names}"), err=True)


def weighed_by_name(
    source: str | None,
    groups: Sequence[str],
    convention: Convention,
    noise: str | None,
    loss: str | None,
    mode: str | None,
) -> dict[str, AnyFunction]:
    """All factors of a source in a convention, with noise and loss: how other processes load them again."""
    from liegen.sources import load

    return {f.name: f for f in weighed(convention.of(load(source, groups)), noise, loss, mode)}


@dataclass(frozen=True)
class Convention:
    """The chart and the layout that a command asks for."""

    chart: str | None = None
    layout: str | None = None
    normalise: bool = False

    def of(self, functions: Sequence[AnyFunction]) -> tuple[AnyFunction, ...]:
        """The factors in it. Raises DefinitionError for an unknown chart or layout."""
        from liegen.charts import preset
        from liegen.layouts import stored

        if self.chart is not None:
            preset(self.chart, "--chart")
        if self.layout is not None:
            stored(self.layout, "--layout")
        return tuple(
            f.in_chart(self.chart).in_layout(self.layout, normalise=self.normalise) for f in functions
        )


def chosen(
    source: str | None,
    names: Sequence[str],
    groups: Sequence[str] = (),
    convention: Convention = Convention(),
) -> tuple[AnyFunction, ...]:
    """The factors, or the functions of groups, that a command is about, in a chart and a layout.

    Raises DefinitionError for an unknown one.
    """
    from liegen.sources import load, select

    return convention.of(select(load(source, groups), names))


def count(n: int, noun: str) -> str:
    """``1 factor``, ``2 factors``."""
    return f"{n} {noun}{'' if n == 1 else 's'}"


def say(text: str = "", *, nl: bool = True) -> None:
    """Print text that may hold what users wrote: a terminal gets no control characters."""
    click.echo(printable(text), nl=nl)


def tracked(items: Sequence[T], what: str, label: Callable[[T], str]) -> Iterator[T]:
    """The items, with progress on standard error while it is a terminal."""
    if not sys.stderr.isatty() or len(items) < 2:
        yield from items
        return
    with progress() as bar:
        task = bar.add_task(what, total=len(items))
        for item in items:
            bar.update(task, description=one_line(f"{what} {label(item)}"))
            yield item
            bar.advance(task)


@contextmanager
def bar(title: str, verb: str) -> Generator[Callable[[str, int, int], None] | None]:
    """Tells what is done, how much of it, of how much, while standard error is a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    with progress() as shown:
        task = shown.add_task(title, total=None)

        def told(what: str, done: int, total: int) -> None:
            shown.update(task, completed=done, total=total, description=one_line(f"{verb} {what}"))

        yield told


def progress() -> Any:
    """A progress bar on standard error that disappears at the end."""
    from rich.console import Console
    from rich.progress import Progress

    return Progress(console=Console(stderr=True), transient=True)
