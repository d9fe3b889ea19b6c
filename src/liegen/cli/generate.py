"""``liegen generate``: from factors to files."""

from __future__ import annotations

import importlib
import re
import shlex
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .shared import (
    chart_option,
    chosen,
    groups_option,
    names_option,
    noise_options,
    source_argument,
    table,
    tracked,
    weighed,
)

if TYPE_CHECKING:
    from liegen.kernel import Kernel
    from liegen.sources import AnyFunction

TARGETS = ("numpy", "c")
LAYOUTS = ("row", "col")
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
    layout: str
    groups: tuple[str, ...] = ()
    chart: str | None = None
    noise: str | None = None
    loss: str | None = None
    mode: str | None = None
    scalar: str = SCALARS[0]

    def chosen(self, source: str | None) -> tuple[AnyFunction, ...]:
        """The factors that are asked for, of ``source``, whitened and robust as asked for."""
        return weighed(chosen(source, self.names, self.groups, self.chart), self.noise, self.loss, self.mode)

    def command(self, source: str | None, directory: str) -> str:
        """The command line that repeats the request; options with their default value are left out."""
        words = ["liegen", "generate", *([source] if source else [])]
        words += [w for group in self.groups for w in ("--group", group)]
        words += [w for name in self.names for w in ("-f", name)]
        words += [] if self.targets == TARGETS else [w for target in self.targets for w in ("-t", target)]
        words += ["-o", directory]
        words += [] if self.package == default_package(source, self.groups) else ["--package", self.package]
        words += [] if self.layout == LAYOUTS[0] else ["--layout", self.layout]
        words += [] if self.scalar == SCALARS[0] else ["--scalar", self.scalar]
        for option in ("chart", "noise", "loss", "mode"):
            words += [f"--{option}", getattr(self, option)] if getattr(self, option) else []
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


def requested(
    source: str | None,
    names: Sequence[str],
    targets: Sequence[str],
    package: str | None,
    layout: str,
    groups: Sequence[str] = (),
    *options: str | None,
    scalar: str = SCALARS[0],
) -> Request:
    """Fill in the defaults; ``options`` are chart, noise, loss and mode."""
    wanted = tuple(t for t in TARGETS if not targets or t in targets)
    called = package or default_package(source, groups)
    unique = tuple(dict.fromkeys(names)), tuple(dict.fromkeys(groups))
    return Request(source, unique[0], wanted, called, layout, unique[1], *options, scalar=scalar)


def derived(functions: Sequence[AnyFunction]) -> list[Kernel]:
    """The kernels; each is derived at its first use."""
    return [f.kernel for f in tracked(functions, "derive", lambda f: f.name)]


def rendered(request: Request, functions: Sequence[AnyFunction], regenerate: str) -> dict[str, str]:
    """Derive, check and lay out; nothing is written."""
    from liegen.emit import check_names, render
    from liegen.verify import check_finite

    kernels = derived(functions)
    check_names(kernels, request.package)
    for function in functions:
        check_finite(function)
    return render(
        kernels,
        request.targets,
        package=request.package,
        regenerate=regenerate,
        layout=request.layout,
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
@click.option("-o", "--output", required=True, metavar="DIR", help="Folder to write to; made if need be.")
@click.option(
    "--package", metavar="NAME", help="Name of the Python package and prefix of the C functions."
    " Default: liegen_factors for the library, liegen_groups for groups, STEM_gen for a file STEM.py."
)  # fmt: skip
@click.option(
    "--layout", type=click.Choice(LAYOUTS), default=LAYOUTS[0], show_default=True,
    help="col adds C functions with column-major Jacobians (suffix _cm).",
)  # fmt: skip
@click.option(
    "--scalar", type=click.Choice(SCALARS), default=SCALARS[0], show_default=True,
    help="float adds C functions in single precision (suffix _f32).",
)  # fmt: skip
@chart_option
@noise_options
def generate(
    source: str | None,
    names: tuple[str, ...],
    groups: tuple[str, ...],
    targets: tuple[str, ...],
    output: str,
    package: str | None,
    layout: str,
    scalar: str,
    chart: str | None,
    noise: str | None,
    loss: str | None,
    mode: str | None,
) -> None:
    """Write NumPy to DIR/NAME/ and C to DIR/c/, all files or none."""
    from liegen.emit import write_tree

    options = (chart, noise, loss, mode)
    request = requested(source, names, targets, package, layout, groups, *options, scalar=scalar)
    functions = request.chosen(source)
    for module in ("derive", "emit", "verify"):  # loading CasADi and Jinja2 is no part of the times below
        importlib.import_module(f"liegen.{module}")
    times = [time.perf_counter()]
    derived(functions)
    times.append(time.perf_counter())
    files = rendered(request, functions, request.header)
    times.append(time.perf_counter())
    done = write_tree(files, Path(output))
    table(
        ("factor", "operations", "with Jacobians"),
        [_row(f.kernel) for f in functions],
        right=(1, 2),
    )
    click.echo()
    for path in done.removed:
        click.echo(f"removed {Path(output, path)}")
    many = f"{len(functions)} factors" if len(functions) > 1 else "1 factor"
    click.echo(
        f"derived {many} in {times[1] - times[0]:.2f} s, checked and rendered in {times[2] - times[1]:.2f} s"
    )
    folders = sorted({str(Path(output, path).parent) for path in files if "/" in path})
    click.echo(
        f"wrote {len(done.written)} files ({len(done.unchanged)} were up to date) to {' and '.join(folders)}"
    )
