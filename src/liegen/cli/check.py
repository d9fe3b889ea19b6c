"""``liegen check``: is a generated tree what liegen would write now?"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from liegen.text import one_line

from .generate import Request, generate, rendered, requested
from .shared import say, source_argument

if TYPE_CHECKING:
    from liegen.emit import Manifest, TreeReport

#: Lines of a diff that are shown for a file.
SHOWN = 20


@click.command()
@click.argument("directory", metavar="[DIR]", default="generated")
@source_argument
def check(directory: str, source: str | None) -> None:
    """Compare a generated tree with what would be written now. DIR is 'generated' by default.

    Repeats the command that each manifest in DIR states, and those of the trees right below it. Give SOURCE
    where a manifest's file is not in the current folder, or beside DIR. What a killed 'generate' left half
    written is put back first.
    """
    from liegen.emit import check_tree
    from liegen.errors import OutputError

    clean = True
    for manifest, request in _requests(Path(directory), source):
        folder = manifest.path.parent
        files = rendered(request, request.chosen(request.source), manifest.regenerate)
        try:
            report = check_tree(files, folder)
        except OSError as error:
            raise OutputError(f"cannot read {error.filename or folder}: {error.strerror}") from None
        for line in _lines(report, folder, len(files)):
            say(line)
        if not report.ok:
            clean = False
            say(f"mend it with: {_cure(report, folder, request)}")
    if not clean:
        raise click.exceptions.Exit(1)


def _requests(top: Path, source: str | None) -> list[tuple[Manifest, Request]]:
    """Every manifest in the folder and right below it, and what it asks for.

    ``source`` stands for the file of that name; where there is one manifest, for its source whatever the
    name. Raises OutputError without a manifest, SourceError where a source is not found.
    """
    from liegen.emit import manifests, put_back
    from liegen.errors import OutputError, SourceError

    found: list[Manifest] = []
    for folder in _folders(top):
        if put_back(folder):
            say(f"{folder}: a run of liegen was killed while it wrote here; what it had changed was put back")
        found += manifests(folder)
    if not found:
        raise OutputError(
            f"{top} holds no manifest that liegen wrote; "
            f"generate it first: {shlex.join(['liegen', 'generate', '-o', str(top)])}"
        )
    meant = [m for m in found if source is not None and (len(found) == 1 or _same_name(m.source, source))]
    if source is not None and not meant:
        sources = ", ".join(dict.fromkeys(m.source or "the library" for m in found))
        raise SourceError(f"nothing in {top} was made from {source}; it was made from {sources}")
    return [(m, _request(m, source if m in meant else None)) for m in found]


def _folders(top: Path) -> list[Path]:
    """The folder and those right below it. Raises OutputError where it cannot be read."""
    from liegen.errors import OutputError

    if top.is_file():
        raise OutputError(f"{top} is a file, not a folder that liegen wrote; give the folder")
    try:
        below = sorted(path for path in top.iterdir() if path.is_dir()) if top.exists() else []
    except OSError as error:
        raise OutputError(f"cannot read {top}: {error.strerror}; give the folder of a tree") from None
    return [top, *(path for path in below if not path.name.startswith("."))]


def _same_name(stated: str, source: str) -> bool:
    return stated in (source, Path(source).name)


def _request(manifest: Manifest, source: str | None) -> Request:
    """Read the command of a manifest; ``source`` replaces its file."""
    from liegen.errors import OutputError, SourceError

    folder = manifest.path.parent
    try:
        words = shlex.split(manifest.regenerate)
        if words[:2] != ["liegen", "generate"]:
            raise ValueError("it does not begin with liegen generate")
        with generate.make_context("generate", words[2:], help_option_names=[]) as context:
            request = requested(context.params)
    except (click.ClickException, click.exceptions.Exit, ValueError) as error:
        reason = error.format_message() if isinstance(error, click.ClickException) else str(error)
        raise OutputError(
            f"{manifest.path} states a command that this version of liegen does not know ({reason}): "
            f"{manifest.regenerate}; generate the folder anew"
        ) from None
    place = source or request.source
    if source is None and place is not None and place.endswith(".py"):
        candidates = (Path(place), folder / place, folder.parent / place, folder.absolute().parent / place)
        original, place = place, next((str(p) for p in candidates if p.is_file()), None)
        if place is None:
            raise SourceError(
                f"{folder} was made from {original}, which is not here; say where it is: "
                f"liegen check {shlex.quote(str(folder))} PATH/{original}"
            )
    return replace(request, source=place)


def _cure(report: TreeReport, folder: Path, request: Request) -> str:
    """The commands after which nothing differs: ``generate`` spares files that no manifest lists.

    An orphan that the manifest lists makes a change of the manifest too.
    """
    orphans = [str(folder / path) for path in report.unlisted]
    end = ["--"] if str(folder).startswith("-") else []
    steps = [shlex.join(["rm", *end, *orphans])] if orphans else []
    if report.missing or report.changed:
        steps.append(request.command(request.source, str(folder)))
    return " && ".join(steps)


def _lines(report: TreeReport, folder: Path, count: int) -> Iterable[str]:
    """What differs, one file a line, with the beginning of each diff."""
    if report.ok:
        yield one_line(f"{folder}: {count} files, all up to date")
    for path in report.missing:
        yield one_line(f"missing  {folder / path}")
    for path in report.orphans:
        known = "no manifest lists it" if path in report.unlisted else "liegen would not write it"
        yield one_line(f"orphan   {folder / path}: {known}")
    for change in report.changed:
        yield one_line(f"changed  {folder / change.path}")
        diff = change.diff.splitlines()
        yield from (f"    {line}" for line in diff[:SHOWN])
        if len(diff) > SHOWN:
            yield f"    ... {len(diff) - SHOWN} more lines"
