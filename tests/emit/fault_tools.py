"""Each call of the system that the writer makes, told one by one, so that a test can let any of them fail.

Python announces most of them to audit hooks before they happen;
writing is announced here.
"""

from __future__ import annotations

import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

#: Events that stand for a call which can fail; reading a folder is one too.
CALLS = (
    "open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.link", "os.symlink", "os.listdir",
    "os.scandir", "os.chmod", "os.utime", "tempfile.mkdtemp", "liegen.write", "fcntl.flock",
)  # fmt: skip

#: Gets the event, its path, and the second path of a call that has two.
Watch = Callable[[str, str, str], None]
TWO_PATHS = ("os.rename", "os.link", "os.symlink")

_watch: Watch | None = None
_installed = False


def _hook(event: str, arguments: tuple[object, ...]) -> None:
    if _watch is not None and event in CALLS:
        path, to = [*map(str, arguments[:2]), "", ""][:2]
        _watch(event, path, to if event in TWO_PATHS else "")


@contextmanager
def watched(watch: Watch, below: Path, patch: object) -> Iterator[None]:
    """Call ``watch`` before each call of the system on paths below a folder, while the block runs."""
    global _watch, _installed
    if not _installed:
        sys.addaudithook(_hook)  # for good: there is no way back
        _installed = True
    write_bytes = Path.write_bytes

    def halves(self: Path, data: bytes) -> int:
        write_bytes(self, data[: len(data) // 2])
        sys.audit("liegen.write", str(self))
        return write_bytes(self, data)

    def filtered(event: str, path: str, to: str) -> None:
        if path.startswith(str(below)) or event == "fcntl.flock":
            watch(event, path, to)

    with patch.context() as m:  # type: ignore[attr-defined]
        m.setattr(Path, "write_bytes", halves)
        _watch = filtered
        try:
            yield
        finally:
            _watch = None


class Counter:
    """Lets the calls from number ``first`` to ``last`` fail with an error; ``seen`` counts them all."""

    def __init__(self, first: int = -1, last: int = -1, code: int = 0) -> None:
        self.first, self.last, self.code, self.events = first, last, code, list[str]()

    @property
    def seen(self) -> int:
        return len(self.events)

    def __call__(self, event: str, path: str, to: str) -> None:
        self.events.append(event)
        if self.first <= self.seen <= self.last:
            raise OSError(self.code, os.strerror(self.code), path)


class Killer:
    """Kills this process at call number ``at``."""

    def __init__(self, at: int) -> None:
        self.at, self.seen = at, 0

    def __call__(self, event: str, path: str, to: str) -> None:
        self.seen += 1
        if self.seen == self.at:
            os.kill(os.getpid(), signal.SIGKILL)


def forked(action: Callable[[], object]) -> int:
    """Run it in a forked process: what ``os.waitpid`` says of it; 0 where it came to its end."""
    pid = os.fork()
    if pid:
        return os.waitpid(pid, 0)[1]
    try:
        action()
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        os._exit(1)
