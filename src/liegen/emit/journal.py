"""Changes to a folder that happen as a whole: staged, journalled, moved, and undone where that fails.

New files and the old ones stand in a stage, a temporary folder in the same folder, before the first file is
moved; a journal in the stage says what is about to be moved. While there is a journal, the changes can be
undone, by this process or by the next one; removing it makes them final. All processes lock the folder, so
that a stage that is found belongs to a process that is dead. Nothing is forced to the disk: this is about
processes that are killed, not about power that fails.
"""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from liegen.errors import OutputError

from .manifest import inside

try:
    import fcntl
except ImportError:  # Windows: processes are not told from each other
    fcntl = None

PREFIX = ".liegen-"
JOURNAL, PART, NEW, OLD = "journal.json", "journal.part", "new", "old"
FORMAT = "liegen journal 1"
#: Seconds to wait for another process that writes to the same folder.
WAIT = 20.0
#: Characters of a path that a message shows.
_LONGEST_NAME = 200
_STAGE = re.compile(re.escape(PREFIX) + r"[a-z0-9_]{8}")
_BUSY = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)


@dataclass(frozen=True)
class Changes:
    """Paths in a folder: files that get a new text, in that order, and files that go.

    ``had``: those of either that were there. ``made``: folders that were not.
    """

    fresh: tuple[str, ...]
    removed: tuple[str, ...]
    had: tuple[str, ...]
    made: tuple[str, ...]


class NotUndoneError(OSError):
    """Some files could not be put back; the journal is kept, so that a later run can."""


# --- one process at a time --------------------------------------------------------------------------------


@contextmanager
def locked(directory: Path, wait: float | None = None) -> Generator[None]:
    """Hold the folder against other processes.

    Raises OutputError where one holds it for longer than ``wait`` seconds, OSError for what is no folder.
    """
    if fcntl is None:
        yield
        return
    descriptor = _held(directory, time.monotonic() + (WAIT if wait is None else wait))
    try:
        yield
    finally:
        os.close(descriptor)


def _held(directory: Path, until: float) -> int:
    while True:
        descriptor = os.open(directory, os.O_RDONLY)
        try:
            if _taken(descriptor):
                here, found = os.fstat(descriptor), directory.stat()
                if (here.st_dev, here.st_ino) == (found.st_dev, found.st_ino):
                    return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)
        if time.monotonic() > until:
            raise OutputError(
                f"another process of liegen is writing to {directory}; nothing was changed. "
                "Run this one again when that has ended"
            )
        time.sleep(0.02)


def _taken(descriptor: int) -> bool:
    assert fcntl is not None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in _BUSY  # a file system without locks: as if it were free
    return True


# --- doing ------------------------------------------------------------------------------------------------


def apply(directory: Path, files: Mapping[str, str], changes: Changes) -> None:
    """Make the changes, all or none; the folder must be locked.

    Raises OSError with nothing changed, and NotUndoneError where a part could not be put back.
    """
    stage = Path(tempfile.mkdtemp(prefix=PREFIX, dir=directory))
    begun = False
    try:
        _staged(directory, stage, files, changes)
        begun = True
        _moved(directory, stage, changes)
        (stage / JOURNAL).unlink()
    except BaseException as error:
        problems = _undone(directory, stage, changes) if begun and _there(stage / JOURNAL) else []
        if problems:
            raise NotUndoneError(f"{why(error)}; {'; '.join(problems[:3])}") from error
        _swept(stage)
        raise
    _swept(stage)


def why(error: BaseException) -> str:
    """What the system says of a failed call, and of which file; the stage is nothing to the user."""
    if not isinstance(error, OSError) or not error.strerror:
        return str(error) or type(error).__name__
    name = str(error.filename2 or error.filename or "")
    left_out = not name or PREFIX in name or len(name) > _LONGEST_NAME
    return error.strerror if left_out else f"{error.strerror}: {name}"


def _folders(changes: Changes) -> list[str]:
    return sorted({path.rpartition("/")[0] for path in (*changes.fresh, *changes.removed)} - {""})


def _staged(directory: Path, stage: Path, files: Mapping[str, str], changes: Changes) -> None:
    for folder in ("", *_folders(changes)):
        (stage / NEW / folder).mkdir(parents=True, exist_ok=True)
        (stage / OLD / folder).mkdir(parents=True, exist_ok=True)
    for path in changes.fresh:
        (stage / NEW / path).write_bytes(files[path].encode())
    for path in changes.had:
        _kept(directory / path, stage / OLD / path)
    (stage / PART).write_bytes(json.dumps({"format": FORMAT, **asdict(changes)}).encode())
    (stage / PART).replace(stage / JOURNAL)


