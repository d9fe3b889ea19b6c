"""The tables of mutants fit the source, and running one tells caught from survived."""

import ast
import tomllib

import pytest

from mutants.mutant import ROOT, Mutant, mutants
from mutants.run import run

ALL = mutants()


def test_there_are_about_a_hundred_in_all_areas():
    assert len(ALL) >= 100
    assert len({(m.file, m.before, m.after) for m in ALL}) == len(ALL)


@pytest.mark.parametrize("mutant", ALL, ids=lambda m: f"{m.area}-{m.after.strip()[:40]}")
def test_a_mutant_changes_one_place(mutant):
    text = mutant.text(ROOT)
    assert text != (ROOT / mutant.file).read_text(encoding="utf-8")
    if mutant.file.endswith(".py"):
        ast.parse(text)
    for test in mutant.tests:
        assert (ROOT / test).exists(), test


def project(folder):
    """A package of one function with one test."""
    (folder / "src" / "doubling").mkdir(parents=True)
    (folder / "src" / "doubling" / "__init__.py").write_text("def twice(x):\n    return 2 * x  # exactly\n")
    (folder / "test_twice.py").write_text(
        "from doubling import twice\n\n\ndef test_twice():\n    assert twice(3) == 6\n"
    )
    return folder


@pytest.mark.parametrize(
    ("before", "after", "outcome"),
    [("2 * x", "3 * x", "caught"), ("  # exactly", "", "survived"), ("return", "return (", "broken")],
)
def test_outcomes(tmp_path, before, after, outcome):
    mutant = Mutant("tools", "src/doubling/__init__.py", before, after, ("test_twice.py",))
    place = project(tmp_path)
    original = (place / mutant.file).read_text()
    assert run(mutant, place).outcome == outcome
    assert (place / mutant.file).read_text() == original


def test_a_text_that_is_not_there_is_refused(tmp_path):
    mutant = Mutant("tools", "src/doubling/__init__.py", "4 * x", "3 * x", ("test_twice.py",))
    with pytest.raises(ValueError, match="0 times"):
        run(mutant, project(tmp_path))


def test_tables_are_toml_with_known_keys():
    for path in (ROOT / "tests" / "mutants").glob("*.toml"):
        for row in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]:
            assert set(row) <= {"file", "before", "after", "tests", "equivalent"}
