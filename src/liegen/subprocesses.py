"""Other programs (compilers) run here: each with a time limit, in a process group that ends with this one."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from .errors import ToolError
from .text import one_line

#: Seconds that a program may run; the environment variable names another number.
LIMIT, LIMIT_VARIABLE = 600.0, "LIEGEN_TOOL_SECONDS"
#: Seconds for a question that any compiler answers at once, such as its version.
QUICK_LIMIT = 20.0
#: Seconds after which a terminal is told what is waited for.
NOTICE = 2.0
#: Bytes that a program may print.
MOST_OUTPUT = 32 << 20
_PAUSE = 0.005
#: ``process_group`` of a program that is ended with all that it starts.
OWN_GROUP = 0 if os.name == "posix" else -1


class TimeLimitError(ToolError):
    """A program ran longer than it may, and was stopped."""


@dataclass(frozen=True)
class Done:
    """What became of a program: its exit code (negative: the signal that ended it) and what it printed."""

    command: tuple[str, ...]
    code: int
    out: str
    err: str

    @property
    def failed(self) -> bool:
        """Whether it says so, or was ended by a signal."""
        return self.code != 0

    @property
    def reason(self) -> str:
        """One line: its first line that speaks of an error, else its first line, else its exit code."""
        lines = [line.strip() for line in f"{self.err}\n{self.out}".splitlines() if line.strip()]
        told = next((line for line in lines if "error" in line.lower()), lines[0] if lines else "")
        ended = f"ended by signal {-self.code}" if self.code < 0 else f"exit code {self.code}"
        return shortened(told) if told else f"{ended}, and it printed nothing"


@dataclass
class _Running:
    command: tuple[str, ...]
    process: subprocess.Popen[bytes]
    out: IO[bytes]
    err: IO[bytes]
    start: float


def shortened(text: str, limit: int = 400) -> str:
    """A line that a terminal may show: without control characters, and not longer than the limit."""
    line = one_line(" ".join(text[: 4 * limit].split()))
    return line if len(line) <= limit else f"{line[:limit]} ..."


def shown(command: Sequence[str]) -> str:
    """A command as it is typed, in one line of a terminal."""
    return shortened(shlex.join(command), 200)


def time_limit() -> float:
    """Seconds that a program may run. Raises ToolError where the environment names no such number."""
    text = os.environ.get(LIMIT_VARIABLE, "")
    if not text:
        return LIMIT
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 0.0 < seconds < float("inf"):
        raise ToolError(
            f"{LIMIT_VARIABLE}={shortened(text, 60)} is no number of seconds above 0; correct it or unset it"
        )
    return seconds


def run(
    command: Sequence[str],
    *,
    what: str = "",
    limit: float | None = None,
    cwd: Path | None = None,
    env: Mapping[str, str] | None = None,
) -> Done:
    """Run one program; see :func:`run_all`."""
    return run_all([command], what=what, limit=limit, cwd=cwd, env=env)[0]


def run_all(
    commands: Sequence[Sequence[str]],
    *,
    what: str = "",
    at_once: int = 1,
    limit: float | None = None,
    cwd: Path | None = None,
    env: Mapping[str, str] | None = None,
) -> tuple[Done, ...]:
    """Run programs, some at once, and wait for all; after the first that fails no more are started.

    ``what`` is told on a terminal when it takes longer than 2 s ("compiling between_se3"). They read nothing,
    and what they print is decoded whatever it is. An exception, Ctrl-C among them, ends them all with
    everything that they started. Raises ToolError for a program that cannot be started or prints without
    end, TimeLimitError where it runs longer than ``limit`` (by default 600 s, or LIEGEN_TOOL_SECONDS).
    """
    seconds = time_limit() if limit is None else limit
    waiting = list(enumerate(tuple(command) for command in commands))
    running: dict[int, _Running] = {}
    done: dict[int, Done] = {}
    told, start = not what, time.monotonic()
    with ExitStack() as files:
        try:
            while running or waiting:
                while waiting and len(running) < max(1, at_once):
                    place, command = waiting.pop(0)
                    running[place] = _started(command, files, cwd, env)
                for place, job in list(running.items()):
                    if job.process.poll() is None:
                        _check(job, seconds, fixed=limit is not None)
                        continue
                    del running[place]
                    end_group(job.process)  # what it left behind
                    done[place] = _done(job)
                    if done[place].failed:
                        waiting.clear()
                passed = time.monotonic() - start
                if not told and passed > NOTICE:
                    told = True
                    _tell(f"{what} ...")
                if running:
                    time.sleep(min(20 * _PAUSE, max(_PAUSE, passed / 20)))
        finally:
            for job in running.values():
                end_group(job.process)
                job.process.wait()
    return tuple(done[place] for place in sorted(done))


def _started(
    command: tuple[str, ...], files: ExitStack, cwd: Path | None, env: Mapping[str, str] | None
) -> _Running:
    try:
        out = files.enter_context(tempfile.TemporaryFile())  # noqa: SIM115
        err = files.enter_context(tempfile.TemporaryFile())  # noqa: SIM115
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=cwd,
            env=None if env is None else {**os.environ, **env},
            process_group=OWN_GROUP,
        )  # fmt: skip
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ToolError(f"{shown(command)} cannot be run: {shortened(reason)}") from error
    return _Running(command, process, out, err, time.monotonic())


def _check(job: _Running, seconds: float, *, fixed: bool) -> None:
    if time.monotonic() - job.start > seconds:
        raise TimeLimitError(
            f"{shown(job.command)} did not end within {seconds:g} s and was stopped; set "
            + ("" if fixed else f"{LIMIT_VARIABLE} to give it more time, or ")
            + "CC to use another compiler"
        )
    if max(os.fstat(file.fileno()).st_size for file in (job.out, job.err)) > MOST_OUTPUT:
        raise ToolError(
            f"{shown(job.command)} printed more than {MOST_OUTPUT >> 20} MiB and was stopped; "
            "set CC to use another compiler"
        )


def end_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a program that was started with ``OWN_GROUP``, and all that it started and left in its group."""
    if os.name == "posix":
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    elif process.poll() is None:
        process.kill()


def _done(job: _Running) -> Done:
    texts: list[str] = []
    for file in (job.out, job.err):
        file.seek(0)
        texts.append(file.read(MOST_OUTPUT).decode(errors="replace"))
    return Done(job.command, job.process.returncode, texts[0], texts[1])


def _tell(line: str) -> None:
    """For people who wait in front of a terminal; where standard error goes to a file it stays silent."""
    stream = sys.stderr
    with suppress(Exception):  # closed, or replaced by the caller's program
        if stream.isatty():
            stream.write(f"{shortened(line)}\n")
            stream.flush()
