"""Other programs: time limits, process groups, whatever they print, what a terminal is told."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from liegen import subprocesses
from liegen.errors import ToolError
from liegen.native import compile_shared, compiler_version, find_compiler, load_shared
from liegen.subprocesses import run, run_all

pytestmark = pytest.mark.skipif(os.name != "posix", reason="shell scripts")

SOURCES = str(Path(subprocesses.__file__).parents[1])


def script(path: Path, text: str) -> str:
    path.write_bytes(f"#!/bin/sh\n{text}\n".encode("utf-8", "surrogateescape"))
    path.chmod(0o755)
    return str(path)


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits for its parent does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def gone(pid: int) -> bool:
    for _ in range(200):
        if not alive(pid):
            return True
        time.sleep(0.01)
    return False


def test_output_is_text_whatever_the_bytes():
    done = run(["sh", "-c", r"printf 'a\377b\n'; printf '\033[31merror: bad\007\n' >&2; exit 3"])
    assert (done.code, done.out) == (3, "a\ufffdb\n")
    assert done.reason == r"\x1b[31merror: bad\x07"


@pytest.mark.parametrize(("command", "reason"), [
    ("echo first; echo 'x.c:3: error: this' >&2; exit 1", "x.c:3: error: this"),
    ("echo first; exit 1", "first"),
    ("exit 4", "exit code 4, and it printed nothing"),
    ("kill -9 $$", "ended by signal 9, and it printed nothing"),
])  # fmt: skip
def test_the_reason_is_one_line(command, reason):
    assert run(["sh", "-c", command]).reason == reason


def test_a_long_line_is_shortened():
    assert len(run(["sh", "-c", "yes | head -c 100000 | tr -d '\\n'; exit 1"]).reason) < 410


def test_nothing_is_read_from_the_caller():
    assert run(["cat"]).out == ""


def test_a_time_limit_ends_the_whole_group(tmp_path):
    pid = tmp_path / "pid"
    with pytest.raises(ToolError, match=r"sh -c .* did not end within 0.3 s and was stopped"):
        run(["sh", "-c", f"sleep 60 & echo $! > {pid}; wait"], limit=0.3)
    assert gone(int(pid.read_text()))


def test_what_a_program_leaves_behind_ends_with_it(tmp_path):
    pid = tmp_path / "pid"
    start = time.monotonic()
    assert run(["sh", "-c", f"sleep 60 & echo $! > {pid}"], limit=20).code == 0
    assert time.monotonic() - start < 10
    assert gone(int(pid.read_text()))


def test_output_without_end(monkeypatch):
    monkeypatch.setattr(subprocesses, "MOST_OUTPUT", 1 << 20)
    with pytest.raises(ToolError, match="printed more than 1 MiB and was stopped"):
        run(["yes"], limit=60)


def test_a_program_that_is_not_there(tmp_path):
    with pytest.raises(ToolError, match="nosuch cannot be run: No such file"):
        run([str(tmp_path / "nosuch")])
    with pytest.raises(ToolError, match=r"cannot be run: .*null byte"):
        run(["sh\0"])


def test_some_at_once_and_none_after_a_failure(tmp_path):
    """The first waits until the second has failed, so they run at once; the others are not started."""
    log, failed = tmp_path / "log", tmp_path / "failed"
    waits = f"echo 0 >> {log}; while [ ! -e {failed} ]; do sleep 0.05; done; sleep 0.3"
    fails = f"echo 1 >> {log}; touch {failed}; exit 1"
    others = [["sh", "-c", f"echo {k} >> {log}"] for k in (2, 3, 4)]
    done = run_all([["sh", "-c", waits], ["sh", "-c", fails], *others], at_once=2, limit=60)
    assert [d.code for d in done] == [0, 1]
    assert sorted(log.read_text().split()) == ["0", "1"]


@pytest.mark.parametrize("text", ["0", "-1", "soon", "inf", "nan"])
def test_the_limit_of_the_environment(text, monkeypatch):
    monkeypatch.setenv(subprocesses.LIMIT_VARIABLE, text)
    with pytest.raises(ToolError, match=f"LIEGEN_TOOL_SECONDS={text} is no number of seconds above 0"):
        run(["true"])
    monkeypatch.setenv(subprocesses.LIMIT_VARIABLE, "0.2")
    with pytest.raises(ToolError, match=r"did not end within 0\.2 s"):
        run(["sleep", "60"])


INTERRUPTED = """
import sys
from liegen.subprocesses import run_all
command = ["sh", "-c", f"sleep 60 & echo $! >> {sys.argv[1]}; wait"]
run_all([command, command], at_once=2)
"""


def test_an_interrupt_ends_all_of_them(tmp_path):
    pids = tmp_path / "pids"
    child = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, str(pids)], env={**os.environ, "PYTHONPATH": SOURCES},
        stderr=subprocess.PIPE,
    )  # fmt: skip
    for _ in range(1000):
        if pids.exists() and len(pids.read_text().split()) == 2:
            break
        time.sleep(0.02)
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=20)
    assert b"KeyboardInterrupt" in err
    assert all(gone(int(pid)) for pid in pids.read_text().split())


class Screen:
    """Standard error as a pseudo-terminal, and what was written to it."""

    def __init__(self, monkeypatch):
        self.read, write = pty.openpty()
        monkeypatch.setattr(sys, "stderr", os.fdopen(write, "w"))

    def text(self):
        sys.stderr.close()
        try:
            return os.read(self.read, 1000).decode()
        except OSError:  # nothing was written
            return ""


@pytest.mark.parametrize(("notice", "told"), [(0.05, "compiling between_se3 ..."), (30.0, "")])
def test_a_terminal_is_told_what_is_waited_for(notice, told, monkeypatch):
    monkeypatch.setattr(subprocesses, "NOTICE", notice)
    screen = Screen(monkeypatch)
    run(["sleep", "0.3"], what="compiling between_se3")
    assert screen.text().strip() == told


def test_a_file_is_told_nothing(monkeypatch, capsys):
    monkeypatch.setattr(subprocesses, "NOTICE", 0.05)
    run(["sleep", "0.3"], what="compiling between_se3")
    assert capsys.readouterr().err == ""


# --- $CC --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("value", "message"), [
    ("nosuch", "CC=nosuch: no program of that name was found; correct CC, or unset it"),
    ("nosuch\x1b[31m -O2", r"CC=nosuch\\x1b\[31m -O2: no program"),
    ("gcc 'open", "CC=gcc 'open: No closing quotation; correct CC, or unset it"),
    ("'' -O2", "no program of that name"),
    ("/", "CC=/: no program of that name"),
])  # fmt: skip
def test_a_compiler_that_is_named_wrongly(value, message, monkeypatch):
    monkeypatch.setenv("CC", value)
    with pytest.raises(ToolError, match=message):
        find_compiler()


def test_a_blank_name_is_none(monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    wanted = find_compiler()
    monkeypatch.setenv("CC", "  ")
    assert find_compiler() == wanted


BAD_COMPILERS = {
    "writes nothing": ("exit 0", "reports no error but writes nothing, so it is no C compiler"),
    "fails in silence": ("exit 7", "does not compile the C: exit code 7, and it printed nothing"),
    "no text": (r"printf '\377\376 error \200' >&2; exit 1", "does not compile the C: \ufffd\ufffd error"),
    "dies": ("kill -11 $$", "does not compile the C: ended by signal 11"),
    "hangs": ("sleep 60", "did not end within 0.3 s"),
}


@pytest.mark.parametrize("kind", BAD_COMPILERS)
def test_a_compiler_that_is_none(kind, tmp_path, monkeypatch):
    text, message = BAD_COMPILERS[kind]
    monkeypatch.setenv("CC", script(tmp_path / "mycc", text))
    monkeypatch.setenv(subprocesses.LIMIT_VARIABLE, "0.3" if kind == "hangs" else "60")
    (tmp_path / "a.c").write_text("int a;\n")
    with pytest.raises(ToolError, match=message) as raised:
        compile_shared([tmp_path / "a.c"], tmp_path / "a.so", ())
    assert "mycc" in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_shared_object_that_is_none(tmp_path):
    (tmp_path / "a.so").write_text("rubbish")
    with pytest.raises(ToolError, match=r"made a shared object that cannot be loaded \(.*; set CC to a comp"):
        load_shared(tmp_path / "a.so")


def test_a_compiler_that_does_not_say_its_version(tmp_path, monkeypatch):
    assert compiler_version((script(tmp_path / "silent", "exit 1"),)) == ""
    assert compiler_version((script(tmp_path / "odd", r"printf '\377'"),)) == "\ufffd"
    monkeypatch.setattr("liegen.native.QUICK_LIMIT", 0.2)
    told = r"--version did not end within 0\.2 s and was stopped; set CC to use another compiler"
    with pytest.raises(ToolError, match=told):
        compiler_version((script(tmp_path / "hangs", "sleep 60"),))
    monkeypatch.setenv(subprocesses.LIMIT_VARIABLE, "0.1")
    with pytest.raises(ToolError, match=r"--version did not end within 0\.1 s"):
        compiler_version((str(tmp_path / "hangs"), "again"))
