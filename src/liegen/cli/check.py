"""``liegen check``: is a generated tree what liegen would write now?"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .generate import Request, generate, rendered, requested
from .shared import say, source_argument

if TYPE_CHECKING:
    from liegen.emit import TreeReport

#: Lines of a diff that are shown for a file.
SHOWN = 20


@click.command()
@click.argument("directory", metavar="[DIR]", default="generated")
@source_argument
def check(directory: str, source: str | None) -> None:
    """Compare a generated tree with what would be written now. DIR is 'generated' by default.

    Repeats the command that the tree's manifest states, and those of the trees right below it. Give SOURCE
    where the manifest's file is not in the current folder, or beside DIR.
    """
    from liegen.emit import check_tree

    clean = True
    for folder, manifest in _manifests(Path(directory)):
        stated = str(manifest["options"]["regenerate"])
        request = _request(stated, folder, source)
        files = rendered(request, request.chosen(request.source), stated)
        report = check_tree(files, folder)
        for line in _lines(report, folder, len(files)):
            say(line)
        if not report.ok:
            clean = False
            say(f"mend it with: {request.command(request.source, str(folder))}")
    if not clean:
        raise click.exceptions.Exit(1)


def _manifests(folder: Path) -> list[tuple[Path, dict[str, Any]]]:
    """Every manifest in the folder and right below it, with its folder. Raises OutputError without any."""
    from liegen.emit.rendering import FORMAT
    from liegen.errors import OutputError

    found: list[tuple[Path, dict[str, Any]]] = []
    for path in [*sorted(folder.glob("*.json")), *sorted(folder.glob("*/*.json"))]:
        try:
            content: Any = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if isinstance(content, dict) and content.get("format") == FORMAT:  # pyright: ignore[reportUnknownMemberType]
            found.append((path.parent, content))  # pyright: ignore[reportUnknownArgumentType]
    if not found:
        raise OutputError(
            f"{folder} holds no manifest that liegen wrote; "
            f"generate it first: {shlex.join(['liegen', 'generate', '-o', str(folder)])}"
        )
    return found


def _request(stated: str, folder: Path, source: str | None) -> Request:
    """Read the command of a manifest; ``source`` replaces its file."""
    from liegen.errors import SourceError

    with generate.make_context("generate", shlex.split(stated)[2:], resilient_parsing=True) as context:
        given = context.params
    original: str | None = given["source"]
    place = source or original
    if source is None and original is not None and original.endswith(".py"):
        candidates = (Path(original), folder / original, folder.absolute().parent / original)
        place = next((str(p) for p in candidates if p.is_file()), None)
        if place is None:
            raise SourceError(
                f"{folder} was made from {original}, which is not here; say where it is: "
                f"liegen check {shlex.quote(str(folder))} PATH/{original}"
            )
    return replace(requested(given), source=place)


def _lines(report: TreeReport, folder: Path, count: int) -> Iterable[str]:
    """What differs, one file a line, with the beginning of each diff."""
    if report.ok:
        yield f"{folder}: {count} files, all up to date"
    for path in report.missing:
        yield f"missing  {folder / path}"
    for path in report.orphans:
        yield f"orphan   {folder / path}: liegen would not write it; remove it"
    for change in report.changed:
        yield f"changed  {folder / change.path}"
        diff = change.diff.splitlines()
        yield from (f"    {line}" for line in diff[:SHOWN])
        if len(diff) > SHOWN:
            yield f"    ... {len(diff) - SHOWN} more lines"
