"""The C compiler of this machine, where there is one."""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from pathlib import Path

from liegen.errors import ToolError

COMPILERS = ("cc", "gcc", "clang")


#: What tells one processor from another where ``-march=native`` decides, in /proc/cpuinfo.
_PROCESSOR = (
    "vendor_id", "cpu family", "model", "model name", "stepping", "flags",
    "Features", "CPU implementer", "CPU architecture", "CPU variant", "CPU part",
)  # fmt: skip


def find_compiler() -> tuple[str, ...]:
    """The command of a C compiler: ``$CC``, else cc, gcc or clang, else Zig's; empty where there is none.

    Zig's is ``zig cc``, or ``python -m ziglang cc`` where the package ziglang is installed.
    """
    named = tuple(shlex.split(os.environ.get("CC", "")))
    if named and shutil.which(named[0]):
        return named
    return next(((name,) for name in COMPILERS if shutil.which(name)), _zig())


def _zig() -> tuple[str, ...]:
    if shutil.which("zig"):
        return ("zig", "cc")
    return (sys.executable, "-m", "ziglang", "cc") if importlib.util.find_spec("ziglang") else ()


@cache
def compiler_version(command: tuple[str, ...]) -> str:
    """What the compiler says of itself; empty where it does not."""
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout


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
    command = [tool, "-n", "machdep.cpu.brand_string"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def cores() -> int:
    """How many processes this one may use at once."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def compile_shared(sources: Sequence[Path], library: Path, flags: Sequence[str]) -> None:
    """Compile C files, side by side on all cores, to one shared object; objects stay in its folder.

    Raises ToolError without a compiler, and with the compiler's own words where it refuses.
    """
    command = find_compiler()
    if not command:
        raise ToolError("no C compiler was found; install one, or name it in the environment variable CC")
    objects = [library.parent / f"{path.name}.o" for path in sources]
    jobs = [
        [*flags, "-fPIC", "-c", str(source), "-o", str(made)]
        for source, made in zip(sources, objects, strict=True)
    ]
    with ThreadPoolExecutor(cores()) as pool:
        list(pool.map(partial(_run, command), jobs))
    _run(command, [*flags, "-shared", "-o", str(library), *map(str, objects), "-lm"])


def _run(command: Sequence[str], arguments: Sequence[str]) -> None:
    done = subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise ToolError(
            f"{' '.join(command)} does not compile the C (set CC to use another compiler):\n"
            f"{done.stderr.strip()[:4000]}"
        )
