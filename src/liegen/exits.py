"""A user's code cannot end the process: what would do so raises SystemExit, which becomes a message."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, NoReturn

#: What ends a program without an exception.
_EXITS = ("_exit", "abort")


@contextmanager
def no_exit() -> Generator[None]:
    """While a user's code runs, ``os._exit`` and ``os.abort`` raise SystemExit."""
    ends: dict[str, Callable[..., Any]] = {name: getattr(os, name) for name in _EXITS}
    for name in _EXITS:
        setattr(os, name, _end)
    try:
        yield
    finally:
        for name, function in ends.items():
            setattr(os, name, function)


def _end(*_: object) -> NoReturn:
    raise SystemExit
