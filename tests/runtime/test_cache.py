"""The folder of compiled factors: who may write there, what is loaded, what else where it cannot be used."""

from __future__ import annotations

import ctypes
import errno
import os
import pickle
import stat
import subprocess
import sys
import tempfile
import warnings
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from runtime_factors import arguments, between, pixel, rotated

import liegen
from compiler_tools import needs_compiler
from liegen import native
from liegen.errors import CacheWarning, CompilerWarning, ToolError
from liegen.runtime import build, cache, compiled

pytestmark = needs_compiler
R, p = arguments(rotated, (4,))[0]
SOURCES = Path(liegen.__file__).parents[1]


@pytest.fixture(autouse=True)
def _quick(monkeypatch):
    monkeypatch.setattr(build, "FLAGS", ("-std=c99", "-O0"))


def works(k):
    quaternion, point = R[0], p[0]
    u, w = quaternion[:3], quaternion[3]
    turned = point + 2 * np.cross(u, np.cross(u, point) + w * point)
    np.testing.assert_allclose(k(R, p)[0], turned, rtol=1e-12)
    return k


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty cache of its own."""
    monkeypatch.setenv("LIEGEN_CACHE_DIR", str(tmp_path / "own"))
    return tmp_path / "own" / cache.FOLDER


@pytest.fixture
def compilations(monkeypatch):
    """The shared objects that were compiled."""
    made = []

    def counted(sources, library, flags):
        made.append(library)
        native.compile_shared(sources, library, flags)

    monkeypatch.setattr(build, "compile_shared", counted)
    return made


def entries(folder):
    return sorted(p.name for p in folder.iterdir())


def test_compiled_once(folder, compilations):
    works(liegen.compile(rotated))
    works(liegen.compile(rotated))
    assert len(compilations) == 1
    assert len(entries(folder)) == 1
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert not compilations[0].parent.exists()
    works(liegen.compile(rotated.vary("R", name="turned")))
    assert len(compilations) == 2


def test_the_key_says_what_it_was_made_from(folder, compilations, monkeypatch):
    works(liegen.compile(rotated))
    monkeypatch.setattr(build, "processor", lambda: "another processor")
    works(liegen.compile(rotated))
    monkeypatch.setattr(build, "compiler_version", lambda command: "another version")
    works(liegen.compile(rotated))
    assert len(compilations) == len(entries(folder)) == 3


@pytest.mark.parametrize("damage", [
    lambda content: content[: len(content) // 2], lambda content: b"", lambda content: content + b"\0",
    lambda content: content[:500] + bytes([content[500] ^ 1]) + content[501:],
])  # fmt: skip
def test_a_damaged_entry_is_made_anew(folder, compilations, damage):
    works(liegen.compile(rotated))
    (name,) = entries(folder)
    content = (folder / name).read_bytes()
    (folder / name).unlink()  # the first one is loaded: do not change it in place
    (folder / name).write_bytes(damage(content))
    works(liegen.compile(rotated))
    assert len(compilations) == 2
    assert entries(folder) == [name]
    assert (folder / name).read_bytes() == content


def test_an_entry_that_others_can_write_or_a_link_is_not_loaded(folder, compilations, tmp_path):
    works(liegen.compile(rotated))
    (name,) = entries(folder)
    (folder / name).chmod(0o666)
    works(liegen.compile(rotated))
    assert len(compilations) == 2
    (folder / name).rename(tmp_path / "elsewhere")
    (folder / name).symlink_to(tmp_path / "elsewhere")
    works(liegen.compile(rotated))
    assert len(compilations) == 3
    assert not (folder / name).is_symlink()


def refused(match):
    with pytest.warns(CacheWarning, match=match) as caught:
        works(liegen.compile(rotated))
    assert caught[0].filename == __file__


@pytest.mark.skipif(os.name != "posix", reason="modes and owners of POSIX")
class TestFolder:
    @pytest.mark.parametrize("mode", [0o777, 0o770, 0o755])
    def test_open_to_others(self, folder, mode):
        folder.mkdir(parents=True)
        folder.chmod(mode)
        refused(rf"open to other users \(mode {mode:o}\); chmod 700")
        assert entries(folder) == []

    def test_of_another_user(self, folder, monkeypatch):
        folder.mkdir(parents=True, mode=0o700)
        other = os.getuid() + 1
        monkeypatch.setattr(os, "getuid", lambda: other)
        refused("belongs to another user")
        assert entries(folder) == []

    def test_a_link(self, folder, tmp_path):
        (tmp_path / "target").mkdir(mode=0o700)
        folder.parent.mkdir()
        folder.symlink_to(tmp_path / "target")
        refused("is a link or a file, not a folder")
        assert entries(tmp_path / "target") == []

    def test_below_a_folder_where_all_can_write(self, folder):
        folder.parent.mkdir()
        folder.parent.chmod(0o777)
        refused("all users can write to .*own; chmod o-w")
        folder.parent.chmod(0o1777)  # as /tmp: nobody can rename what others own
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            works(liegen.compile(rotated))

    def test_below_a_file(self, folder):
        folder.parent.write_text("")
        refused("cannot make the folder")


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_a_full_or_read_only_disk(folder, monkeypatch, code):
    def fail(self, target):
        if folder in Path(target).parents:
            raise OSError(code, os.strerror(code))
        return self.rename(target)

    monkeypatch.setattr(Path, "replace", fail)
    refused(os.strerror(code))
    assert entries(folder) == []


def test_a_disk_without_execution(folder, monkeypatch):
    load = ctypes.CDLL

    def fail(path):
        if folder in Path(path).parents:
            raise OSError("failed to map segment from shared object")
        return load(path)

    monkeypatch.setattr(build.ctypes, "CDLL", fail)
    refused("cannot load from it: failed to map segment")


def test_no_home(monkeypatch, folder):
    monkeypatch.delenv("LIEGEN_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative/paths/do/not/count")

    def fail():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", fail)
    refused("Could not determine home directory")


def test_the_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("LIEGEN_CACHE_DIR", "~/kept")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache.cache_folder() == tmp_path / "kept" / cache.FOLDER
    monkeypatch.delenv("LIEGEN_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.cache_folder() == tmp_path / "xdg" / "liegen" / cache.FOLDER
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(sys, "platform", "linux")
    assert cache.cache_folder() == tmp_path / ".cache" / "liegen" / cache.FOLDER


def child(code, *arguments, **environment):
    env = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(SOURCES), str(Path(__file__).parent)]),
        **environment,
    }
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments], env=env,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


ONE_CALL = """
import liegen, runtime_factors as f
print(liegen.compile(f.rotated, backend="c")(*f.arguments(f.rotated)[0]))
"""


def test_several_processes_at_once(folder):
    children = [child(ONE_CALL, PYTHONWARNINGS="error") for _ in range(3)]
    results = [c.communicate(timeout=120) for c in children]
    assert [c.returncode for c in children] == [0, 0, 0], results
    assert len({out for out, _ in results}) == 1
    names = entries(folder)
    assert len({name.split("-")[0] for name in names}) == 1
    assert not [name for name in names if name.startswith(".")]


# --- compilers --------------------------------------------------------------------------------------------


def script(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


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


# --- pickles ----------------------------------------------------------------------------------------------


def test_pickles_in_one_process(compilations):
    k = liegen.compile(between)
    before = len(compilations)
    again = pickle.loads(pickle.dumps(k))
    assert again == k
    assert hash(again) == hash(k)
    assert len(compilations) == before
    variables, given = arguments(between, (3,))
    for name in ("jacobians", "status"):
        method = pickle.loads(pickle.dumps(getattr(k, name)))
        for a, b in zip(method(*variables, **given), getattr(k, name)(*variables, **given), strict=True):
            np.testing.assert_array_equal(a, b)
    made = k.jacobians(*variables, **given)
    copy = pickle.loads(pickle.dumps(made))
    assert type(copy) is type(made)
    np.testing.assert_array_equal(copy.res_D_y, made.res_D_y)
    assert k != liegen.compile(between, backend="numpy")
    assert len(pickle.dumps(k)) < 60_000


UNPICKLE = """
import pickle, sys
k, arrays = pickle.load(sys.stdin.buffer)
import numpy as np
print(k.backend, k(*arrays).tolist(), "casadi" in sys.modules)
"""


@pytest.mark.parametrize("place", ["same cache", "empty cache", "no compiler"])
def test_pickles_in_another_process(kept, tmp_path, place):
    k = liegen.compile(rotated)
    environment = {"LIEGEN_CACHE_DIR": str(kept if place == "same cache" else tmp_path)}
    if place == "no compiler":
        environment |= {"PATH": str(tmp_path), "CC": ""}
    process = child(UNPICKLE, **environment)
    out, err = process.communicate(pickle.dumps((k, (R[0], p[0]))), timeout=120)
    assert process.returncode == 0, err
    backend, rest = out.decode().split(" ", 1)
    zig = native.importlib.util.find_spec("ziglang")
    assert backend == ("numpy" if place == "no compiler" and not zig else "c")
    np.testing.assert_allclose(eval(rest.rsplit(" ", 1)[0]), k(R[0], p[0]), rtol=1e-12)


def test_a_pickle_of_another_version():
    k = liegen.compile(pixel)
    function, (name, digest, packed, asked) = k.__reduce__()
    other = replace(k.source, floats=f"{k.source.floats}\n")
    with pytest.raises(ToolError, match="pixel was pickled by another version"):
        function(name, digest, zlib.compress(pickle.dumps(other)), asked)
    with pytest.raises(ToolError, match=r"pixel was pickled by another version of liegen; call liegen\.comp"):
        function(name, digest[::-1], packed, asked)
    with pytest.raises(ToolError, match="pixel was pickled by another version"):
        compiled.restored(name, digest, packed[:-5], asked)
