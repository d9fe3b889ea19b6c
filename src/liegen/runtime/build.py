"""From emitted C to a shared object that can be loaded: looked up in the cache, or compiled into it."""

from __future__ import annotations

import ctypes
import hashlib
import json
import shutil
from contextlib import suppress
from pathlib import Path

from liegen.emit.loops import symbol
from liegen.errors import CacheWarning, ToolError, warned
from liegen.native import compile_shared, compiler_version, processor, required_compiler
from liegen.subprocesses import TimeLimitError, shortened, shown
from liegen.temporary import temporary_folder

from .cache import SUFFIX, Refused, cache_folder, find, install, opened, private_folder
from .source import PACKAGE, Source

#: a * b + c may be rounded once; no call of libm sets errno, no unused arm of a select traps.
FLAGS = ("-std=c99", "-O3", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math")
#: For this machine's processor; left out where a compiler does not know it.
NATIVE = ("-march=native",)
#: Names of the folders where C is compiled; they go on with the number of the process.
WORK, KEPT = "liegen-build-", "liegen-failed-"


def cache_key(source: Source, part: str, command: tuple[str, ...]) -> str:
    """What decides on the machine code: the C, the compiler and its version, the flags, the processor."""
    parts = [dict(source.c[part]), command, compiler_version(command), FLAGS, NATIVE, processor()]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:32]


def load(source: Source, part: str) -> ctypes.CDLL:
    """A part of a factor, compiled.

    Raises ToolError without a compiler, and where it fails: with its own words and the folder that keeps the
    source. Warns (CacheWarning) where the cache cannot be used; a private temporary folder then takes its
    place for the life of this process.
    """
    command = required_compiler()
    key = cache_key(source, part, command)
    try:
        return _loaded(source, part, opened(cache_folder()), key)
    except Refused as reason:
        refused = shortened(str(reason))
    except OSError as error:  # for example a file system without execution
        refused = shortened(f"cannot load from it: {error}")
    try:
        library = _loaded(source, part, private_folder(), key)
    except (OSError, Refused) as error:
        raise ToolError(
            f"{source.name}: what {shown(command)} made can neither be kept nor loaded: {refused}; "
            f"{shortened(str(error))}. "
            "Set CC to a compiler for this machine, TMPDIR to a folder with room"
        ) from error
    warned(f"compiled factors are not kept: {refused}", CacheWarning)
    return library


def _loaded(source: Source, part: str, folder: Path, key: str) -> ctypes.CDLL:
    """The entry of a key where it can be loaded and is that factor, else a new one."""
    entry = find(folder, key)
    library = _opened(source, part, entry) if entry else None
    if library is None:
        if entry:
            with suppress(OSError):
                entry.unlink()
        library = _opened(source, part, _built(source, part, folder, key))
    if library is None:
        raise ToolError(f"{source.name}: {shown(required_compiler())} made a library without its functions")
    return library


def _opened(source: Source, part: str, entry: Path) -> ctypes.CDLL | None:
    """The library, None where it has not the functions of the factor."""
    library = ctypes.CDLL(str(entry))
    symbols = (symbol(source.name, method.name, PACKAGE) for method in source.offered(part))
    return library if all(hasattr(library, name) for name in symbols) else None


def _built(source: Source, part: str, folder: Path, key: str) -> Path:
    """Compile outside of the cache, then move the result there. Raises Refused where there is no room."""
    try:
        work, keep = temporary_folder(WORK), False
    except OSError as error:
        raise Refused(f"no temporary folder can be made: {error.strerror or error}") from error
    library, what = work / f"{source.name}{SUFFIX}", f"compiling {source.name} ({part})"
    try:
        for name, text in source.c[part].items():
            (work / name).write_text(text, encoding="utf-8")
        sources = sorted(work.glob("*.c"))
        try:
            compile_shared(sources, library, (*FLAGS, *NATIVE), what=what)
        except TimeLimitError:
            raise
        except ToolError:
            compile_shared(sources, library, FLAGS, what=what)
        return install(folder, key, library)
    except OSError as error:
        raise Refused(f"cannot write to {work}: {error.strerror}") from error
    except ToolError as error:
        keep = True
        raise ToolError(f"{source.name}: {error}\nthe C source is kept in {_kept(work)}") from error
    finally:
        if not keep:
            shutil.rmtree(work, ignore_errors=True)


def _kept(work: Path) -> Path:
    """The folder under a name that no later process sweeps."""
    with suppress(OSError):
        return work.rename(work.with_name(work.name.replace(WORK, KEPT, 1)))
    return work
