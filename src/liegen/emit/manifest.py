"""Manifests: what liegen wrote into a folder, one for each package, and which files belong to whom."""

from __future__ import annotations

import json
import shlex
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, cast

from liegen.errors import OutputError

from .rendering import FORMAT

#: What every manifest says of itself, whatever its version.
_MARK = FORMAT.rpartition(" ")[0]
#: Bytes of a manifest, at most.
_LARGEST = 64 << 20


@dataclass(frozen=True)
class Manifest:
    """A package in a folder: the command that makes its files anew, and their paths."""

    path: Path
    package: str
    regenerate: str
    files: tuple[str, ...]

    @property
    def source(self) -> str:
        """The file or module that the command names, empty for liegen's own factors."""
        return source_of(self.regenerate)


def source_of(regenerate: str) -> str:
    """What ``liegen generate SOURCE ...`` names; empty where it names none, or is no such command."""
    try:
        words = shlex.split(regenerate)
    except ValueError:
        return ""
    named = words[:2] == ["liegen", "generate"] and len(words) > 2 and not words[2].startswith("-")
    return words[2] if named else ""


def manifest_path(files: Mapping[str, str]) -> str:
    """The manifest: the one file that lies in no folder."""
    (path,) = (path for path in files if "/" not in path)
    return path


def read_manifest(path: Path) -> Manifest | None:
    """An existing manifest, None where there is no file.

    Raises :class:`OutputError` for a file that is no manifest of liegen, that another version wrote, or that
    lists a path outside of its tree.
    """
    try:
        text = _text(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise OutputError(f"cannot read {path}: {error.strerror}; nothing was changed") from error
    except ValueError as error:
        raise _refused(path, str(error)) from None
    content = _parsed(path, text)
    if content.get("format") != FORMAT:
        if f"{_MARK} " in str(content.get("format")):
            raise OutputError(f"another version of liegen wrote {path}; use that one, or another folder")
        raise _refused(path, "it does not say so")
    options, files = content.get("options"), content.get("files")
    regenerate = cast("dict[str, Any]", options).get("regenerate") if isinstance(options, dict) else None
    if not isinstance(regenerate, str):
        raise _refused(path, "its options.regenerate is no text")
    if not isinstance(files, dict) or not all(map(inside, names := [*map(str, cast("Any", files))])):
        raise _refused(path, "its files are not those of a tree")
    return Manifest(path, path.stem, regenerate, tuple(sorted(names)))


def manifests(directory: Path) -> tuple[Manifest, ...]:
    """All manifests in a folder; files that are none are left out.

    Raises :class:`OutputError` for one that is damaged, or that another version of liegen wrote: which files
    are its own cannot be told.
    """
    found: list[Manifest] = []
    for path in sorted(directory.glob("*.json")):
        manifest = read_manifest(path) if _may_be_manifest(path) else None
        found += [manifest] if manifest else []
    return tuple(found)


def _may_be_manifest(path: Path) -> bool:
    """Whether a file says so, or is damaged and lies beside a folder of its name, as manifests do."""
    try:
        text = _text(path)
    except (OSError, ValueError):
        return False
    try:
        content: Any = json.loads(text)
    except (ValueError, RecursionError):
        return _MARK in text or path.with_suffix("").is_dir()
    return isinstance(content, dict) and _MARK in str(cast("dict[str, Any]", content).get("format"))


def inside(name: str) -> bool:
    """Whether a path is that of a file in a folder of the tree."""
    parts = PurePosixPath(name).parts
    return len(parts) == 2 and name == "/".join(parts) and ".." not in parts and "\\" not in name


def check_owner(text: str, own: Manifest | None) -> None:
    """Raise :class:`OutputError` where a manifest would replace that of a package from another source."""
    try:
        source = source_of(str(json.loads(text)["options"]["regenerate"]))
    except (ValueError, KeyError, TypeError):
        return
    if own is not None and source != own.source:
        raise OutputError(
            f"{own.path} belongs to the package of {own.source or 'the library'}; nothing was changed. "
            f"Give that of {source or 'the library'} another name with --package, choose another folder, or "
            "delete the files of the old one first"
        )


def check_shared(files: Mapping[str, str], others: Iterable[Manifest]) -> None:
    """Raise :class:`OutputError` where a file would replace one of another package in the same folder."""
    for other in others:
        shared = sorted(set(files) & set(other.files))
        if shared:
            names = ", ".join(shared[:5]) + (f" and {len(shared) - 5} more" if shared[5:] else "")
            raise OutputError(
                f"{other.path.parent} already holds {names} of {other.source or 'the library'}, "
                f"as {other.path.name} lists; nothing was changed. Rename the factors, or choose another "
                "folder"
            )


def _text(path: Path) -> str:
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise ValueError("it is no plain file")
    if status.st_size > _LARGEST:
        raise ValueError(f"it is larger than {_LARGEST >> 20} MiB")
    return path.read_text(encoding="utf-8")


def _parsed(path: Path, text: str) -> dict[str, Any]:
    try:
        content: Any = json.loads(text)
    except RecursionError:
        raise _refused(path, "it nests too deeply") from None
    except ValueError as error:
        raise _refused(path, str(error)) from None
    if not isinstance(content, dict):
        raise _refused(path, "it holds no object")
    return cast("dict[str, Any]", content)


def _refused(path: Path, reason: str) -> OutputError:
    return OutputError(
        f"{path} is no manifest that liegen wrote ({reason}); choose another folder or move that file away"
    )
