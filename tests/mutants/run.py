"""Runs mutants: a copy of the checkout in which one file at a time is changed."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from .mutant import Mutant

#: Folders and files that the tests read.
COPIED = ("src", "tests", "templates", "generated", "docs", "pyproject.toml", "README.md", ".ci")
#: Seconds for the tests of one mutant: a change may make a loop endless.
LIMIT = 900


@dataclass(frozen=True)
class Result:
    """``outcome``: "caught", "survived", or "broken", where pytest could not even collect the tests."""

    mutant: Mutant
    outcome: str
    seconds: float
    output: str

    @property
    def as_expected(self) -> bool:
        """Whether the mutant was caught, or is one that no test can catch and was not."""
        return self.outcome == ("survived" if self.mutant.equivalent else "caught")


def copied(root: Path, place: Path) -> Path:
    """A copy of the checkout to change."""
    leave_out = shutil.ignore_patterns("__pycache__", ".pytest_cache")
    for name in COPIED:
        source = root / name
        if source.is_dir():
            shutil.copytree(source, place / name, ignore=leave_out)
        elif source.exists():
            shutil.copy2(source, place / name)
    return place


@contextmanager
def changed(mutant: Mutant, place: Path) -> Iterator[None]:
    """The copy with the mutant in it; the original text is put back at the end."""
    path = place / mutant.file
    original = path.read_text(encoding="utf-8")
    path.write_text(mutant.text(place), encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(original, encoding="utf-8")


def outcome_of(place: Path, tests: tuple[str, ...], limit: float = LIMIT) -> tuple[int, str]:
    """The exit code of pytest on the copy, and what it printed; tests that run too long count as failed."""
    folders = [place / "src", place / "generated", place / "generated" / "groups"]
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, folders)),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-m", "not slow", *tests]
    try:
        done = subprocess.run(
            command, cwd=place, env=environment, capture_output=True, text=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return 1, f"more than {limit:g} s"
    return done.returncode, done.stdout + done.stderr


def run(mutant: Mutant, place: Path) -> Result:
    """What the tests say of a mutant, in a copy that :func:`copied` made."""
    start = time.monotonic()
    with changed(mutant, place):
        code, output = outcome_of(place, mutant.tests)
    outcome = "caught" if code < 0 else {0: "survived", 1: "caught"}.get(code, "broken")  # < 0: it crashed
    return Result(mutant, outcome, time.monotonic() - start, output)
