"""A foreign function in a process of its own: it may crash, exit or hang, and liegen says so."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen import errors
from liegen.define import Function
from liegen.errors import LiegenError, ToolError
from liegen.subprocesses import OWN_GROUP, end_group, time_limit

from .calls import Foreign, Loaded, typed
from .returned import RaisedError
from .signature import signature
from .worker import FAILED, LOADED, RAISED, Request

Array = NDArray[np.float64]


@contextmanager
def separate(
    place: str, function: Function[..., Any], given: Mapping[str, str] | None = None
) -> Generator[Foreign]:
    """What is at ``place``, run in another process that ends with this block.

    Arguments and errors as :func:`liegen.foreign.foreign`. A call raises ToolError where the function ends
    the process, crashes, or takes longer than the time limit of all programs (LIEGEN_TOOL_SECONDS).
    """
    worker = _Worker(place, time_limit())
    try:
        kind, content = worker.ask(Request(place, signature(function), given or {}), "while it was loaded")
        if kind != LOADED:
            raise _error(content)
        stored, own = content
        yield typed(Loaded(worker.call, stored, own), function)
    finally:
        worker.end()


def _error(content: tuple[str, str]) -> LiegenError:
    name, text = content
    kind: type[LiegenError] = getattr(errors, name, ToolError)
    return kind(text)


class _Worker:
    """The process and the pipes to it."""

    def __init__(self, place: str, limit: float) -> None:
        self.place = place
        self.limit = limit
        self.late = False
        self.process = subprocess.Popen(
            [sys.executable, "-c", "from liegen.foreign.worker import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            process_group=OWN_GROUP,
        )

    def call(self, arguments: Sequence[Array]) -> tuple[Array, ...]:
        """The results at one sample."""
        shown = ", ".join(str(np.asarray(a).tolist()) for a in arguments)
        kind, content = self.ask([*arguments], f"at the arguments {shown}")
        if kind == RAISED:
            raise RaisedError(content)
        if kind == FAILED:
            raise _error(content)
        return tuple(content)

    def ask(self, request: object, when: str) -> tuple[str, Any]:
        """The answer to a request. Raises ToolError where the process ends or takes too long."""
        timer = threading.Timer(self.limit, self._too_late)
        timer.start()
        try:
            pickle.dump(request, self.process.stdin)  # type: ignore[arg-type]
            self.process.stdin.flush()  # type: ignore[union-attr]
            return pickle.load(self.process.stdout)  # type: ignore[arg-type]
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            raise ToolError(f"{self.place} {self._why()} {when}") from None
        finally:
            timer.cancel()

    def _too_late(self) -> None:
        self.late = True
        self.end()

    def _why(self) -> str:
        code = self.process.wait()
        if self.late:
            return f"did not return within {self.limit:g} s (LIEGEN_TOOL_SECONDS) and was stopped,"
        if code < 0:
            name = next((s.name for s in signal.Signals if s.value == -code), "no known one")
            return f"crashed (signal {-code}, {name})"
        return f"ended the process (exit code {code})"

    def end(self) -> None:
        """End the process and all that it started."""
        end_group(self.process)
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
