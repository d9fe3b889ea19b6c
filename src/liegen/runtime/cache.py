"""The folder of compiled factors: only its owner can write there, and what is loaded is checked first.

An entry is one file, ``KEY-DIGEST.so``: the key says what it was made from, the digest (SHA-256) what it
holds for that key. A file gets its name when it is complete, so that no process sees a part of it.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

from liegen.subprocesses import shortened
from liegen.temporary import OLD, temporary_folder

#: The part of the cache that this layout of entries has for itself.
FOLDER = "compiled-1"
#: Beginnings of temporary names.
PART, PRIVATE = ".part-", "liegen-private-"
SUFFIX = ".dll" if sys.platform == "win32" else ".so"


class Refused(Exception):  # noqa: N818 (no error of the user's: something else is used instead)
    """A folder or file that cannot be used; the message is the reason."""


def cache_folder() -> Path:
    r"""Where compiled factors are kept.

    ``$LIEGEN_CACHE_DIR``, else ``$XDG_CACHE_HOME/liegen``, else the system's: ``~/.cache/liegen``, on macOS
    ``~/Library/Caches/liegen``, on Windows ``%LOCALAPPDATA%\liegen``. Raises Refused without a home.
    """
    named = os.environ.get("LIEGEN_CACHE_DIR", "")
    base = os.environ.get("XDG_CACHE_HOME", "")
    try:
        if named:
            return Path(named).expanduser().absolute() / FOLDER
        root = Path(base) if Path(base).is_absolute() else _system_folder()
    except RuntimeError as error:
        raise Refused(str(error)) from error
    return root / "liegen" / FOLDER


def _system_folder() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", "") or Path.home() / "AppData" / "Local")
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")


def opened(folder: Path) -> Path:
    """The folder, made where need be. Raises Refused where it cannot be made, or others can write there."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        status = folder.lstat()
        parents = [(parent, parent.stat()) for parent in folder.resolve().parents]
    except OSError as error:
        raise Refused(f"cannot make the folder {shortened(str(folder), 200)}: {error.strerror}") from error
    if not stat.S_ISDIR(status.st_mode):
        raise Refused(f"{folder} is a link or a file, not a folder; remove it")
    if os.name == "posix":
        _check_owner(folder, status)
        for parent, found in parents:
            _check_parent(parent, found)
    return folder


def _check_owner(path: Path, status: os.stat_result) -> None:
    if status.st_uid != os.getuid():
        raise Refused(f"{path} belongs to another user (number {status.st_uid})")
    if status.st_mode & 0o077:
        raise Refused(
            f"{path} is open to other users (mode {stat.S_IMODE(status.st_mode):o}); chmod 700 {path}"
        )


def _check_parent(path: Path, status: os.stat_result) -> None:
    """Who can rename a parent can put another folder in its place."""
    if status.st_uid not in (0, os.getuid()):
        raise Refused(f"{path} belongs to another user (number {status.st_uid})")
    if status.st_mode & 0o002 and not status.st_mode & stat.S_ISVTX:
        raise Refused(f"all users can write to {path}; chmod o-w {path}")


@cache
def private_folder() -> Path:
    """A new temporary folder that only this user can open, removed when the process ends.

    Raises OSError where none can be made.
    """
    owner, folder = os.getpid(), temporary_folder(PRIVATE)

    def remove() -> None:
        if os.getpid() == owner:  # a forked child shares it
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    return folder


def entry_name(key: str, content: bytes) -> str:
    """What a file is called that was made for a key, without its suffix."""
    return f"{key}-{hashlib.sha256(key.encode() + content).hexdigest()}"


def find(folder: Path, key: str) -> Path | None:
    """The complete entry of a key. Entries whose contents are not what their name says are removed."""
    for path in sorted(folder.glob(f"{key}-*{SUFFIX}")):
        if _trusted(path):
            return path
        with suppress(OSError):
            path.unlink()
    return None


def _trusted(path: Path) -> bool:
    """Whether a file is a plain one of this user and holds what its name says."""
    try:
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # of a pipe
        with os.fdopen(os.open(path, flags | getattr(os, "O_BINARY", 0)), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                return False
            if os.name == "posix" and (status.st_uid != os.getuid() or status.st_mode & 0o022):
                return False
            return path.stem == entry_name(path.stem.partition("-")[0], file.read())
    except OSError:
        return False


def install(folder: Path, key: str, library: Path) -> Path:
    """Copy a shared object into the folder in one step. Raises Refused where that fails."""
    part = ""
    try:
        content = library.read_bytes()
        target = folder / f"{entry_name(key, content)}{SUFFIX}"
        for left in folder.glob(f"{PART}*"):
            with suppress(OSError):
                if time.time() - left.lstat().st_mtime > OLD:  # machines may share the folder
                    left.unlink()
        descriptor, part = tempfile.mkstemp(prefix=PART, dir=folder)
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        Path(part).replace(target)
    except OSError as error:
        if part:
            with suppress(OSError):
                Path(part).unlink(missing_ok=True)
        raise Refused(f"cannot write to {folder}: {error.strerror}") from error
    return target
