"""The command ``liegen bench``."""

import json
import shutil

import pytest
from click.testing import CliRunner

from compiler_tools import needs_compiler
from liegen.bench.variant import FLAGS
from liegen.cli.application import app

pytestmark = needs_compiler


def run(*arguments, code=0):
    result = CliRunner().invoke(app, ["bench", *arguments])
    assert result.exit_code == code, result.output
    return result.output


def test_a_profile_as_json():
    content = json.loads(run("-f", "between_so2", "--rounds", "2", "--largest", "10", "--json"))
    (profile,) = content["profiles"]
    assert profile["function"] == "between_so2"
    assert [size["n"] for size in profile["sizes"]] == [1, 10]
    assert content["flags"] == "-O3 -march=native"


def test_a_profile_as_a_table():
    text = run("-f", "between_so2", "--rounds", "2", "--largest", "1")
    for shown in ("single calls", "chain", "structure of arrays", "ceilings", "-march=native"):
        assert shown in text


def test_instructions(tmp_path):
    if not shutil.which("valgrind"):
        text = run("-f", "between_r2", "--instructions", code=2)
        assert "valgrind" in text
        return
    path = str(tmp_path / "counts.json")
    assert "between_r2" in run("-f", "between_r2", "--instructions", "--write", path)
    assert "instructions of a call" in run("-f", "between_r2", "--instructions", "--compare", path)


def test_a_graph_needs_a_file():
    assert "no_such.g2o does not exist; give the name of a file" in run("--graph", "no_such.g2o", code=2)


@pytest.mark.slow
def test_peers(tmp_path):
    arguments = ["--peers", "-f", "between_so2", "--calls", "40", "--rounds", "2", "--json"]
    content = json.loads(run(*arguments))
    assert content["failed"] == []
    entries = content["functions"]["between_so2"]["entries"]
    assert entries[0]["peer"] == "liegen"
    assert {e["flags"] for e in entries} == set(FLAGS)
