"""docs/conventions.md states every preset's definition and what it costs."""

from itertools import takewhile
from pathlib import Path

import pytest

from liegen import library
from liegen.charts import PRESETS

TEXT = (Path(__file__).parents[2] / "docs" / "conventions.md").read_text(encoding="utf-8")


def rows():
    lines = TEXT.splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("| preset | `prior_se3`"))
    table = takewhile(lambda line: "|" in line, lines[start:])
    return [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in table]


def test_definitions_are_those_of_the_presets():
    for p in PRESETS.values():
        assert f"- `{p.name}`: {p.definition}\n" in TEXT


@pytest.mark.parametrize("name", PRESETS)
def test_operation_counts_are_the_documented_ones(name):
    titles, _, *table = rows()
    (counts,) = (row[1:] for row in table if row[0] == name)
    found = [getattr(library, f).in_chart(name).kernel.jacobians.operations for f in titles[1:]]
    assert [int(c) for c in counts] == found
