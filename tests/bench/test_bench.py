"""The benchmark compares equal things. It asserts no time."""

import json

import pytest
from click.testing import CliRunner

from liegen.bench import compare
from liegen.cli.application import app
from liegen.library import between_se2, projection_cal3_s2
from liegen.native import find_compiler

pytestmark = pytest.mark.skipif(not find_compiler(), reason="no C compiler")


@pytest.mark.parametrize("function", [between_se2, projection_cal3_s2], ids=lambda f: f.name)
def test_all_variants_compute_the_same(function):
    rows = compare(function, calls=200, rounds=3, seed=1)
    assert rows[0].name == "liegen"
    assert len(rows) == 3
    assert all(r.error < 1e-12 for r in rows)
    assert all(0 < r.minimum_ns <= r.median_ns for r in rows)
    assert rows[0].operations < min(r.operations for r in rows[1:])


def test_the_command_prints_json():
    arguments = ["bench", "-f", "between_so2", "--calls", "100", "--rounds", "2", "--json"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    content = json.loads(result.output)
    assert content["flags"] == ["-O3", "-march=native"]
    assert content["factors"]["between_so2"][0]["ratio"] == 1.0
