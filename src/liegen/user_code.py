"""Running a user's file: what it changes of the process is put back, what it raises becomes one line."""

from __future__ import annotations

import ast
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from liegen.advice import for_exception
from liegen.errors import LiegenError, Site, SourceError
from liegen.manifolds.node import site_at, user_steps
from liegen.text import exception_text
from liegen.trace import unknown_annotation
from liegen.undisturbed import undisturbed


@contextmanager
def guarded(source: str, file: str) -> Generator[None]:
    """Run a user's code: undo its changes of the process, turn what it raises into one line.

    ``file`` is the absolute path of the code, ``source`` what the user calls it. Raises SourceError, or the
    error of liegen itself that was raised, with the file and the line.
    """
    with _clear_errors(source, file), undisturbed():
        yield


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
        steps = user_steps(error)
        cure = for_exception(error, steps[-1] if steps else None)
        text = f"{in_one_line(error)}; write {cure}" if cure else in_one_line(error)
        raised = steps[-1] if steps else None
        inner = raised.tb_frame.f_code.co_filename if raised else file
        helper = raised and inner != file and Path(inner).is_relative_to(Path(file).parent)
        where = f" (raised at {site_at(raised)})" if raised and helper else ""
        raise SourceError(f"{site or source}: {text}{where}") from None


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
