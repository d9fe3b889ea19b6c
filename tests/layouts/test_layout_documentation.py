"""docs/conventions.md lists every layout, with what it costs."""

import re
from itertools import takewhile
from pathlib import Path

import pytest

from liegen import library
from liegen.layouts import LAYOUTS

LINES = (Path(__file__).parents[2] / "docs" / "conventions.md").read_text(encoding="utf-8").splitlines()


def table(title):
    start = next(k for k, line in enumerate(LINES) if line.startswith(title))
    rows = takewhile(lambda line: "|" in line, LINES[start:])
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in rows]


def names(cell):
    return [name for name in re.findall(r"`([^`]+)`", cell) if name in LAYOUTS]


def test_every_layout_is_described_once():
    _, _, *rows = table("| layout | SO3, SE3 |")
    assert sorted(name for row in rows for name in names(row[0])) == sorted(LAYOUTS)


@pytest.mark.parametrize("row", table("| layout | `prior_se3`")[2:], ids=lambda row: row[0])
def test_operation_counts_are_the_documented_ones(row):
    factors = [cell.strip("`") for cell in table("| layout | `prior_se3`")[0][1:]]
    listed = names(row[0])
    assert listed
    for name in listed:
        found = [getattr(library, f).in_layout(name).kernel.jacobians.operations for f in factors]
        assert [int(c) for c in row[1:]] == found
