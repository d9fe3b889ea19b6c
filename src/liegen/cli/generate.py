"""``liegen generate``: from factors to files."""

from __future__ import annotations

import importlib
import re
import shlex
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from liegen.text import one_line

from .shared import (
    Convention,
    chosen,
    convention_options,
    groups_option,
    names_option,
    new_folder,
    noise_options,
    say,
    say_left,
    source_argument,
    table,
    tracked,
    weighed,
)

if TYPE_CHECKING:
    from liegen.kernel import Kernel
    from liegen.sources import AnyFunction

TARGETS = ("numpy", "c")
MAJORS = ("row", "col")
SCALARS = ("double", "float")
#: Stands for the output folder in the headers: files are the same wherever they are written.
ANYWHERE = "DIR"


@dataclass(frozen=True)
class Request:
    """What ``generate`` was asked for, apart from where to write it."""

    source: str | None
    names: tuple[str, ...]
    targets: tuple[str, ...]
    package: str
    groups: tuple[str, ...]
    convention: Convention
    major: str
    scalar: str
    noise: str | None
    loss: str | None
    mode: str | None
    gauss_newton: bool

    def chosen(self, source: str | None) -> tuple[AnyFunction, ...]:
        """The factors that are asked for, of ``source``, whitened and robust as asked for."""
        functions = chosen(source, self.names, self.groups, self.convention)
        return weighed(functions, self.noise, self.loss, self.mode)

    def command(self, source: str | None, directory: str) -> str:
        """The command line that repeats the request; options with their default value are left out."""
        words = ["liegen", "generate", *([source] if source else [])]
        words += [w for group in self.groups for w in ("--group", group)]
        words += [w for name in self.names for w in ("-f", name)]
        words += [] if self.targets == TARGETS else [w for target in self.targets for w in ("-t", target)]
        words += ["-o", directory]
        words += [] if self.package == default_package(source, self.groups) else ["--package", self.package]
        words += [] if self.major == MAJORS[0] else ["--major", self.major]
        words += [] if self.scalar == SCALARS[0] else ["--scalar", self.scalar]
        options = {**vars(self.convention), "noise": self.noise, "loss": self.loss, "mode": self.mode}
        for option, value in {**options, "gauss-newton": self.gauss_newton}.items():
            words += [f"--{option}", *([] if value is True else [value])] if value else []
        return shlex.join(words)

    @property
    def header(self) -> str:
        """The command as generated files show it: without folders of this machine."""
        is_file = self.source is not None and self.source.endswith(".py")
        return self.command(Path(str(self.source)).name if is_file else self.source, ANYWHERE)


def default_package(source: str | None, groups: Sequence[str] = ()) -> str:
    """``liegen_factors`` for the library, ``liegen_groups`` for groups, ``robot_gen`` for ``robot.py``."""
    if source is None:
        return "liegen_groups" if groups else "liegen_factors"
    stem = Path(source).stem if source.endswith(".py") else source.rpartition(".")[2]
    name = re.sub(r"[^A-Za-z0-9_]+", "_", stem).strip("_")
    return f"{name}_gen"


def requested(given: Mapping[str, Any]) -> Request:
    """From the options of the command by name, with the defaults filled in."""
    source, groups = given["source"], tuple(dict.fromkeys(given["groups"]))
    return Request(
        source=source,
        names=tuple(dict.fromkeys(given["names"])),
        targets=tuple(t for t in TARGETS if not given["targets"] or t in given["targets"]),
        package=default_package(source, groups) if given["package"] is None else given["package"],
        groups=groups,
        convention=Convention(given["chart"], given["layout"], given["normalise"]),
        **{name: given[name] for name in ("major", "scalar", "noise", "loss", "mode", "gauss_newton")},
    )


def derived(functions: Sequence[AnyFunction], *, gauss_newton: bool = False) -> list[Kernel]:
    """The kernels, those of Gauss-Newton terms behind their factors; each is derived at its first use."""
    return [
        kernel
        for f in tracked(functions, "derive", lambda f: f.name)
        for kernel in (f.kernel, *([f.gauss_newton_kernel] if gauss_newton and f.is_factor else []))
    ]


def rendered(request: Request, functions: Sequence[AnyFunction], regenerate: str) -> dict[str, str]:
    """Derive, check and lay out; nothing is written."""
    from liegen.emit import check_names, render
    from liegen.verify import check_finite

    kernels = derived(functions, gauss_newton=request.gauss_newton)
    check_names(kernels, request.package)
    for function in functions:
        check_finite(function)
    return render(
        kernels,
        request.targets,
        package=request.package,
        regenerate=regenerate,
        layout=request.major,
        scalar=request.scalar,
    )


def _row(kernel: Kernel) -> tuple[str, str, str]:
    """Name and operations; a function without Jacobians has one number."""
    both = str(kernel.jacobians.operations) if kernel.variables else ""
    return kernel.name, str(kernel.value.operations), both


@click.command()
@source_argument
@names_option
@groups_option
@click.option(
    "-t", "--target", "targets", multiple=True, type=click.Choice(TARGETS), help="Language; both by default."
)
@click.option(
    "-o", "--output", required=True, metavar="DIR", callback=new_folder,
    help="Folder to write to; made if need be.",
)  # fmt: skip
@click.option(
    "--package", metavar="NAME", help="Name of the Python package and prefix of the C functions."
    " Default: liegen_factors for the library, liegen_groups for groups, STEM_gen for a file STEM.py."
)  # fmt: skip
@click.option(
    "--major", type=click.Choice(MAJORS), default=MAJORS[0], show_default=True,
    help="Order of matrices in C: col adds functions and batches with column-major Jacobians (suffix _cm).",
)  # fmt: skip
@click.option(
    "--scalar", type=click.Choice(SCALARS), default=SCALARS[0], show_default=True,
    help="In C: float adds functions and batches in single precision (suffix _f32).",
)  # fmt: skip
@convention_options
@noise_options
@click.option(
    "--gauss-newton", is_flag=True,
    help="Also functions NAME_gauss_newton: cost, gradient and the blocks of J^T J, without storing J.",
)  # fmt: skip
def generate(output: str, **given: Any) -> None:
    """Write NumPy to DIR/NAME/ and C to DIR/c/, all files or none."""
    from liegen.emit import write_tree

    request = requested(given)
    functions = request.chosen(request.source)
    say_left(functions, [request.noise, request.loss, request.mode, request.gauss_newton])
    for module in ("derive", "emit", "verify"):  # loading CasADi and Jinja2 is no part of the times below
        importlib.import_module(f"liegen.{module}")
    times = [time.perf_counter()]
    kernels = derived(functions, gauss_newton=request.gauss_newton)
    times.append(time.perf_counter())
    files = rendered(request, functions, request.header)
    times.append(time.perf_counter())
    done = write_tree(files, Path(output))
    if done.undone:
        say(f"{output}: a run of liegen was killed while it wrote here; its changes were put back first")
    table(
        ("factor", "operations", "with Jacobians"),
        [_row(kernel) for kernel in kernels],
        right=(1, 2),
    )
    say()
    for path in done.removed:
        say(one_line(f"removed {Path(output, path)}"))
    many = f"{len(functions)} factors" if len(functions) > 1 else "1 factor"
    say(f"derived {many} in {times[1] - times[0]:.2f} s, checked and rendered in {times[2] - times[1]:.2f} s")
    folders = sorted({str(Path(output, path).parent) for path in files if "/" in path})
    wrote = f"wrote {len(done.written)} files ({len(done.unchanged)} were up to date)"
    say(one_line(f"{wrote} to {' and '.join(folders)}"))
