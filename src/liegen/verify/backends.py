"""The code under test: ``Program.evaluate``, the generated NumPy package, the compiled C, each on a batch."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.emit import render
from liegen.emit.importing import load_modules
from liegen.emit.precision import DOUBLE, SINGLE, Precision
from liegen.kernel import Kernel
from liegen.program import Program
from liegen.temporary import working_folder

from .compiled import c_backends, compile_c

Array = NDArray[np.float64]
#: Arrays (samples, size) by argument, or (samples, *shape) by output.
Arrays = Mapping[str, Array]
Evaluate = Callable[[Arrays], dict[str, Array]]

PACKAGE = "liegen_verified"
TARGETS = ("numpy", "c")


@dataclass(frozen=True)
class Backend:
    """One way to compute a factor. Without ``jacobians`` it is the function of the outputs alone."""

    name: str
    jacobians: bool
    evaluate: Evaluate


@dataclass(frozen=True)
class Workspace:
    """A temporary folder with the generated code; ``library`` is the compiled C, None without a compiler."""

    folder: Path
    library: Path | None
    compiler: str


@contextmanager
def workspace(kernels: Sequence[Kernel]) -> Generator[Workspace]:
    """Render the kernels to a temporary folder and compile them.

    Raises ToolError when C does not compile, and where there is no room for temporary files.
    """
    with working_folder("liegen-verify-") as folder:
        files = render(
            kernels, TARGETS, package=PACKAGE, regenerate="liegen verify", layout="col", scalar=SINGLE.type
        )
        for path, text in files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text, encoding="utf-8")
        library, compiler = compile_c(folder / "c", folder)
        yield Workspace(folder, library, compiler)


def backends(kernel: Kernel, place: Workspace) -> tuple[Backend, ...]:
    """Everything that computes this factor: programs, NumPy functions and, if compiled, C functions."""
    return (*programs(kernel), *numpy_backends(kernel, place.folder), *compiled_backends(kernel, place))


def compiled_backends(kernel: Kernel, place: Workspace, precision: Precision = DOUBLE) -> tuple[Backend, ...]:
    """The compiled C functions of one factor and of batches; none without a compiler."""
    found = c_backends(kernel, place.library, PACKAGE, precision) if place.library else ()
    return tuple(Backend(name, jacobians, evaluate) for name, jacobians, evaluate in found)


def programs(kernel: Kernel) -> tuple[Backend, ...]:
    """Both programs of a kernel, the complete one first; one where there are no variables."""
    value = Backend("program, value", False, program_evaluator(kernel.value))
    if not kernel.variables:
        return (value,)
    return Backend("program", True, program_evaluator(kernel.jacobians)), value


def program_evaluator(program: Program) -> Evaluate:
    """``Program.evaluate`` on a batch."""

    def evaluate(arguments: Arrays) -> dict[str, Array]:
        count = len(next(iter(arguments.values())))
        results = program.evaluate({name: tuple(a.T) for name, a in arguments.items()})
        return {
            port.name: np.stack([np.broadcast_to(x, (count,)) for x in results[port.name]], axis=-1)
            .astype(np.float64)
            .reshape(count, *port.shape)
            for port in program.outputs
        }

    return evaluate


def numpy_backends(kernel: Kernel, folder: Path) -> tuple[Backend, ...]:
    """The functions of the generated package, imported from ``folder``."""
    package = load_package(folder / PACKAGE)
    value, jacobians = getattr(package, kernel.name), getattr(package, f"{kernel.name}_jacobians", None)
    names = [o.name for o in kernel.outputs]

    def outputs(arguments: Arrays) -> dict[str, Array]:
        result: Any = _called(value, kernel, arguments)
        return dict(zip(names, result if len(names) > 1 else [result], strict=True))

    def everything(arguments: Arrays) -> dict[str, Array]:
        return _called(jacobians, kernel, arguments)._asdict()

    alone = Backend("NumPy, value", False, outputs)
    return (alone, Backend("NumPy", True, everything)) if kernel.variables else (alone,)


def _called(function: Any, kernel: Kernel, arguments: Arrays) -> Any:
    arrays = {a.name: (arguments[a.name], a.shape) for a in kernel.arguments}
    shaped = {name: array.reshape(*array.shape[:-1], *shape) for name, (array, shape) in arrays.items()}
    positional = [shaped[a.name] for a in kernel.positional]
    return function(*positional, **{a.name: shaped[a.name] for a in kernel.keywords})


def load_package(folder: Path) -> Any:
    """Import a package from its folder and leave no trace of it in ``sys.modules``."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.py")}
    return load_modules(texts, folder.name)
