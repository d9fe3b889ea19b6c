"""Writing a generated tree: all of it or nothing, and never over a file that liegen did not write."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from liegen.errors import OutputError

from .tree import folders, manifest_path, on_disk, read_manifest

#: Foreign files that an error message names.
NAMED = 5


@dataclass(frozen=True)
class Written:
    """What :func:`write_tree` did: paths that were written, left as they were, and removed."""

    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]


def write_tree(files: Mapping[str, str], directory: Path) -> Written:
    """Write the files of :func:`render` into a folder, which is made if need be.

    Files that the old manifest lists and ``files`` does not have are removed. Everything is first written to
    a temporary folder inside ``directory``, then moved file by file, the manifest last; a failure puts back
    what was there. Raises :class:`OutputError`, with nothing changed, where the folders hold files that
    liegen did not write, or where writing fails.
    """
    _check_place(directory)
    try:
        return _write(files, directory)
    except OSError as error:
        raise OutputError(f"cannot write to {directory}: {error}; nothing was changed") from error


def _write(files: Mapping[str, str], directory: Path) -> Written:
    manifest = manifest_path(files)
    listed = read_manifest(directory / manifest)
    present = on_disk(directory, folders([*files, *listed]))
    same = {path for path in [*present, manifest] if path in files and _same(directory / path, files[path])}
    _refuse_foreign(sorted(set(present) - set(listed) - same), directory)
    orphans = tuple(sorted((set(listed) & set(present)) - set(files)))
    fresh = [path for path in files if path not in same and path != manifest]
    fresh += [] if manifest in same else [manifest]
    if fresh or orphans:
        with _made(directory, ["", *folders(fresh)]), _stage(directory) as stage:
            _move(directory, stage, fresh, orphans, files)
    for top in folders(orphans):
        if not any((directory / top).iterdir()):
            (directory / top).rmdir()
    return Written(tuple(fresh), tuple(sorted(same)), orphans)


def _check_place(directory: Path) -> None:
    existing = next(p for p in (directory, *directory.absolute().parents) if p.exists() or p.is_symlink())
    if not existing.is_dir():
        raise OutputError(
            f"{existing} is a file, so nothing can be written to {directory}; choose another folder"
        )


def _same(path: Path, text: str) -> bool:
    return path.is_file() and not path.is_symlink() and path.read_bytes() == text.encode()


def _refuse_foreign(foreign: Sequence[str], directory: Path) -> None:
    if foreign:
        names = ", ".join(foreign[:NAMED]) + (f" and {len(foreign) - NAMED} more" if foreign[NAMED:] else "")
        raise OutputError(
            f"{directory} holds files that liegen did not write: {names}; nothing was changed. "
            "Choose another folder, or move these files away"
        )


@contextmanager
def _made(directory: Path, tops: Sequence[str]) -> Generator[None]:
    """Make the folders, and take away again those that were made when the block fails."""
    made: list[Path] = []
    try:
        for place in [*reversed(directory.absolute().parents), *(directory / top for top in tops)]:
            if not place.exists():
                place.mkdir()
                made.append(place)
        yield
    except BaseException:
        for place in reversed(made):
            with suppress(OSError):
                place.rmdir()
        raise


@contextmanager
def _stage(directory: Path) -> Generator[Path]:
    """A temporary folder on the same file system, so that a move is atomic."""
    stage = Path(tempfile.mkdtemp(prefix=".liegen-", dir=directory))
    try:
        yield stage
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _move(
    directory: Path, stage: Path, fresh: Sequence[str], orphans: Sequence[str], files: Mapping[str, str]
) -> None:
    """Write, back up, and only then move; put everything back when a move fails."""
    new, old = stage / "new", stage / "old"
    for path in fresh:
        (new / path).parent.mkdir(parents=True, exist_ok=True)
        (new / path).write_bytes(files[path].encode())
    backed = [path for path in [*fresh, *orphans] if (directory / path).exists()]
    for path in backed:
        (old / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(directory / path, old / path, follow_symlinks=False)
    done: list[str] = []
    try:
        for path in orphans:
            done.append(path)
            (directory / path).unlink()
        for path in fresh:
            done.append(path)
            (new / path).replace(directory / path)
    except BaseException:
        for path in reversed(done):
            if path in backed:
                (old / path).replace(directory / path)
            else:
                (directory / path).unlink(missing_ok=True)
        raise
