"""The C compiler of this machine, where there is one."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import platform
import shlex
import shutil
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from .errors import ToolError
from .subprocesses import QUICK_LIMIT, Done, run, run_all, shortened, shown, time_limit

COMPILERS = ("cc", "gcc", "clang")

#: What tells one processor from another where ``-march=native`` decides, in /proc/cpuinfo.
_PROCESSOR = (
    "vendor_id", "cpu family", "model", "model name", "stepping", "flags",
    "Features", "CPU implementer", "CPU architecture", "CPU variant", "CPU part",
)  # fmt: skip


def find_compiler() -> tuple[str, ...]:
    """The command of a C compiler: ``$CC``, else cc, gcc or clang, else Zig's; empty where there is none.

    Zig's is ``zig cc``, or ``python -m ziglang cc`` where the package ziglang is installed. Raises ToolError
    where ``CC`` names no command.
    """
    named = named_command("CC")
    return named or next(((name,) for name in COMPILERS if shutil.which(name)), _zig())


def named_command(variable: str) -> tuple[str, ...]:
    """The command in an environment variable, empty where it is unset or blank.

    Raises ToolError for one that cannot be split into words, or whose first word is no program.
    """
    text = os.environ.get(variable, "")
    cure = f"correct {variable}, or unset it to let liegen look for a compiler"
    try:
        words = tuple(shlex.split(text))
    except ValueError as error:
        raise ToolError(f"{variable}={shortened(text, 100)}: {error}; {cure}") from None
    if words and not shutil.which(words[0]):
        raise ToolError(f"{variable}={shortened(text, 100)}: no program of that name was found; {cure}")
    return words


def required_compiler() -> tuple[str, ...]:
    """As :func:`find_compiler`; raises ToolError where there is none."""
    command = find_compiler()
    if not command:
        raise ToolError("no C compiler was found; install one, or name it in the environment variable CC")
    return command


def _zig() -> tuple[str, ...]:
    if shutil.which("zig"):
        return ("zig", "cc")
    return (sys.executable, "-m", "ziglang", "cc") if importlib.util.find_spec("ziglang") else ()


@cache
def compiler_version(command: tuple[str, ...]) -> str:
    """What the compiler says of itself; empty where it says nothing. Raises ToolError where it hangs."""
    return run([*command, "--version"], limit=min(QUICK_LIMIT, time_limit())).out


@cache
def processor() -> str:
    """What tells this machine's processor from others: code made for one may not run on another."""
    try:
        first = Path("/proc/cpuinfo").read_text(encoding="utf-8").split("\n\n")[0]
    except OSError:
        return f"{platform.machine()} {_brand() or platform.processor()}"
    lines = [line.split(":", 1) for line in first.splitlines() if ":" in line]
    known = [f"{key.strip()}:{value.strip()}" for key, value in lines if key.strip() in _PROCESSOR]
    return "\n".join([platform.machine(), *known])


def _brand() -> str:
    """The name of a processor on macOS."""
    tool = shutil.which("sysctl")
    if not tool:
        return ""
    return run([tool, "-n", "machdep.cpu.brand_string"], limit=QUICK_LIMIT).out.strip()


def cores() -> int:
    """How many processes this one may use at once."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def compile_shared(sources: Sequence[Path], library: Path, flags: Sequence[str], *, what: str = "") -> None:
    """Compile C files, side by side on all cores, to one shared object; objects stay in its folder.

    A terminal is told ``what`` takes longer than 2 s, by default the library's name. The compiler's temporary
    files stand in that folder too. Raises ToolError without a compiler, with its own words where it refuses,
    where it runs too long, and where it leaves no shared object.
    """
    command, what = required_compiler(), what or f"compiling {library.stem}"
    objects = [library.parent / f"{path.name}.o" for path in sources]
    jobs = [
        [*command, *flags, "-fPIC", "-c", str(source), "-o", str(made)]
        for source, made in zip(sources, objects, strict=True)
    ]
    env = {"TMPDIR": str(library.parent)}
    for done in run_all(jobs, what=what, at_once=cores(), env=env):
        _check(command, done)
    _check_made(command, objects)
    linked = [*command, *flags, "-shared", "-o", str(library), *map(str, objects), "-lm"]
    _check(command, run(linked, what=what, env=env))
    _check_made(command, [library])


def load_shared(library: Path) -> ctypes.CDLL:
    """A shared object that :func:`compile_shared` made. Raises ToolError where the system cannot load it."""
    try:
        return ctypes.CDLL(str(library))
    except OSError as error:
        raise ToolError(
            f"{shown(required_compiler())} made a shared object that cannot be loaded "
            f"({shortened(str(error))}); set CC to a compiler for this machine"
        ) from error


def _check(command: Sequence[str], done: Done) -> None:
    if done.failed:
        raise ToolError(
            f"{shown(command)} does not compile the C: {done.reason} (set CC to use another compiler)"
        )


def _check_made(command: Sequence[str], files: Sequence[Path]) -> None:
    for file in files:
        if not file.is_file() or not file.stat().st_size:
            raise ToolError(
                f"{shown(command)} reports no error but writes nothing, so it is no C compiler; set CC to one"
            )
