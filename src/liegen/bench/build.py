"""From a variant's text to a function in this process: each with its own flags, in a library of its own."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.emit.templates import lay_out
from liegen.native import compiler_version as native_version
from liegen.native import find_compiler, load_shared, named_command, required_compiler
from liegen.subprocesses import run

from .variant import AbsentError, Flags, Task, Variant, offsets

Array = NDArray[np.float64]
Run = Callable[[], None]
CPP_COMPILERS = ("c++", "g++", "clang++")
CPP_SUFFIX = ".cc"
#: A page of memory [bytes].
PAGE = 4096


@dataclass(frozen=True)
class Loaded:
    """A compiled variant: its driver calls it once for every row of the inputs."""

    library: ctypes.CDLL
    task: Task
    variant: Variant

    def run(self, inputs: Array, output: Array) -> Run:
        """Call it over all inputs, into the same rows of outputs again and again."""
        function = self.library["drive"]
        function.argtypes = [ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
        function.restype = None
        n, source, target = len(inputs), inputs.ctypes.data, output.ctypes.data
        return lambda: function(n, source, target)

    def buffer(self) -> Array:
        """Room for its outputs, a row a call, from the start of a page: where it lies must not decide."""
        shape = (self.variant.rows, sum(port.size for port in self.task.outputs))
        return aligned(shape[0] * shape[1], np.dtype(np.float64), PAGE).reshape(shape)

    def results(self, inputs: Array) -> Array:
        """All outputs by input, (inputs, outputs), row-major port after port."""
        buffer = self.buffer()
        found: list[Array] = []
        for k in range(len(inputs)):
            self.run(inputs[k : k + 1], buffer)()
            found.append(buffer[0].copy())
        return _row_major(self.task, np.array(found)) if self.variant.column_major else np.array(found)


def aligned(size: int, dtype: np.dtype[Any], boundary: int) -> NDArray[Any]:
    """An array of zeros that begins at a multiple of so many bytes."""
    room = np.zeros(size + boundary // dtype.itemsize, dtype)
    first = -room.ctypes.data % boundary // dtype.itemsize
    return room[first : first + size]


def _row_major(task: Task, found: Array) -> Array:
    parts: list[Array] = []
    for port, start in zip(task.outputs, offsets(task.outputs), strict=True):
        block = found[:, start : start + port.size]
        if len(port.shape) == 2:
            block = block.reshape(-1, *port.shape[::-1]).transpose(0, 2, 1).reshape(len(found), -1)
        parts.append(block)
    return np.concatenate(parts, axis=1)


def find_cpp_compiler() -> tuple[str, ...]:
    """The command of a C++ compiler: ``$CXX``, else c++, g++ or clang++; empty where there is none."""
    named = named_command("CXX")
    return named or next(((name,) for name in CPP_COMPILERS if shutil.which(name)), ())


def load(task: Task, variant: Variant, flags: Flags, folder: Path) -> Loaded:
    """Compile a variant and its driver in a folder of their own and load them.

    The flags are those of compilation only: linked with -ffast-math, a library would make the whole process
    flush denormal numbers to zero. Raises AbsentError with the compiler's first error.
    """
    folder.mkdir(parents=True, exist_ok=True)
    names = {"prototype": variant.prototype, "call": variant.call}
    sizes = {"inputs": sum(p.size for p in task.inputs), "outputs": sum(p.size for p in task.outputs)}
    text = lay_out(variant.driver, {**names, **sizes, "rows": variant.rows})
    sources = {**variant.sources, "driver.c": text}
    for name, content in sources.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content, encoding="utf-8")
    objects = [
        _object(folder, name, (*flags, *variant.options))
        for name in sources
        if name.endswith((".c", CPP_SUFFIX))
    ]
    link = find_cpp_compiler() if any(n.endswith(CPP_SUFFIX) for n in sources) else find_compiler()
    library = folder / "variant.so"
    _compiled([*link, "-shared", "-o", str(library), *map(str, objects), "-lm"])
    return Loaded(load_shared(library), task, variant)


def _object(folder: Path, name: str, flags: Sequence[str]) -> Path:
    cpp = name.endswith(CPP_SUFFIX)
    command = find_cpp_compiler() if cpp else find_compiler()
    if not command:
        raise AbsentError(f"no {'C++' if cpp else 'C'} compiler was found")
    target = folder / f"{name}.o"
    standard = ("-std=c++17",) if cpp else ()
    place = str(folder / name)
    _compiled([*command, *standard, *flags, "-fPIC", f"-I{folder}", "-c", "-o", str(target), place])
    return target


def _compiled(command: Sequence[str]) -> None:
    done = run(command, what="compiling for the benchmark")
    if done.failed:
        raise AbsentError(f"{Path(command[0]).name} refused it: {done.reason}")


def compiler_version() -> str:
    """The first line of ``cc --version``. Raises ToolError without a compiler."""
    command = required_compiler()
    return native_version(command).partition("\n")[0] or command[0]
