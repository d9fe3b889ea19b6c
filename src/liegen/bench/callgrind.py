"""Instructions of a call of every kernel, counted by valgrind: they do not depend on the clock.

They depend on the compiler, on its flags, on the C library (for sines) and, where a value is selected by a
branch, on the inputs, which are drawn from a fixed seed. All but these are written beside the counts.
"""

from __future__ import annotations

import json
import platform
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from liegen.emit import render
from liegen.emit.c_target import value_name
from liegen.emit.templates import lay_out
from liegen.errors import OutputError, ToolError
from liegen.native import required_compiler
from liegen.program import Program
from liegen.subprocesses import run, shown
from liegen.temporary import working_folder

from . import draws, ours
from .build import compiler_version
from .variant import AnyFunction

#: Portable: counts of one machine hold on any other with the same compiler.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
SEED = 0
FORMAT = "liegen instructions 1"
#: Beside the manifest of the library's generated tree.
FILE = "liegen_factors.instructions.json"


@dataclass(frozen=True)
class Call:
    """A C function, its arguments in C, and the numbers that it reads."""

    header: str
    symbol: str
    inputs: tuple[str, ...]
    outputs: int
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class Instructions:
    """Counts by kernel: of the value alone, and with all Jacobians; and what they were counted with."""

    compiler: str
    libc: str
    flags: tuple[str, ...]
    counts: Mapping[str, Mapping[str, int]]

    def text(self) -> str:
        """As JSON, the same for the same counts."""
        content = {
            "format": FORMAT,
            "compiler": self.compiler,
            "libc": self.libc,
            "flags": list(self.flags),
            "instructions": {name: dict(kinds) for name, kinds in self.counts.items()},
        }
        return json.dumps(content, indent=2, sort_keys=True) + "\n"


def read(path: Path) -> Instructions:
    """Counts that were written before. Raises OutputError for another file."""
    try:
        content: Any = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise KeyError("format")
        return Instructions(
            content["compiler"], content["libc"], tuple(content["flags"]), content["instructions"]
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{path} holds no instruction counts of liegen ({error})") from None


def instructions(functions: Sequence[AnyFunction]) -> Instructions:
    """Compile all kernels into one program, run it once, read the counts. Raises ToolError without tools."""
    if not shutil.which("valgrind"):
        raise ToolError("instructions are counted by valgrind, which was not found; install it")
    version = compiler_version()
    kernels = [f.kernel for f in functions]
    files = render(kernels, ["c"], package=ours.PACKAGE, regenerate="liegen bench --instructions")
    calls = {
        (f.name, kind): _call(f, symbol, program) for f in functions for kind, symbol, program in _programs(f)
    }
    with working_folder("liegen-bench-") as folder:
        kept = {
            path.removeprefix("c/"): text
            for path, text in files.items()
            if path.startswith("c/") and not path.endswith("_batch.c")
        }
        kept["main.c"] = lay_out("bench/count.c.j2", {"calls": list(calls.values())})
        for file, text in kept.items():
            (folder / file).write_text(text, encoding="utf-8")
        sources = [file for file in kept if file.endswith(".c")]
        _run([*required_compiler(), *FLAGS, "-o", "main", *sources, "-lm"], folder)
        tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=counts", "--compress-strings=no"]
        # without lazy binding: the first call of a function would also find it
        _run([*tool, "--compress-pos=no", "./main"], folder, {"LD_BIND_NOW": "1"})
        found = calls_of_main((folder / "counts").read_text(encoding="utf-8"))
    counts: dict[str, dict[str, int]] = {f.name: {} for f in functions}
    for (name, kind), call in calls.items():
        counts[name][kind] = found[call.symbol]
    return Instructions(version, " ".join(platform.libc_ver()), FLAGS, counts)


def _programs(function: AnyFunction) -> tuple[tuple[str, str, Program], ...]:
    kernel = function.kernel
    value = "value", f"{ours.PACKAGE}_{value_name(kernel)}", kernel.value
    if not kernel.variables:
        return (value,)
    return value, ("jacobians", f"{ours.PACKAGE}_{kernel.name}", kernel.jacobians)


def _call(function: AnyFunction, symbol: str, program: Program) -> Call:
    numbers: list[float] = np.ravel(draws.rows(draws.samples(function, draws.RANDOM, 1, SEED))).tolist()
    outputs = np.cumsum([0, *(port.size for port in program.outputs)]).tolist()
    inputs = np.cumsum([0, *(port.size for port in program.inputs)]).tolist()
    arguments = [f"{symbol}_in + {k}" for k in inputs[:-1]] + [f"{symbol}_out + {k}" for k in outputs[:-1]]
    shown = tuple(repr(x) for x in numbers)
    return Call(f"{function.kernel.name}.h", symbol, shown, outputs[-1], tuple(arguments))


def _run(command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None) -> None:
    done = run(command, what="counting instructions", cwd=folder, env=environment)
    if done.failed:
        raise ToolError(f"{shown(command[:3])} ... failed: {done.reason}")


def calls_of_main(text: str) -> dict[str, int]:
    """Inclusive cost of what ``main`` calls, by function, from callgrind's output."""
    found: dict[str, int] = {}
    inside, target = False, ""
    lines = iter(text.splitlines())
    for line in lines:
        if line.startswith("fn="):
            inside = line == "fn=main"
        elif line.startswith("cfn="):
            target = re.sub(r"'\d+$", "", line.removeprefix("cfn="))
        elif line.startswith("calls="):
            cost = int(next(lines).split()[-1])
            if inside:
                found[target] = found.get(target, 0) + cost
    return found
