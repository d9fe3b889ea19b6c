"""The command ``liegen``: its commands, and what becomes of errors."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from liegen import __version__
from liegen.errors import LiegenError
from liegen.text import printable

from .bench import bench
from .check import check
from .check_jacobian import check_jacobian
from .describe import explain, list_factors
from .generate import generate
from .verify import verify

#: Exit codes: 0 fine, 1 a check failed, and these.
WRONG_USE, INTERNAL = 2, 3
DEBUG = "LIEGEN_DEBUG"
_UNPRINTED = "cannot write to standard output"


class Refused(click.ClickException):
    """Wrong input: the message alone is enough."""

    exit_code = WRONG_USE


class Unprinted(click.ClickException):
    """Results that nobody can read; what the command did is done."""


class Internal(click.ClickException):
    """A mistake in liegen."""

    exit_code = INTERNAL


class App(click.Group):
    """Turns liegen's errors into exit code 2 and unexpected ones into 3, both without a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        debug = bool(ctx.params.get("debug") or os.environ.get(DEBUG))
        _need_folder()
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except BrokenPipeError:
            _close_output()
            raise click.exceptions.Exit(0) from None  # the reader, head for example, has seen enough
        except LiegenError as error:
            if debug:
                _show_causes(error)
                raise
            raise Refused(printable(error)) from None
        except KeyboardInterrupt:
            raise
        except (SystemExit, GeneratorExit) as error:  # of a user's code: liegen ends by click's Exit
            raise Refused(f"code of the factors ended the program ({type(error).__name__})") from None
        except BaseException as error:
            if isinstance(error, OSError) and _output_refuses(error):
                _close_output()
                raise Unprinted(f"{_UNPRINTED}: {error.strerror}") from None
            if debug:
                _show_causes(error)
                raise
            text = " ".join(f"{type(error).__name__}: {error}".split())
            again = f"liegen --debug {ctx.invoked_subcommand} ..."
            raise Internal(
                f"liegen itself failed: {printable(text)}\nSee the traceback with: {again}"
            ) from None


def _show_causes(error: BaseException) -> None:
    """Let the traceback show the user's own errors, which messages replace."""
    inner: BaseException | None = error
    while inner is not None:
        inner.__suppress_context__ = False
        inner = inner.__cause__ or inner.__context__


def _output_refuses(error: OSError) -> bool:
    """Whether an error is that of standard output, on a full disk for example: it names no file."""
    if error.filename is not None:
        return False
    try:
        sys.stdout.flush()
        os.write(sys.stdout.fileno(), b"\n")
    except OSError as again:
        return again.errno == error.errno
    return False


def _close_output() -> None:
    """What is left to print goes nowhere, so that the end of the process does not fail at it once more."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _need_folder() -> None:
    """Raise Refused where the current folder was removed: no relative path means anything there."""
    try:
        Path.cwd()
    except OSError:
        raise Refused("the current folder does not exist any more; change to another one") from None


@click.group(cls=App, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--debug", is_flag=True, help=f"Show tracebacks (also: {DEBUG}=1 in the environment).")
@click.version_option(__version__, prog_name="liegen")
def app(debug: bool) -> None:
    """Factors on Lie groups: derive their Jacobians, write NumPy and C, verify.

    SOURCE is a Python file or a dotted module with factors; without it, liegen's library.

    Exit codes: 0 fine, 1 a check failed, 2 wrong use, 3 internal error.
    """


for command in (list_factors, generate, verify, check, explain, check_jacobian, bench):
    app.add_command(command)


def main() -> None:
    """Run the command line of this process."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the shell; a file opened later must not take its number
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115
    try:
        app(prog_name="liegen")
    except OSError as error:  # before a command runs: of --help
        if not _output_refuses(error):
            raise
        _close_output()
        click.echo(f"Error: {_UNPRINTED}: {error.strerror}", err=True)
        sys.exit(1)
