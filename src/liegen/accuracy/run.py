"""Measuring many functions in all charts, on several processes where that helps."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

from liegen.charts import PRESETS
from liegen.charts import preset as read_preset
from liegen.errors import DefinitionError
from liegen.native import cores
from liegen.verify.backends import workspace
from liegen.verify.draws import AnyFunction
from liegen.verify.run import Reload

from .figures import measure_function
from .points import KINDS
from .report import AccuracyReport, Row
from .undefined import Undefined, merged, undefined_points
from .variants import Variant, variants

#: Told after each group of functions: what it was, how many are done, how many there are.
Progress = Callable[[str, int, int], None]
#: Functions that are rendered and compiled together.
TOGETHER = 12
SAMPLES = len(KINDS)


@dataclass(frozen=True)
class _Job:
    """Functions in one chart; their names, for another process."""

    preset: str
    functions: tuple[AnyFunction, ...]

    def named(self) -> tuple[str, tuple[str, ...]]:
        """The same without the functions."""
        return self.preset, tuple(f.name for f in self.functions)


@dataclass(frozen=True)
class _Done:
    rows: tuple[Row, ...]
    undefined: tuple[Undefined, ...]
    compiler: str


def accuracy(
    functions: Sequence[AnyFunction],
    *,
    preset: str | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
    progress: Progress | None = None,
    reload: Reload | None = None,
    workers: int | None = None,
) -> AccuracyReport:
    """Measure every function in every preset, or in one; ``samples`` for each angle.

    ``reload`` lets other processes load the functions again; without it one process does everything.
    Raises DefinitionError for an unknown preset, and for a factor with a loss, whose Jacobian is no
    derivative of its residual; ToolError when a compiler is there but refuses the generated C.
    """
    if preset:
        read_preset(preset, "--chart")
    for f in functions:
        if f.weighting and f.weighting.loss:
            raise DefinitionError(f"{f.graph.site}: {f.name} has a loss: measure its accuracy without it")
    found, remarks = variants(functions, (preset,) if preset else PRESETS)
    jobs = _jobs(found)
    count = min(workers or cores(), len(jobs)) if reload else 1
    done = (
        _parallel(reload, jobs, count, samples, seed, progress)
        if reload and count > 1
        else _serial(jobs, samples, seed, progress)
    )
    measured = {(row.function, row.presets[0]): row for part in done for row in part.rows}
    rows = [Row(v.function.name, v.presets, measured[v.function.name, v.presets[0]].measured) for v in found]
    points = merged([u for part in done for u in part.undefined])
    compiler = next((part.compiler for part in done), "")
    return AccuracyReport(tuple(rows), points, remarks, samples, seed, compiler)


def _jobs(found: Sequence[Variant]) -> list[_Job]:
    """Charts apart, because names of functions must not meet in one package."""
    by_preset: dict[str, list[AnyFunction]] = {}
    for v in found:
        by_preset.setdefault(v.presets[0], []).append(v.function)
    return [
        _Job(preset, tuple(functions[k : k + TOGETHER]))
        for preset, functions in by_preset.items()
        for k in range(0, len(functions), TOGETHER)
    ]


def _measured(job: _Job, samples: int, seed: int) -> _Done:
    with workspace([f.kernel for f in job.functions]) as place:
        rows = [Row(f.name, (job.preset,), measure_function(f, place, samples, seed)) for f in job.functions]
        points = [u for f in job.functions for u in undefined_points(f, place)]
        return _Done(tuple(rows), tuple(points), place.compiler)


def _serial(jobs: Sequence[_Job], samples: int, seed: int, progress: Progress | None) -> list[_Done]:
    done: list[_Done] = []
    for job in jobs:
        done.append(_measured(job, samples, seed))
        if progress:
            progress(job.preset, len(done), len(jobs))
    return done


def _parallel(
    reload: Reload, jobs: Sequence[_Job], count: int, samples: int, seed: int, progress: Progress | None
) -> list[_Done]:
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=context) as pool:
        futures = {pool.submit(_work, reload, *job.named(), samples, seed): k for k, job in enumerate(jobs)}
        results: dict[int, _Done] = {}
        for future in as_completed(futures):
            results[futures[future]] = future.result()
            if progress:
                progress(jobs[futures[future]].preset, len(results), len(jobs))
    return [results[k] for k in range(len(jobs))]


def _work(reload: Reload, preset: str, names: Sequence[str], samples: int, seed: int) -> _Done:
    known: Mapping[str, AnyFunction] = reload()
    return _measured(_Job(preset, tuple(known[n].in_chart(preset) for n in names)), samples, seed)