def _kept(place: Path, backup: Path) -> None:
    """A second name for a file, or a copy; a link is kept as the link that it is."""
    try:
        os.link(place, backup, follow_symlinks=False)
    except OSError:
        if not (place.is_symlink() or place.is_file()):
            raise
        shutil.copy2(place, backup, follow_symlinks=False)


def _moved(directory: Path, stage: Path, changes: Changes) -> None:
    for folder in changes.made:
        (directory / folder).mkdir()
    for path in changes.removed:
        (directory / path).unlink()
    for path in changes.fresh:
        (stage / NEW / path).replace(directory / path)
    for folder in {path.rpartition("/")[0] for path in changes.removed} - {""}:
        _remove_empty(directory / folder)


# --- undoing ----------------------------------------------------------------------------------------------


def recovered(directory: Path) -> tuple[str, ...]:
    """Undo what dead processes left half done in a locked folder, and remove their stages: their names.

    Raises OutputError where that fails.
    """
    stages = _stages(directory)
    for stage in stages:
        problems: list[str] = []
        try:
            changes = _journal(stage)
            problems = _undone(directory, stage, changes) if changes else []
        except (OSError, ValueError, RecursionError) as error:
            problems = [why(error)]
        if not problems:
            problems = _swept(stage)
        if problems:
            raise OutputError(
                f"a run of liegen was killed while it wrote to {directory}; what it changed cannot be "
                f"put back: {'; '.join(problems[:3])}. Mend that and run liegen again, or remove {stage}"
            )
    return tuple(stage.name for stage in stages)


def left_behind(directory: Path) -> bool:
    """Whether there is a stage: of a process that writes now, or of a dead one."""
    return bool(_stages(directory))


def _stages(directory: Path) -> list[Path]:
    try:
        return sorted(path for path in directory.iterdir() if _STAGE.fullmatch(path.name) and _is_stage(path))
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return []


def _is_stage(path: Path) -> bool:
    """Whether a folder holds nothing but what a stage does; a user's own may have such a name."""
    names = {JOURNAL, PART, NEW, OLD}
    return stat.S_ISDIR(path.lstat().st_mode) and {p.name for p in path.iterdir()} <= names


def _journal(stage: Path) -> Changes | None:
    """None where the process died before it changed anything. Raises ValueError for what is no journal."""
    try:
        content: Any = json.loads((stage / JOURNAL).read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise ValueError("another version of liegen wrote it")
        parts = {name: tuple(map(str, content[name])) for name in ("fresh", "removed", "had", "made")}
    except FileNotFoundError:
        return None
    except (KeyError, TypeError) as error:
        raise ValueError(f"{stage / JOURNAL} is no journal ({error})") from None
    changes = Changes(**parts)
    names = (*changes.fresh, *changes.removed, *changes.had)
    if not all(inside(name) or _plain(name) for name in names) or not all(map(_plain, changes.made)):
        raise ValueError(f"{stage / JOURNAL} names files outside of {stage.parent}")
    return changes


def _plain(name: str) -> bool:
    return PurePosixPath(name).parts == (name,) and name not in ("..", "/") and "\\" not in name


def _undone(directory: Path, stage: Path, changes: Changes) -> list[str]:
    """Put everything back; what could not be, as text. What is undone already stays as it is."""
    problems: list[str] = []
    for path in (*reversed(changes.fresh), *changes.removed):
        place, old = directory / path, stage / OLD / path
        try:
            if not _there(stage / NEW / path) and not (path in changes.removed and _there(place)):
                _put_back(place, old, path in changes.had)
        except OSError as error:
            problems.append(f"{path}: {error.strerror or error}")
    for folder in reversed(changes.made):
        try:
            if _there(directory / folder):
                _remove_empty(directory / folder)
        except OSError as error:
            problems.append(f"{folder}: {error.strerror or error}")
    return problems


def _remove_empty(folder: Path) -> None:
    try:
        folder.rmdir()
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise


def _put_back(place: Path, old: Path, had: bool) -> None:
    """A file that was moved or removed. Where there is no backup any more, it was put back before."""
    if place.parent.is_symlink():
        raise OSError(errno.ELOOP, f"{place.parent.name} is a link")
    if not had:
        place.unlink(missing_ok=True)
    elif _there(old):
        place.parent.mkdir(exist_ok=True)
        old.replace(place)


def _there(path: Path) -> bool:
    """Whether there is something, be it a link to nothing. Raises OSError where that cannot be told."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def _swept(stage: Path) -> list[str]:
    """Remove a stage, its journal first; what is left of it, the next run removes."""
    try:
        (stage / JOURNAL).unlink(missing_ok=True)
        shutil.rmtree(stage)
    except OSError as error:
        return [f"{stage.name}: {error.strerror or error}"]
    return []
