"""From emitted C to a shared object that can be loaded: looked up in the cache, or compiled into it."""

from __future__ import annotations

import ctypes
import hashlib
import json
import shutil
import tempfile
import warnings
from pathlib import Path

from liegen.errors import CacheWarning, ToolError
from liegen.native import compile_shared, compiler_version, find_compiler, processor

from .cache import SUFFIX, Refused, cache_folder, find, install, opened, private_folder
from .source import Source

#: No libm call sets errno, no unused arm of a select traps.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math")
#: For this machine's processor; left out where a compiler does not know it.
NATIVE = ("-march=native",)


def cache_key(source: Source, command: tuple[str, ...]) -> str:
    """What decides on the machine code: the C, the compiler and its version, the flags, the processor."""
    parts = [dict(source.c), command, compiler_version(command), FLAGS, NATIVE, processor()]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:32]


def load(source: Source) -> ctypes.CDLL:
    """The compiled factor.

    Raises ToolError without a compiler, and where it fails: with its own words and the folder that keeps the
    source. Warns (CacheWarning) where the cache cannot be used; a private temporary folder then takes its
    place for the life of this process.
    """
    command = find_compiler()
    if not command:
        raise ToolError("no C compiler was found; install one, or name it in the environment variable CC")
    key = cache_key(source, command)
    try:
        folder = opened(cache_folder())
        return ctypes.CDLL(str(find(folder, key) or _built(source, folder, key)))
    except Refused as reason:
        refused = str(reason)
    except OSError as error:  # for example a file system without execution
        refused = f"cannot load from it: {error}"
    warnings.warn(f"compiled factors are not kept: {refused}", CacheWarning, stacklevel=4)
    try:
        folder = private_folder()
        return ctypes.CDLL(str(find(folder, key) or _built(source, folder, key)))
    except (OSError, Refused) as error:
        raise ToolError(f"{source.name}: the compiled factor cannot be kept or loaded: {error}") from error


def _built(source: Source, folder: Path, key: str) -> Path:
    """Compile outside of the cache, then move the result there."""
    work, keep = Path(tempfile.mkdtemp(prefix="liegen-build-")), False
    library = work / f"{source.name}{SUFFIX}"
    try:
        for name, text in source.c.items():
            (work / name).write_text(text, encoding="utf-8")
        sources = sorted(work.glob("*.c"))
        try:
            compile_shared(sources, library, (*FLAGS, *NATIVE))
        except ToolError:
            compile_shared(sources, library, FLAGS)
        return install(folder, key, library)
    except ToolError as error:
        keep = True
        raise ToolError(f"{source.name}: {error}\nthe C source is kept in {work}") from error
    finally:
        if not keep:
            shutil.rmtree(work, ignore_errors=True)
