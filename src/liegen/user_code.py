"""Running a user's file: what the file changes of the process is put back, what it raises becomes one line.

A file of factors is a program: it may change the folder, close the output, end the process. Nothing of that
may reach what liegen does afterwards.
"""

from __future__ import annotations

import ast
import os
import sys
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TextIO

import numpy as np

from liegen.errors import LiegenError, Site, SourceError
from liegen.exits import no_exit
from liegen.text import exception_text
from liegen.trace import unknown_annotation

_STREAMS = ("stdin", "stdout", "stderr")


@contextmanager
def guarded(source: str, file: str) -> Generator[None]:
    """Run a user's code: undo its changes of the process, turn what it raises into one line.

    ``file`` is the absolute path of the code, ``source`` what the user calls it. Raises SourceError, or the
    error of liegen itself that was raised, with the file and the line.
    """
    with _undisturbed(), _clear_errors(source, file):
        yield


@contextmanager
def _undisturbed() -> Generator[None]:
    """The folder, the streams, the handling of warnings and of NumPy's errors are put back afterwards."""
    folder = Path.cwd()
    streams = {name: getattr(sys, name) for name in _STREAMS}
    depth = sys.getrecursionlimit()
    try:
        with warnings.catch_warnings(), np.errstate(), no_exit():
            yield
    finally:
        for number, (name, stream) in enumerate(streams.items()):
            setattr(sys, name, _reopened(number, name, stream))
        sys.setrecursionlimit(depth)
        os.chdir(folder)


def _reopened(number: int, name: str, stream: TextIO | None) -> TextIO | None:
    """The stream, opened anew where the user's code closed it; the file descriptor is still open."""
    if stream is None or not stream.closed:
        return stream
    return os.fdopen(number, "r" if name == "stdin" else "w", closefd=False)


@contextmanager
def _clear_errors(source: str, file: str) -> Generator[None]:
    """Turn whatever a user's file raises into one line that names the file and the line."""
    try:
        yield
    except KeyboardInterrupt:
        raise
    except LiegenError as error:
        site = _site(error.__traceback__, file)
        text = str(error)
        raise type(error)(text if site is None or f"{site.file}:" in text else f"{site}: {text}") from None
    except SyntaxError as error:
        where = Site(Path(error.filename or source).name, error.lineno or 0)
        line = f": {error.text.strip()}" if error.text else ""
        raise SourceError(f"{where}: syntax error ({error.msg}){line}") from None
    except BaseException as error:  # a user's file may raise anything
        site = _site(error.__traceback__, file)
        if isinstance(error, NameError) and site is not None:
            _refuse_annotation(error, site, file)
        raise SourceError(f"{site or source}: {in_one_line(error)}") from None


def in_one_line(error: BaseException) -> str:
    """An exception in one line, with a cure where there is a common one."""
    if isinstance(error, ModuleNotFoundError):
        return f"cannot import {error.name}; install it, or run liegen where it is installed"
    if isinstance(error, SystemExit):
        return 'it ends the program when imported; put that under if __name__ == "__main__":'
    return exception_text(error)


def _refuse_annotation(error: NameError, site: Site, file: str) -> None:
    """Name the factor and the argument when the unknown name is an annotation."""
    for node in ast.walk(ast.parse(Path(file).read_bytes())):
        if isinstance(node, ast.FunctionDef):
            for argument in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs):
                names = [n for n in ast.walk(argument) if isinstance(n, ast.Name) and n.id == error.name]
                if names and site.line in (node.lineno, argument.lineno):
                    raise unknown_annotation(site, node.name, argument.arg, str(error.name)) from None


def _site(traceback: TracebackType | None, file: str) -> Site | None:
    """The last line of the user's file that was being run."""
    site = None
    while traceback is not None:
        if traceback.tb_frame.f_code.co_filename == file:
            site = Site(_shown(Path(file)), traceback.tb_lineno)
        traceback = traceback.tb_next
    return site


def _shown(path: Path) -> str:
    return f"{path.parent.name}/{path.name}" if path.name == "__init__.py" else path.name
