"""A mutant: one text of one source file put in the place of another, and the tests that must notice."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


@dataclass(frozen=True)
class Mutant:
    """``before``, which stands exactly once in ``file``, is replaced by ``after``.

    ``file`` is relative to the root of the checkout, ``tests`` are files
    and folders for pytest, slow tests left out. ``equivalent`` says why
    no test can tell the mutant from the original; it is empty for mutants that must be caught.
    """

    area: str
    file: str
    before: str
    after: str
    tests: tuple[str, ...]
    equivalent: str = ""

    def text(self, root: Path) -> str:
        """The changed text of the file. Raises ValueError where ``before`` does not stand there once."""
        original = (root / self.file).read_text(encoding="utf-8")
        found = original.count(self.before)
        if found != 1:
            raise ValueError(f"{self.file}: {self.before!r} stands there {found} times, not once")
        return original.replace(self.before, self.after)

    def line(self, root: Path) -> int:
        """The line on which ``before`` begins."""
        original = (root / self.file).read_text(encoding="utf-8")
        return 1 + original[: original.find(self.before)].count("\n")


def mutants(folder: Path = HERE) -> tuple[Mutant, ...]:
    """All mutants, area by area. The tables of a file: ``tests``, and ``mutant`` for each change."""
    found: list[Mutant] = []
    for path in sorted(folder.glob("*.toml")):
        area = tomllib.loads(path.read_text(encoding="utf-8"))
        for row in area["mutant"]:
            tests = tuple(row.get("tests", area["tests"]))
            found.append(
                Mutant(path.stem, row["file"], row["before"], row["after"], tests, row.get("equivalent", ""))
            )
    return tuple(found)
