"""A generated tree on disk: what is there, which of it liegen wrote, and whether it is up to date."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from liegen.errors import OutputError

from .rendering import FORMAT


@dataclass(frozen=True)
class Change:
    """A file with another text than liegen would write; ``diff`` is unified, from the file to that text."""

    path: str
    diff: str


@dataclass(frozen=True)
class TreeReport:
    """How a generated tree differs from what would be written now."""

    missing: tuple[str, ...]
    changed: tuple[Change, ...]
    orphans: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Whether the tree is up to date."""
        return not (self.missing or self.changed or self.orphans)


def manifest_path(files: Mapping[str, str]) -> str:
    """The manifest: the one file that lies in no folder."""
    (path,) = (path for path in files if "/" not in path)
    return path


def folders(paths: Iterable[str]) -> tuple[str, ...]:
    """The folders at the top of a tree that belong to liegen."""
    return tuple(sorted({path.split("/")[0] for path in paths if "/" in path}))


def read_manifest(path: Path) -> tuple[str, ...]:
    """The files that an existing manifest lists, none where there is no manifest.

    Raises :class:`OutputError` for a file that is no manifest of liegen, or lists a path outside of its tree.
    """
    if not path.exists():
        return ()
    try:
        content: Any = json.loads(path.read_text(encoding="utf-8"))
        listed = (
            tuple(sorted(str(name) for name in content["files"])) if content["format"] == FORMAT else None
        )
    except (OSError, ValueError, KeyError, TypeError):
        listed = None
    if listed is None or not all(map(_inside, listed)):
        raise OutputError(
            f"{path} is no manifest that liegen wrote; choose another folder or move that file away"
        )
    return listed


def _inside(name: str) -> bool:
    parts = PurePosixPath(name).parts
    return len(parts) == 2 and name == "/".join(parts) and ".." not in parts and "\\" not in name


def on_disk(directory: Path, tops: Iterable[str]) -> tuple[str, ...]:
    """All files below the given folders, ``__pycache__`` left out; links count as files."""
    found: list[str] = []
    for top in tops:
        root = directory / top
        if root.is_symlink() or root.is_file():
            found.append(top)
            continue
        below = sorted(root.rglob("*")) if root.is_dir() else []
        paths = [p.relative_to(directory) for p in below if p.is_symlink() or not p.is_dir()]
        found += [p.as_posix() for p in paths if "__pycache__" not in p.parts]
    return tuple(found)


def check_tree(files: Mapping[str, str], directory: Path) -> TreeReport:
    """Compare what :func:`render` gives with a folder. Nothing is written.

    Orphans are files that an older manifest lists, or that lie in the package's folder or the C folder,
    and that ``files`` does not have. Raises :class:`OutputError` where the manifest cannot be read.
    """
    listed = read_manifest(directory / manifest_path(files))
    missing: list[str] = []
    changed: list[Change] = []
    for path, text in sorted(files.items()):
        place = directory / path
        if not place.is_file():
            missing.append(path)
        elif place.read_bytes() != text.encode():
            changed.append(Change(path, _diff(path, place.read_bytes().decode(errors="replace"), text)))
    present = on_disk(directory, folders([*files, *listed]))
    return TreeReport(tuple(missing), tuple(changed), tuple(sorted(set(present) - set(files))))


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
