"""``python -m tests.mutants``: apply every mutant in turn, run its tests, and print which were caught."""

import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import click

from .mutant import ROOT, Mutant, mutants
from .run import Result, copied, outcome_of, run

#: Of the mutants that are not equivalent, so many must be caught.
WANTED = 0.95


@click.command()
@click.argument("words", nargs=-1)
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Copies side by side.")
@click.option("--verbose", is_flag=True, help="Print what pytest says where the outcome is not as expected.")
@click.option("--list", "only_list", is_flag=True, help="List the mutants, run nothing.")
def main(words: tuple[str, ...], jobs: int, verbose: bool, only_list: bool) -> None:
    """Run the mutants whose area or file contains one of WORDS, or all of them.

    The tests must pass on the unchanged source first. The exit code is 1 where fewer than 95 % are caught, or
    where a mutant that is called equivalent is caught.
    """
    chosen = [m for m in mutants() if not words or any(w in f"{m.area} {m.file}" for w in words)]
    if only_list:
        for mutant in chosen:
            click.echo(f"{mutant.area}  {mutant.file}:{mutant.line(ROOT)}  {mutant.after.strip()}")
        return
    with tempfile.TemporaryDirectory() as folder:
        copies: SimpleQueue[Path] = SimpleQueue()
        for k in range(jobs):
            copies.put(copied(ROOT, Path(folder) / str(k)))

        def one(mutant: Mutant) -> Result:
            place = copies.get()
            try:
                result = run(mutant, place)
            finally:
                copies.put(place)
            _print(result, verbose=verbose)
            return result

        _check_unchanged(chosen, copies)
        with ThreadPoolExecutor(jobs) as pool:
            results = list(pool.map(one, chosen))
    _summary(results)
    real = [r for r in results if not r.mutant.equivalent]
    caught = sum(r.outcome == "caught" for r in real)
    if caught < WANTED * len(real) or any(r.mutant.equivalent and not r.as_expected for r in results):
        sys.exit(1)


def _check_unchanged(chosen: list[Mutant], copies: "SimpleQueue[Path]") -> None:
    """A test that fails anyway would catch everything."""
    place = copies.get()
    tests = tuple(sorted({test for mutant in chosen for test in mutant.tests}))
    code, output = outcome_of(place, tests, limit=3600)
    copies.put(place)
    if code:
        raise click.ClickException(f"the tests fail without a mutant:\n{output[-4000:]}")
    click.echo(f"unchanged: {output.strip().splitlines()[-1]}")


def _print(result: Result, *, verbose: bool) -> None:
    mutant = result.mutant
    note = f"  (equivalent: {mutant.equivalent})" if mutant.equivalent else ""
    click.echo(
        f"{result.outcome:9} {result.seconds:6.1f} s  {mutant.file}:{mutant.line(ROOT)}"
        f"  {mutant.after.strip()[:70]!r}{note}"
    )
    if verbose and not result.as_expected:
        click.echo(result.output[-3000:])


def _summary(results: list[Result]) -> None:
    areas = sorted({r.mutant.area for r in results})
    click.echo(f"\n{'area':16}{'mutants':>8}{'caught':>8}{'survived':>10}{'equivalent':>12}{'broken':>8}")
    for area in (*areas, ""):
        own = [r for r in results if area in ("", r.mutant.area)]
        equivalent = sum(bool(r.mutant.equivalent) and r.outcome == "survived" for r in own)
        counts = Counter(r.outcome for r in own)
        click.echo(
            f"{area or 'all':16}{len(own):8}{counts['caught']:8}{counts['survived'] - equivalent:10}"
            f"{equivalent:12}{counts['broken']:8}"
        )


if __name__ == "__main__":
    main()
