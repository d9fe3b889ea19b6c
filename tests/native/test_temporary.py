"""Temporary folders: they end with their process, or with the next one; no room for them is said."""

import errno
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from compiler_tools import needs_compiler
from liegen.cli import app
from liegen.errors import ToolError
from liegen.temporary import OLD, machine, temporary_folder, working_folder

pytestmark = pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")


@pytest.fixture
def top(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def dead() -> int:
    """The number of a process that has ended."""
    pid = os.fork()
    if not pid:
        os._exit(0)
    os.waitpid(pid, 0)
    return pid


def test_folders_of_dead_processes_are_removed(top):
    gone = [f"test-{machine()}-{dead()}-abc", "test-elsewhere-1-old"]
    stay = [f"test-{machine()}-{os.getpid()}-abc", "test-elsewhere-1-new", "test-", "test-x", "other-1-2"]
    stay.append(f"test-{machine()}-no_number-abc")
    for name in (*gone, *stay):
        (top / name / "deep").mkdir(parents=True)
    os.utime(top / gone[1], (0, 0))
    made = temporary_folder("test-")
    assert sorted(p.name for p in top.iterdir()) == sorted([*stay, made.name])
    assert made.stat().st_mode & 0o777 == 0o700


def test_links_and_files_are_left_alone(top):
    (top / "precious").mkdir()
    (top / f"test-{machine()}-{dead()}-link").symlink_to(top / "precious")
    (top / f"test-{machine()}-{dead()}-file").write_text("mine")
    before = set(top.iterdir())
    with working_folder("test-") as folder:
        assert set(top.iterdir()) == {*before, folder}
    assert set(top.iterdir()) == before
    assert OLD > 60


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EROFS])
def test_no_room(code, top):
    with pytest.raises(ToolError, match=r"cannot write temporary files: .*TMPDIR"), working_folder("test-"):
        raise OSError(code, os.strerror(code))
    assert not list(top.iterdir())


def test_errors_of_other_files_pass(top):
    with pytest.raises(FileNotFoundError), working_folder("test-"):
        Path(top / "nosuch").read_text()
    told = pytest.raises(ToolError, match="cannot write temporary files: Is a directory")
    with told, working_folder("test-") as folder:
        folder.write_text("x")


# --- commands that compile --------------------------------------------------------------------------------

RUBBISH = 'while [ $# -gt 0 ]; do if [ "$1" = -o ]; then echo rubbish > "$2"; fi; shift; done'
#: What is in CC, {script} for a shell script of that text, and what is said.
BAD = {
    "open quote": ("cc 'open", "", "No closing quotation"),
    "no program": ("nosuch", "", "CC=nosuch: no program of that name was found"),
    "writes nothing": ("{script}", "exit 0", "mycc reports no error but writes nothing"),
    "writes rubbish": ("{script}", RUBBISH, "mycc made a shared object that cannot be loaded"),
    "no text": (
        "{script}",
        r"printf '\377\376 error \200\033[31m' >&2; exit 1",
        "mycc does not compile the C",
    ),
    "hangs": ("{script}", "sleep 60", "did not end within 0.3 s"),
}


@needs_compiler
@pytest.mark.parametrize("kind", BAD)
def test_verify_with_a_bad_compiler(kind, top, monkeypatch):
    value, text, message = BAD[kind]
    script = top / "mycc"
    script.write_text(f"#!/bin/sh\n{text}\n")
    script.chmod(0o755)
    monkeypatch.setenv("CC", value.format(script=script))
    monkeypatch.setenv("LIEGEN_TOOL_SECONDS", "0.3" if kind == "hangs" else "60")
    done = CliRunner().invoke(app, ["verify", "-f", "prior_r2", "--samples", "2"])
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stderr.startswith("Error: ")
    assert done.stderr.count("\n") == 1
    assert "\033" not in done.stderr
    assert [p.name for p in top.iterdir()] == ["mycc"]


@needs_compiler
def test_the_next_run_removes_what_a_killed_one_left(top):
    script = top / "mycc"
    script.write_text("#!/bin/sh\nexec sleep 5\n")
    script.chmod(0o755)
    command = [sys.executable, "-m", "liegen", "verify", "-f", "prior_r2"]
    run = subprocess.Popen(command, env={**os.environ, "TMPDIR": str(top), "CC": str(script)})
    until = time.monotonic() + 60
    while not list(top.glob("liegen-verify-*/c/*.c")) and time.monotonic() < until:
        time.sleep(0.05)
    run.kill()
    run.wait()
    assert len(list(top.glob("liegen-verify-*"))) == 1
    done = CliRunner().invoke(app, ["verify", "-f", "prior_r2", "--samples", "2"])
    assert done.exit_code == 0
    assert [p.name for p in top.iterdir()] == ["mycc"]


def test_verify_without_room(top, monkeypatch):
    def full(*args, **named):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "mkdtemp", full)
    done = CliRunner().invoke(app, ["verify", "-f", "prior_r2", "--samples", "2"])
    assert done.exit_code == 2
    assert "Error: cannot write temporary files: No space left on device; make room, or name" in done.stderr
