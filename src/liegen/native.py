"""The C compiler of this machine, where there is one."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from liegen.errors import ToolError

COMPILERS = ("cc", "gcc", "clang")


def find_compiler() -> tuple[str, ...]:
    """The command of a C compiler: ``$CC``, else cc, gcc or clang; empty where there is none."""
    named = tuple(shlex.split(os.environ.get("CC", "")))
    if named and shutil.which(named[0]):
        return named
    return next(((name,) for name in COMPILERS if shutil.which(name)), ())


def compile_shared(sources: Sequence[Path], library: Path, flags: Sequence[str]) -> None:
    """Compile C files to one shared object.

    Raises ToolError without a compiler, and with the compiler's own words where it refuses.
    """
    command = find_compiler()
    if not command:
        raise ToolError("no C compiler was found; install one, or name it in the environment variable CC")
    files = [str(path) for path in sources]
    done = subprocess.run(
        [*command, *flags, "-shared", "-fPIC", "-o", str(library), *files, "-lm"],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise ToolError(
            f"{' '.join(command)} does not compile the C (set CC to use another compiler):\n"
            f"{done.stderr.strip()[:4000]}"
        )
