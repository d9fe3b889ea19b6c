"""A foreign function has a process of its own: whatever it does, liegen goes on and says what happened."""

import subprocess
import sys

import pytest
from click.testing import CliRunner

from compiler_tools import needs_compiler
from liegen.cli import app
from liegen.native import compile_shared

CODE = """
import os, sys, time
import numpy as np

def right(x, y, z):
    d = y - x
    n = max(np.linalg.norm(d), 1e-300)
    return n - z, -d / n, d / n

def prints(x, y, z):
    print("some text")
    return right(x, y, z)

def exits(x, y, z):
    sys.exit(0)

def ends(x, y, z):
    os._exit(0)

def interrupts(x, y, z):
    raise BaseException("odd")

class Unspeakable(Exception):
    def __str__(self):
        raise ValueError

def unspeakable(x, y, z):
    raise Unspeakable

def text(x, y, z):
    return "abc"

def texts(x, y, z):
    return "a", "b", "c"

def nothing(x, y, z):
    return None

def complex_numbers(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r, by_x * 1j, by_y

def ragged(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r, [[1.0, 2.0], [3.0]], by_y

def hangs(x, y, z):
    time.sleep(60)
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(CODE)
    return path


def run(place, *more):
    return CliRunner().invoke(app, ["check-jacobian", "range_r3", "--against", str(place), *more])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("exits", "exits raised SystemExit: 0"),
        ("ends", "ended the process (exit code 0) at the arguments ["),
        ("interrupts", "raised BaseException: odd"), ("unspeakable", "raised Unspeakable"),
        ("text", "must return 3 arrays"), ("texts", "the residual must hold real numbers"),
        ("nothing", "must return 3 arrays"),
        ("complex_numbers", "by x must hold real numbers, it holds complex"),
        ("ragged", "the Jacobian by x is no array: its rows differ in length"),
    ],
)  # fmt: skip
def test_what_a_function_does_is_told(file, name, words):
    done = run(f"{file}:{name}")
    assert done.exit_code == 2
    assert words in done.output
    assert done.output.count("Error") == 1 + words.count("Error")
    assert "Traceback" not in done.output


def test_a_function_that_hangs_is_stopped(file, monkeypatch):
    monkeypatch.setenv("LIEGEN_TOOL_SECONDS", "3")
    done = run(f"{file}:hangs")
    assert done.exit_code == 2
    assert "did not return within 3 s (LIEGEN_TOOL_SECONDS) and was stopped" in done.output


def test_what_a_function_prints_is_not_among_the_results(file):
    command = [
        sys.executable,
        "-m",
        "liegen",
        "check-jacobian",
        "range_r3",
        "--json",
        "--against",
        f"{file}:prints",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "some text" not in done.stdout
    assert "some text" in done.stderr


@needs_compiler
def test_a_library_that_crashes(tmp_path):
    (tmp_path / "mine.c").write_text("int f(void) { int *p = 0; return *(volatile int *)p; }\n")
    compile_shared([tmp_path / "mine.c"], tmp_path / "mine.so", ["-O0"])
    done = run(f"{tmp_path / 'mine.so'}:f")
    assert done.exit_code == 2
    assert "crashed (signal 11, SIGSEGV) at the arguments [" in done.output
