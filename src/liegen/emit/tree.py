"""A generated tree on disk: what is there, which of it liegen wrote, and whether it is up to date."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from .manifest import manifest_path, manifests, read_manifest


@dataclass(frozen=True)
class Change:
    """A file with another text than liegen would write; ``diff`` is unified, from the file to that text."""

    path: str
    diff: str


@dataclass(frozen=True)
class TreeReport:
    """How a generated tree differs from what would be written now.

    ``unlisted``: the orphans that no manifest lists, so that writing the tree does not remove them.
    """

    missing: tuple[str, ...]
    changed: tuple[Change, ...]
    orphans: tuple[str, ...]
    unlisted: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the tree is up to date."""
        return not (self.missing or self.changed or self.orphans)


def folders(paths: Iterable[str]) -> tuple[str, ...]:
    """The folders at the top of a tree that belong to liegen."""
    return tuple(sorted({path.split("/")[0] for path in paths if "/" in path}))


def on_disk(directory: Path, tops: Iterable[str]) -> tuple[str, ...]:
    """All files below the given folders, ``__pycache__`` left out; links count as files.

    Raises OSError for a folder that cannot be read.
    """
    found: list[str] = []
    waiting = sorted(tops, reverse=True)
    while waiting:
        name = waiting.pop()
        place = directory / name
        if place.is_dir() and not place.is_symlink():
            below = (f"{name}/{entry.name}" for entry in place.iterdir() if entry.name != "__pycache__")
            waiting += sorted(below, reverse=True)
        elif place.exists() or place.is_symlink():
            found.append(name)
    return tuple(found)


def check_tree(files: Mapping[str, str], directory: Path) -> TreeReport:
    """Compare what :func:`render` gives with a folder. Nothing is written.

    Orphans are files that an older manifest lists, or that lie in the package's folder or the C folder,
    and that neither ``files`` nor the manifest of another package has. A link is a change whatever it leads
    to: liegen writes plain files. Raises :class:`OutputError` where a manifest cannot be read.
    """
    manifest = manifest_path(files)
    own = read_manifest(directory / manifest)
    listed = own.files if own else ()
    theirs = {p for other in manifests(directory) if other.path.name != manifest for p in other.files}
    missing: list[str] = []
    changed: list[Change] = []
    for path, text in sorted(files.items()):
        place = directory / path
        if place.is_symlink():
            changed.append(Change(path, f"{path} is a link; liegen writes a file"))
        elif not place.is_file():
            missing.append(path)
        elif place.read_bytes() != text.encode():
            changed.append(Change(path, _diff(path, place.read_bytes().decode(errors="replace"), text)))
    orphans = sorted(set(on_disk(directory, folders([*files, *listed]))) - set(files) - theirs)
    unlisted = tuple(path for path in orphans if path not in listed)
    return TreeReport(tuple(missing), tuple(changed), tuple(orphans), unlisted)


def _diff(path: str, old: str, new: str) -> str:
    lines = difflib.unified_diff(
        old.splitlines(keepends=True),
        new.splitlines(keepends=True),
        f"{path} (on disk)",
        f"{path} (generated now)",
    )
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )
