"""Instruction counts: read from callgrind's output, the same in every run, kept beside the manifest."""

import shutil
from pathlib import Path

import pytest

from liegen.bench.callgrind import FILE, FLAGS, Instructions, calls_of_main, instructions, read
from liegen.errors import OutputError
from liegen.library import between_r2, between_se2
from liegen.native import find_compiler
from liegen.sources import load

KEPT = Path(__file__).resolve().parents[2] / "generated" / FILE
TOOLS = pytest.mark.skipif(
    not (shutil.which("valgrind") and find_compiler()), reason="no valgrind or no C compiler"
)
OUTPUT = """events: Ir

fn=other
0x1 3
cfn=f
calls=1 0x2
0x1 99

fn=main
0x1 5
cfn=f
calls=1 0x2
0x1 40
cfn=g'2
calls=2 0x2
0x1 60
0x1 7
cfn=f
calls=1 0x2
0x1 2

fn=f
0x2 42
"""


def test_costs_of_the_calls_of_main():
    assert calls_of_main(OUTPUT) == {"f": 42, "g": 60}


@TOOLS
def test_counts_repeat_and_grow_with_the_function():
    found = instructions([between_r2, between_se2])
    assert found == instructions([between_r2, between_se2])
    counts = found.counts
    assert 0 < counts["between_r2"]["value"] < counts["between_r2"]["jacobians"] < 100
    assert (
        counts["between_r2"]["jacobians"]
        < counts["between_se2"]["value"]
        < counts["between_se2"]["jacobians"]
    )


@TOOLS
def test_the_kept_counts_are_those_of_now():
    kept, functions = read(KEPT), load(None)
    found = instructions(functions)
    assert list(kept.counts) == sorted(found.counts)
    assert kept.flags == FLAGS
    if (kept.compiler, kept.libc) != (found.compiler, found.libc):
        pytest.skip(f"counted with {kept.compiler}, here is {found.compiler}")
    assert kept.counts == found.counts


def test_files(tmp_path):
    path = tmp_path / "counts.json"
    made = Instructions("cc 1", "libc 2", FLAGS, {"a": {"value": 1}})
    path.write_text(made.text())
    assert read(path) == made
    path.write_text("{}")
    with pytest.raises(OutputError, match="no instruction counts"):
        read(path)
