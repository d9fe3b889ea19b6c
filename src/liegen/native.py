"""The C compiler of this machine, where there is one."""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from liegen.errors import ToolError


def find_compiler() -> tuple[str, ...] | None:
    """The command of a C compiler: ``$CC``, then cc, gcc, clang; None where there is none."""
    chosen = shlex.split(os.environ.get("CC", ""))
    candidates = [chosen] if chosen else [["cc"], ["gcc"], ["clang"]]
    return next((tuple(c) for c in candidates if shutil.which(c[0])), None)


def build_shared(sources: Mapping[str, str], folder: Path, flags: Sequence[str]) -> ctypes.CDLL:
    """Write ``{name: text}`` to ``folder``, compile every ``.c`` file to one shared object, and load it.

    Raises ToolError without a compiler, or with the compiler's message where it refuses.
    """
    compiler = find_compiler()
    if compiler is None:
        raise ToolError("no C compiler was found; install one, or name it in the environment variable CC")
    for name, text in sources.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    library = folder / "library.so"
    files = [str(folder / name) for name in sources if name.endswith(".c")]
    command = [*compiler, *flags, "-shared", "-fPIC", "-o", str(library), *files, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ToolError(f"the C compiler {compiler[0]} failed:\n{done.stderr.strip()}")
    return ctypes.CDLL(str(library))
