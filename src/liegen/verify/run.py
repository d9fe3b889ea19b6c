"""Verifying many factors, on several processes where that helps. The result does not depend on how many."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import NamedTuple, TypeGuard

from liegen.define import Function
from liegen.modules import every_function
from liegen.native import cores

from .backends import Workspace, workspace
from .draws import AnyFunction
from .factor import check_factor
from .report import FactorReport, Report

#: Finds the factors again in another process: a picklable callable, such as ``partial(load, "factors.py")``.
Reload = Callable[[], Mapping[str, AnyFunction]]
#: Told after each factor: its report, how many are done, how many there are.
Progress = Callable[[FactorReport, int, int], None]

SAMPLES = 128
#: Fewer factors than this for each process are not worth starting it.
WORTHWHILE = 3


def library() -> dict[str, AnyFunction]:
    """The built-in factors by name, in the library's order."""
    from liegen import library as home

    return {value.name: value for value in vars(home).values() if _is_function(value)}


def _is_function(value: object) -> TypeGuard[AnyFunction]:
    return isinstance(value, Function)


def everything() -> dict[str, AnyFunction]:
    """The built-in factors and the functions of all groups: what must be right without any allowance."""
    return library() | every_function()


def verify(
    functions: Sequence[AnyFunction],
    *,
    samples: int = SAMPLES,
    seed: int = 0,
    progress: Progress | None = None,
    reload: Reload | None = None,
    workers: int | None = None,
    gauss_newton: bool = False,
) -> Report:
    """Run every check of every factor.

    ``samples`` are drawn for each factor. ``reload`` lets other processes load factors that are not the
    library's; without it those are verified in this process. ``workers`` is their number, by default one for
    each core. ``gauss_newton``: the Gauss-Newton terms of factors too.
    Raises ToolError when a compiler is there but refuses the generated C.
    """
    known = everything()
    builtin = all(known.get(f.name) is f for f in functions)
    source: Reload | None = everything if builtin and reload is None else reload
    strict = {f.name for f in functions if known.get(f.name) is f}
    count = min(workers or cores(), len(functions) // WORTHWHILE) if source else 1
    kernels = [f.kernel for f in functions]
    kernels += [f.gauss_newton_kernel for f in functions if gauss_newton and f.is_factor]
    with workspace(kernels) as place:
        jobs = [
            Job(f.name, samples, seed, f.name not in strict, gauss_newton and f.is_factor) for f in functions
        ]
        found = (
            _parallel(source, place, jobs, count, progress)
            if source and count > 1
            else _serial(functions, place, jobs, progress)
        )
        compiler = place.compiler
    return Report(tuple(found), samples, seed, compiler)


class Job(NamedTuple):
    """The arguments of :func:`check_factor` for the factor of a name."""

    name: str
    samples: int
    seed: int
    conditioned: bool
    gauss_newton: bool

    def report(self, function: AnyFunction, place: Workspace) -> FactorReport:
        """All checks."""
        return check_factor(
            function, place, self.samples, self.seed,
            conditioned=self.conditioned, gauss_newton=self.gauss_newton,
        )  # fmt: skip


def _serial(
    functions: Sequence[AnyFunction], place: Workspace, jobs: Sequence[Job], progress: Progress | None
) -> list[FactorReport]:
    reports: list[FactorReport] = []
    for function, job in zip(functions, jobs, strict=True):
        reports.append(job.report(function, place))
        if progress:
            progress(reports[-1], len(reports), len(jobs))
    return reports


def _parallel(
    source: Reload, place: Workspace, jobs: Sequence[Job], count: int, progress: Progress | None
) -> list[FactorReport]:
    """Worker processes start afresh, so they hold no locks or threads of this one."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=context) as pool:
        futures = {pool.submit(_work, source, place, job): job.name for job in jobs}
        reports: dict[str, FactorReport] = {}
        for future in as_completed(futures):
            report = future.result()
            reports[futures[future]] = report
            if progress:
                progress(report, len(reports), len(jobs))
    return [reports[job.name] for job in jobs]


def _work(source: Reload, place: Workspace, job: Job) -> FactorReport:
    return job.report(source()[job.name], place)
