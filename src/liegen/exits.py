"""A user's code cannot end the process: what would do so raises SystemExit, which becomes a message."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

#: What ends a program without an exception, or puts another one in its place.
_EXITS = ("_exit", "abort", "execv", "execve")


@contextmanager
def no_exit() -> Generator[None]:
    """While a user's code runs, what ends this process raises SystemExit; child processes may end."""
    ends: dict[str, Callable[..., Any]] = {name: getattr(os, name) for name in _EXITS if hasattr(os, name)}
    process = os.getpid()
    for name, function in ends.items():
        setattr(os, name, _in_children(process, function))
    try:
        yield
    finally:
        for name, function in ends.items():
            setattr(os, name, function)


def _in_children(process: int, function: Callable[..., Any]) -> Callable[..., Any]:
    def end(*arguments: Any) -> Any:
        if os.getpid() == process:
            raise SystemExit
        return function(*arguments)

    return end
