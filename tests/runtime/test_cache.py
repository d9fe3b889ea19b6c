"""The folder of compiled factors: who may write there, what is loaded, what else where it cannot be used."""

from __future__ import annotations

import ctypes
import errno
import os
import stat
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest
from runtime_factors import rotated
from runtime_tools import R, child, entries, p, works

import liegen
from compiler_tools import needs_compiler
from liegen import R3, SO3, function, temporary
from liegen.errors import CacheWarning, ToolError
from liegen.runtime import build, cache

pytestmark = [needs_compiler, pytest.mark.usefixtures("quick_builds")]


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


@pytest.mark.parametrize(("place", "reason"), [
    ("n" * 300, "File name too long"), ("d/" * 3000, "File name too long"),
    ("line\nfeed\x1b[31m/file/deeper", "Not a directory"),
])  # fmt: skip
def test_odd_places_are_told_in_one_short_line(place, reason, monkeypatch, tmp_path):
    (tmp_path / "line\nfeed\x1b[31m").mkdir()
    (tmp_path / "line\nfeed\x1b[31m" / "file").write_text("")
    monkeypatch.setenv("LIEGEN_CACHE_DIR", f"{tmp_path}/{place}")
    with pytest.warns(CacheWarning, match="compiled factors are not kept: cannot make the folder") as caught:
        works(liegen.compile(rotated))
    (message,) = (str(warning.message) for warning in caught)
    assert message.endswith(reason)
    assert len(message) < 500
    assert "\n" not in message
    assert "\x1b" not in message


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


# --- what others left or put there -----------------------------------------------------------------------


@pytest.mark.skipif(os.name != "posix", reason="pipes of POSIX")
def test_a_pipe_in_place_of_an_entry_is_not_waited_for(folder, compilations):
    works(liegen.compile(rotated))
    (name,) = entries(folder)
    (folder / name).unlink()
    os.mkfifo(folder / name, 0o600)
    works(liegen.compile(rotated))
    assert len(compilations) == 2
    assert (folder / name).is_file()


def key_of(name):
    return name.partition("-")[0]


def mine_and_theirs(folder, other):
    """The entries of ``rotated``, which is removed, and of another function."""
    works(liegen.compile(rotated))
    (mine,) = entries(folder)
    liegen.compile(other)
    (theirs,) = set(entries(folder)) - {mine}
    (folder / mine).unlink()
    return mine, theirs


def test_an_entry_of_another_key_is_not_loaded(folder, compilations):
    """A whole library, but of another factor: its name says so, whatever it is renamed to."""
    mine, theirs = mine_and_theirs(folder, rotated.vary("R", name="turned"))
    (folder / theirs).rename(folder / f"{key_of(mine)}-{theirs.partition('-')[2]}")
    works(liegen.compile(rotated))
    assert len(compilations) == 3


def same_name():
    """Another function of the name, so that its library has the same functions."""

    @function
    def rotated(R: SO3, p: R3):
        return R @ (2 * p)

    return rotated


def test_another_formula_of_the_same_name(folder, compilations):
    k = liegen.compile(same_name())
    works(liegen.compile(rotated))
    assert len(compilations) == 2
    np.testing.assert_allclose(k(R, p), 2 * liegen.compile(rotated)(R, p), rtol=1e-12)


def test_the_library_of_another_formula_is_not_loaded(folder, compilations):
    mine, theirs = mine_and_theirs(folder, same_name())
    (folder / theirs).rename(folder / f"{key_of(mine)}-{theirs.partition('-')[2]}")
    works(liegen.compile(rotated))
    assert len(compilations) == 3


def test_a_library_without_the_functions_is_made_anew(folder, compilations):
    """Even one whose name is right."""
    mine, theirs = mine_and_theirs(folder, rotated.vary("R", name="turned"))
    content = (folder / theirs).read_bytes()
    forged = folder / f"{cache.entry_name(key_of(mine), content)}{cache.SUFFIX}"
    forged.write_bytes(content)
    forged.chmod(0o600)
    works(liegen.compile(rotated))
    assert len(compilations) == 3
    assert not forged.exists()


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
def test_folders_of_dead_processes_are_removed(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    dead = os.fork()
    if not dead:
        os._exit(0)
    os.waitpid(dead, 0)
    here = temporary.machine()
    gone = [f"{build.WORK}{here}-{dead}-abc", f"{build.WORK}elsewhere-1-old"]
    stay = [f"{build.WORK}{here}-{os.getpid()}-abc", f"{build.WORK}elsewhere-{dead}-new", f"{build.WORK}x"]
    for name in (*gone, *stay):
        (tmp_path / name / "deep").mkdir(parents=True)
    os.utime(tmp_path / gone[1], (0, 0))
    works(liegen.compile(rotated))
    left = entries(tmp_path)
    assert not set(gone) & set(left)
    assert set(stay) <= set(left)
    assert len([name for name in left if name.startswith(build.WORK)]) == len(stay)


def test_no_temporary_folder(folder, monkeypatch):
    def fail(*args, **named):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "mkdtemp", fail)
    cache.private_folder.cache_clear()
    with pytest.raises(ToolError, match=r"rotated: .* can neither be kept .*No space left .* TMPDIR to a"):
        liegen.compile(rotated)
