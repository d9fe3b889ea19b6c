"""Temporary folders that end with their process, or are removed by a later one where it was killed."""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import shutil
import stat
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from .errors import ToolError

#: Seconds after which a temporary file of another machine is no longer in use.
OLD = 3600.0
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)


def temporary_folder(prefix: str) -> Path:
    """A new folder that only this user can open; those of dead processes with this prefix are removed.

    Raises OSError where none can be made.
    """
    top = Path(tempfile.gettempdir())
    for path in top.glob(f"{prefix}*"):
        _sweep(path, *path.name.removeprefix(prefix).split("-")[:2])
    return Path(tempfile.mkdtemp(prefix=f"{prefix}{machine()}-{os.getpid()}-"))


@contextmanager
def working_folder(prefix: str) -> Generator[Path]:
    """A temporary folder for as long as the block runs. Raises ToolError where there is no room for files."""
    folder: Path | None = None
    try:
        folder = temporary_folder(prefix)
        yield folder
    except OSError as error:
        if folder and error.errno not in _NO_ROOM and not _below(folder, error.filename):
            raise
        raise ToolError(
            f"cannot write temporary files: {error.strerror or error}; "
            "make room, or name another folder in the environment variable TMPDIR"
        ) from error
    finally:
        if folder:
            shutil.rmtree(folder, ignore_errors=True)


def _below(folder: Path, name: object) -> bool:
    return isinstance(name, str) and Path(name).is_relative_to(folder)


@cache
def machine() -> str:
    """What tells this machine, or container, from others that count their processes too."""
    try:
        space = str(Path("/proc/self/ns/pid").readlink())
    except OSError:
        space = ""
    return hashlib.sha256(f"{platform.node()} {space}".encode()).hexdigest()[:8]


def _sweep(folder: Path, where: str, process: str = "") -> None:
    """Remove a folder of this user whose process is dead; one of another machine where it is old."""
    with suppress(OSError, ValueError, OverflowError):
        status = folder.lstat()
        ours = os.name == "posix" and stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
        here = where == machine()
        if ours and (not _lives(int(process)) if here else time.time() - status.st_mtime > OLD):
            shutil.rmtree(folder)


def _lives(process: int) -> bool:
    """Whether a process exists; one that cannot be asked does."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
