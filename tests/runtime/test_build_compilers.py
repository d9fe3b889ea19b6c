"""Which compiler is taken, and what is said where it fails or there is none."""

from __future__ import annotations

import os
import sys
import tempfile
import warnings
from pathlib import Path

import pytest
from runtime_factors import rotated
from runtime_tools import entries, script, works

import liegen
from compiler_tools import needs_compiler
from liegen import native
from liegen.errors import CompilerWarning, ToolError

pytestmark = [needs_compiler, pytest.mark.usefixtures("quick_builds")]


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
def test_a_compiler_that_fails(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", script(tmp_path / "mycc", "echo 'licence expired' >&2; exit 3"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(ToolError, match=r"(?s)rotated: .*mycc does not .*licence expired.*kept in ") as info:
        liegen.compile(rotated)
    kept = Path(str(info.value).rsplit("kept in ", 1)[1])
    assert "rotated_batch(" in (kept / "rotated_loops.c").read_text()
    assert not folder.exists() or entries(folder) == []


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
def test_a_compiler_that_does_not_know_the_processor(folder, tmp_path, monkeypatch):
    real = " ".join(native.find_compiler())
    refuses = f'case "$*" in *march=native*) echo unknown >&2; exit 1;; esac; exec {real} "$@"'
    monkeypatch.setenv("CC", script(tmp_path / "oldcc", refuses))
    works(liegen.compile(rotated))


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
def test_a_compiler_that_writes_rubbish(folder, tmp_path, monkeypatch):
    rubbish = 'while [ $# -gt 0 ]; do if [ "$1" = -o ]; then echo rubbish > "$2"; fi; shift; done'
    monkeypatch.setenv("CC", script(tmp_path / "mycc", rubbish))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ToolError, match=r"what .*mycc made can neither be kept nor loaded: .*Set CC to"):
            liegen.compile(rotated)


@pytest.mark.skipif(os.name != "posix", reason="a shell script")
def test_a_compiler_that_makes_another_library(folder, tmp_path, monkeypatch):
    real = " ".join(native.find_compiler())
    (tmp_path / "other.c").write_text("int other;\n")
    other = (
        'for a; do if [ "$p" = -o ]; then out="$a"; fi; p="$a"; done\n'
        f'case "$*" in *" -shared "*) exec {real} -shared -fPIC -o "$out" {tmp_path}/other.c;; esac\n'
        f'exec {real} "$@"'
    )
    monkeypatch.setenv("CC", script(tmp_path / "mycc", other))
    with pytest.raises(ToolError, match=r"rotated: .*mycc made a library without its functions"):
        liegen.compile(rotated)


@pytest.mark.slow
def test_the_compiler_of_the_package_ziglang(folder, monkeypatch):
    pytest.importorskip("ziglang")
    monkeypatch.setenv("CC", f"{sys.executable} -m ziglang cc")
    assert works(liegen.compile(rotated)).backend == "c"


@pytest.fixture
def no_compiler(monkeypatch, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(native.importlib.util, "find_spec", lambda name: None)


def test_without_a_compiler(no_compiler):
    with pytest.warns(CompilerWarning, match="no C compiler was found") as caught:
        k = works(liegen.compile(rotated))
    assert caught[0].filename == __file__
    assert k.backend == "numpy"
    with pytest.raises(ToolError, match="no C compiler was found"):
        liegen.compile(rotated, backend="c")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert works(liegen.compile(rotated, backend="numpy")).backend == "numpy"


def test_zig_is_found_last(no_compiler, monkeypatch, tmp_path):
    monkeypatch.setattr(native.importlib.util, "find_spec", lambda name: name == "ziglang" or None)
    assert native.find_compiler() == (sys.executable, "-m", "ziglang", "cc")
    script(tmp_path / "zig", "")
    assert native.find_compiler() == ("zig", "cc")
    script(tmp_path / "clang", "")
    assert native.find_compiler() == ("clang",)
