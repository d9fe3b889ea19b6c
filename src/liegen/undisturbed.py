"""What a user's code does to the process is put back.

A file of factors may change the folder, close or replace the output, set variables of the environment, shadow
builtins, empty ``sys.path``, ignore Ctrl-C. None of that may reach what liegen does afterwards. What the code
adds (modules, folders to import from) stays: its factors may need it later.
"""

from __future__ import annotations

import builtins
import os
import signal
import sys
import warnings
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from liegen.errors import SourceError
from liegen.exits import no_exit

_STREAMS = ("stdin", "stdout", "stderr")
_SIGNALS = ("SIGINT", "SIGTERM", "SIGPIPE", "SIGHUP")


@contextmanager
def undisturbed() -> Generator[None]:
    """Run a user's code, whose prints go to standard error, and put the process back afterwards.

    Raises SourceError where the code removed the current folder.
    """
    with (
        _folder(),
        _descriptors(),
        _streams(),
        _interpreter(),
        _environment(),
        _signals(),
        warnings.catch_warnings(),
        np.errstate(),
        no_exit(),
    ):
        yield


@contextmanager
def _folder() -> Generator[None]:
    folder = Path.cwd()
    try:
        yield
    finally:
        try:
            os.chdir(folder)
        except OSError as error:
            raise SourceError(
                f"the code of the factors removed the current folder {folder} ({error.strerror})"
            ) from None


@contextmanager
def _descriptors() -> Generator[None]:
    """The three files that every process has open, whatever is closed or put in their place."""
    kept: dict[int, int] = {}
    for number in range(len(_STREAMS)):
        with suppress(OSError):  # it was closed before
            kept[number] = os.dup(number)
    try:
        yield
    finally:
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)


@contextmanager
def _streams() -> Generator[None]:
    """What the code prints is no result: it goes to standard error, which leaves JSON whole."""
    streams = {name: getattr(sys, name) for name in _STREAMS}
    sys.stdout = sys.stderr
    try:
        yield
    finally:
        for number, (name, stream) in enumerate(streams.items()):
            setattr(sys, name, _reopened(number, name, stream))


def _reopened(number: int, name: str, stream: TextIO | None) -> TextIO | None:
    """The stream, opened anew where the user's code closed it; the file descriptor is still open."""
    if stream is None or not stream.closed:
        return stream
    return os.fdopen(number, "r" if name == "stdin" else "w", closefd=False)


@contextmanager
def _interpreter() -> Generator[None]:
    names, modules = dict(builtins.__dict__), dict(sys.modules)
    searched: tuple[list[Any], ...] = (sys.path, sys.meta_path, sys.path_hooks)
    lists = [(entries, list(entries)) for entries in searched]
    depth, tracer, profiler = sys.getrecursionlimit(), sys.gettrace(), sys.getprofile()
    try:
        yield
    finally:
        builtins.__dict__.update(names)
        for name, module in modules.items():
            if sys.modules.get(name) is None:
                sys.modules[name] = module
        for now, before in lists:
            now += [entry for entry in before if entry not in now]
        sys.setrecursionlimit(depth)
        sys.settrace(tracer)
        sys.setprofile(profiler)


@contextmanager
def _environment() -> Generator[None]:
    variables, mask = dict(os.environ), os.umask(0)
    os.umask(mask)
    try:
        yield
    finally:
        os.umask(mask)
        if dict(os.environ) != variables:
            os.environ.clear()
            os.environ.update(variables)


@contextmanager
def _signals() -> Generator[None]:
    """Only the main thread may set handlers."""
    handlers = {n: signal.getsignal(getattr(signal, n)) for n in _SIGNALS if hasattr(signal, n)}
    try:
        yield
    finally:
        for name, handler in handlers.items():
            with suppress(ValueError, TypeError):
                signal.signal(getattr(signal, name), handler)
