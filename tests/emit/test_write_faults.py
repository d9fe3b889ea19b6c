"""Writing is all or nothing whichever call of the system fails, and whenever the process is killed."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from pathlib import Path

import pytest
from emit_kernels import between_r2, examples, wheel_step
from emit_tools import REGENERATE
from fault_tools import Counter, Killer, Watch, forked, watched

from liegen.emit import check_tree, journal, render, write_tree
from liegen.errors import OutputError

pytestmark = pytest.mark.skipif(os.name != "posix", reason="calls of POSIX")

Files = dict[str, str]
CHATTR = shutil.which("chattr")


def files_of(kernels, targets):
    return render(kernels, targets, package="demo", regenerate=REGENERATE)


@pytest.fixture
def tmp_path(tmp_path):
    """In memory where that can be: the tests below make many small trees."""
    memory = Path("/dev/shm")
    if not (memory.is_dir() and os.access(memory, os.W_OK)):
        yield tmp_path
        return
    with tempfile.TemporaryDirectory(dir=memory) as name:
        yield Path(name)


@pytest.fixture(scope="module")
def trees() -> dict[str, tuple[Files, Files]]:
    """Two changes: one makes a folder and replaces files, one takes a folder and files away."""
    small, large = files_of([wheel_step()], ("numpy",)), files_of(examples(), ("numpy", "c"))
    other = files_of([between_r2()], ("numpy",))
    return {"grows": (small, large), "shrinks": (large, other)}


CHANGES = ("grows", "shrinks")


def snapshot(directory: Path) -> dict[str, bytes | str | None]:
    """Every path with its bytes, its target for a link, None for a folder; without stages."""
    found = {}
    for path in sorted(directory.rglob("*")):
        name = path.relative_to(directory).as_posix()
        if not name.startswith(journal.PREFIX):
            content = path.read_bytes() if path.is_file() else None
            found[name] = str(path.readlink()) if path.is_symlink() else content
    return found


def stages(directory: Path) -> list[str]:
    return [p.name for p in directory.iterdir() if p.name.startswith(journal.PREFIX)]


def fresh(directory: Path, old: Files) -> Path:
    """The old tree, a file changed by hand, two replaced by links: to nothing, and to a file elsewhere."""
    write_tree(old, directory)
    (directory / "demo" / "__init__.py").write_text("changed by hand")
    (directory / "demo" / "_support.py").unlink()
    (directory / "demo" / "_support.py").symlink_to("nowhere")
    (directory.parent / "precious").write_text("mine")
    (directory / "demo" / "py.typed").unlink()
    (directory / "demo" / "py.typed").symlink_to(directory.parent / "precious")
    return directory


def events(tmp_path: Path, change: tuple[Files, Files], monkeypatch) -> list[str]:
    counter = Counter()
    place = fresh(tmp_path / "counted", change[0])
    with watched(counter, place, monkeypatch):
        write_tree(change[1], place)
    return counter.events


def calls(tmp_path: Path, change: tuple[Files, Files], monkeypatch) -> int:
    return len(events(tmp_path, change, monkeypatch))


def refusal(fails: Watch, place: Path, files: Files, monkeypatch) -> str:
    """What is said of a run some of whose calls fail, empty where it succeeds."""
    try:
        with watched(fails, place, monkeypatch):
            write_tree(files, place)
    except OutputError as error:
        return str(error)
    return ""


def expected(tmp_path: Path, files: Files) -> dict[str, bytes | str | None]:
    write_tree(files, tmp_path / "expected")
    return snapshot(tmp_path / "expected")


@pytest.mark.parametrize("change", CHANGES)
def test_every_call_fails_once(change, trees, tmp_path, monkeypatch):
    old, new = trees[change]
    after, total = expected(tmp_path, new), calls(tmp_path, trees[change], monkeypatch)
    assert total > 60
    failed = 0
    for k in range(1, total + 1):
        place = fresh(tmp_path / f"{k}", old)
        before = snapshot(place)
        code = (errno.ENOSPC, errno.EACCES, errno.EIO)[k % 3]
        told = refusal(Counter(k, k, code), place, new, monkeypatch)
        assert snapshot(place) == (before if told else after), (k, told)
        if told:
            failed += 1
            assert "nothing was changed" in told
            assert os.strerror(code) in told
            assert journal.PREFIX not in told
            assert stages(place) == []
        write_tree(new, place)
        assert snapshot(place) == after
        assert stages(place) == []
    assert failed > total / 2
    assert (tmp_path / "precious").read_text() == "mine"
    assert (tmp_path / "precious").stat().st_nlink == 1


@pytest.mark.parametrize("change", CHANGES)
def test_every_call_fails_from_some_moment_on(change, trees, tmp_path, monkeypatch):
    """A disk that breaks: what is said is true, and the next run puts back what this one could not."""
    old, new = trees[change]
    after, total = expected(tmp_path, new), calls(tmp_path, trees[change], monkeypatch)
    half_written = 0
    for k in range(1, total + 1):
        place = fresh(tmp_path / f"{k}", old)
        before = snapshot(place)
        told = refusal(Counter(k, 10**9, errno.EIO), place, new, monkeypatch)
        if told:
            assert ("nothing was changed" in told) == (snapshot(place) == before), (k, told)
            if snapshot(place) != before:
                half_written += 1
                assert "These could not be put back, so the folder is half written" in told
            with journal.locked(place):
                journal.recovered(place)
            assert snapshot(place) == before, (k, told)
        else:
            assert snapshot(place) == after, k
        write_tree(new, place)
        assert snapshot(place) == after
        assert stages(place) == []
    assert half_written > 5


def killed_and_recovered(place: Path, old: Files, new: Files, after, at: int, monkeypatch) -> bool:
    """Whether the tree was put back, not new; kills a run at a call, then checks the next runs."""
    fresh(place, old)
    before = snapshot(place)

    def run():
        with watched(Killer(at), place, monkeypatch):
            write_tree(new, place)

    assert forked(run) == signal.SIGKILL
    with journal.locked(place):
        journal.recovered(place)
    found = snapshot(place)
    assert found in (before, after), at
    assert stages(place) == []
    write_tree(new, place)
    assert snapshot(place) == after
    return found == before


@pytest.mark.parametrize("change", CHANGES)
def test_killed_at_some_calls(change, trees, tmp_path, monkeypatch):
    total = calls(tmp_path, trees[change], monkeypatch)
    after = expected(tmp_path, trees[change][1])
    moments = sorted({1, 2, total - 1, total, *range(5, total, total // 8)})
    back = [killed_and_recovered(tmp_path / f"{k}", *trees[change], after, k, monkeypatch) for k in moments]
    assert back[0]
    assert not back[-1]


@pytest.mark.slow
@pytest.mark.parametrize("change", CHANGES)
def test_killed_at_every_call(change, trees, tmp_path, monkeypatch):
    after = expected(tmp_path, trees[change][1])
    for k in range(1, calls(tmp_path, trees[change], monkeypatch) + 1):
        killed_and_recovered(tmp_path / f"{k}", *trees[change], after, k, monkeypatch)


def test_killed_while_it_makes_the_first_tree(trees, tmp_path, monkeypatch):
    new, moment, ended, nothing = trees["grows"][0], 1, False, 0
    after = expected(tmp_path, new)

    def run(place, at):
        with watched(Killer(at), place, monkeypatch):
            write_tree(new, place)

    while not ended:
        place = tmp_path / f"{moment}" / "made" / "too"
        ended = forked(lambda: run(place, moment)) == 0  # noqa: B023
        if place.exists():
            with journal.locked(place):
                journal.recovered(place)
            assert snapshot(place) in ({}, after), moment
            nothing += snapshot(place) == {}
        write_tree(new, place)
        assert snapshot(place) == after
        assert stages(place) == []
        moment += 1
    assert moment > 30
    assert nothing > 20


@pytest.mark.parametrize("change", CHANGES)
def test_killed_while_it_recovers(change, trees, tmp_path, monkeypatch):
    old, new = trees[change]
    moves = [
        k for k, event in enumerate(events(tmp_path, trees[change], monkeypatch), 1) if event == "os.rename"
    ]
    at = moves[len(moves) // 2]

    def run(place):
        with watched(Killer(at), place, monkeypatch):
            write_tree(new, place)

    def recover(place, at):
        with watched(Killer(at), place, monkeypatch), journal.locked(place):
            journal.recovered(place)

    moment, ended = 1, False
    while not ended:
        place = fresh(tmp_path / f"{moment}", old)
        before = snapshot(place)
        assert forked(lambda: run(place)) == signal.SIGKILL  # noqa: B023
        assert snapshot(place) != before
        ended = forked(lambda: recover(place, moment)) == 0  # noqa: B023
        with journal.locked(place):
            journal.recovered(place)
        assert snapshot(place) == before, moment
        assert stages(place) == []
        moment += 4
    assert moment > 20


@pytest.mark.slow
def test_killed_at_random_moments(trees, tmp_path):
    """By the clock, wherever the process then is."""
    old, new = trees["grows"]
    after = expected(tmp_path, new)
    found = set()
    for k in range(50):
        place = fresh(tmp_path / f"{k}", old)
        before = snapshot(place)
        pid = os.fork()
        if not pid:
            try:
                while True:
                    write_tree(new, place)
                    write_tree(old, place)
            finally:
                os._exit(1)
        time.sleep(0.002 * k)
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        with journal.locked(place):
            journal.recovered(place)
        found.add(str(snapshot(place)))
        write_tree(old, place)
        assert snapshot(place).keys() == before.keys()
        write_tree(new, place)
        assert snapshot(place) == after
    assert len(found) <= 3  # as changed by hand, old, new


def test_an_interrupt_puts_everything_back(trees, tmp_path, monkeypatch):
    place = fresh(tmp_path / "out", trees["grows"][0])
    before = snapshot(place)
    moves = 0

    def interrupt(event, path, to):
        nonlocal moves
        moves += event == "os.rename"
        if moves == 5:
            moves += 1
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), watched(interrupt, place, monkeypatch):
        write_tree(trees["grows"][1], place)
    assert snapshot(place) == before
    assert stages(place) == []


# --- the next run -----------------------------------------------------------------------------------------


def test_folders_of_dead_runs_are_swept_and_others_are_not(trees, tmp_path):
    old, _ = trees["grows"]
    for name in (".liegen-abcdefgh", ".liegen-12345678"):
        (tmp_path / name / "new" / "demo").mkdir(parents=True)
    (tmp_path / ".liegen-notes").mkdir()
    (tmp_path / ".liegen-mine____").mkdir()
    (tmp_path / ".liegen-mine____" / "diary.txt").write_text("mine")
    done = write_tree(old, tmp_path)
    assert done.undone
    assert sorted(stages(tmp_path)) == [".liegen-mine____", ".liegen-notes"]
    assert not write_tree(old, tmp_path).undone


@pytest.mark.parametrize("text", [
    "", "[]", "{}", '{"format": "other"}', "[" * 100_000,
    '{"format": "liegen journal 1", "fresh": ["../precious"], "removed": [], "had": [], "made": []}',
    '{"format": "liegen journal 1", "fresh": ["/etc/passwd"], "removed": [], "had": [], "made": []}',
    '{"format": "liegen journal 1", "fresh": [], "removed": [], "had": [], "made": [".."]}',
    '{"format": "liegen journal 1", "fresh": 3, "removed": [], "had": [], "made": []}',
])  # fmt: skip
def test_a_journal_that_liegen_did_not_write_is_never_followed(text, trees, tmp_path):
    (tmp_path / "precious").write_text("mine")
    stage = tmp_path / "out" / ".liegen-abcdefgh"
    stage.mkdir(parents=True)
    (stage / journal.JOURNAL).write_text(text)
    with pytest.raises(OutputError, match=r"was killed while it wrote to .* cannot be put back"):
        write_tree(trees["grows"][0], tmp_path / "out")
    assert (tmp_path / "precious").read_text() == "mine"
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [stage.name]


def test_what_a_journal_names_is_not_sought_behind_a_link(trees, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "precious.c").write_text("mine")
    stage = tmp_path / "out" / ".liegen-abcdefgh"
    stage.mkdir(parents=True)
    (tmp_path / "out" / "c").symlink_to(tmp_path / "elsewhere")
    (stage / journal.JOURNAL).write_text(
        '{"format": "liegen journal 1", "fresh": ["c/precious.c"], "removed": [], "had": [], "made": []}'
    )
    with pytest.raises(OutputError, match=r"c/precious\.c: c is a link"):
        write_tree(trees["grows"][0], tmp_path / "out")
    assert (tmp_path / "elsewhere" / "precious.c").read_text() == "mine"


# --- two at once ------------------------------------------------------------------------------------------


def test_the_second_waits(trees, tmp_path):
    old, new = trees["grows"]
    write_tree(old, tmp_path)
    ready, go = threading.Event(), threading.Event()

    def hold():
        with journal.locked(tmp_path):
            ready.set()
            go.wait(10)

    holder = threading.Thread(target=hold)
    holder.start()
    ready.wait(10)
    threading.Timer(0.2, go.set).start()
    start = time.monotonic()
    write_tree(new, tmp_path)
    assert time.monotonic() - start > 0.15
    holder.join()
    assert check_tree(new, tmp_path).ok


def test_the_second_does_not_wait_for_ever_nor_undo_what_the_first_does(trees, tmp_path, monkeypatch):
    old, new = trees["grows"]
    monkeypatch.setattr(journal, "WAIT", 0.1)
    write_tree(old, tmp_path)
    stage = tmp_path / ".liegen-abcdefgh"
    stage.mkdir()
    with journal.locked(tmp_path):
        with pytest.raises(OutputError, match=r"another process of liegen is writing .*nothing was changed"):
            write_tree(new, tmp_path)
        assert stage.exists()
    assert check_tree(old, tmp_path).ok
    write_tree(new, tmp_path)
    assert not stage.exists()


def test_several_processes_at_once(trees, tmp_path):
    old, new = trees["grows"]
    pids = []
    for files in (old, new, old, new):
        pid = os.fork()
        if not pid:
            try:
                for _ in range(5):
                    write_tree(files, tmp_path / "out")
                os._exit(0)
            finally:
                os._exit(1)
        pids.append(pid)
    assert [os.waitpid(pid, 0)[1] for pid in pids] == [0] * 4
    assert check_tree(old, tmp_path / "out").ok or check_tree(new, tmp_path / "out").ok
    assert stages(tmp_path / "out") == []


# --- real file systems ------------------------------------------------------------------------------------


def unprivileged(action):
    """Run it in a process whose user may not write everywhere."""

    def run():
        if os.getuid() == 0:
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
        action()

    return forked(run)


@pytest.mark.parametrize("closed", ["c", "demo", "."])
def test_a_folder_that_is_read_only(closed, trees, tmp_path):
    """The first moves work, then one is refused by the system itself."""
    large, small = trees["shrinks"]
    new = {path: text + "\n" for path, text in large.items() if path in small or path.startswith("c/")}
    out = tmp_path / "out"
    write_tree(large, out)
    for path in (tmp_path, *tmp_path.parents):
        if path.stat().st_uid == os.getuid() and len(path.parts) > 2:
            path.chmod(path.stat().st_mode | 0o055)
    for path in (out, *out.rglob("*")):
        if os.getuid() == 0:
            os.chown(path, 65534, 65534)
    (out / closed).chmod(0o555)
    before = snapshot(out)

    def fail():
        with pytest.raises(OutputError, match=r"Permission denied.*nothing was changed"):
            write_tree(new, out)

    assert unprivileged(fail) == 0
    (out / closed).chmod(0o755)
    assert snapshot(out) == before
    assert stages(out) == []


@pytest.mark.parametrize("held", ["c/demo_math.h", "demo/_support.py", "c", "demo", "."])
def test_what_the_system_does_not_let_change(held, trees, tmp_path_factory):
    """Immutable files and folders; only root can make them so, and only on file systems that know them."""
    large, _ = trees["shrinks"]
    new = {path: text + "\n" for path, text in large.items()}
    out = tmp_path_factory.mktemp("immutable")
    write_tree(large, out)
    before, place = snapshot(out), str(out / held)
    made = subprocess.run(["chattr", "+i", place], capture_output=True, check=False) if CHATTR else None
    if made is None or made.returncode:
        pytest.skip("no immutable files here")
    try:
        with pytest.raises(OutputError, match=r"Operation not permitted.*nothing was changed"):
            write_tree(new, out)
    finally:
        subprocess.run(["chattr", "-i", place], check=True)
    assert snapshot(out) == before
    assert stages(out) == []
    write_tree(new, out)
    assert check_tree(new, out).ok


@pytest.mark.parametrize("change", CHANGES)
def test_one_path_that_is_refused_whenever_it_is_touched(change, trees, tmp_path, monkeypatch):
    """As an immutable file is, on any file system: putting back must not need that path either."""
    old, new = trees[change]
    after = expected(tmp_path, new)
    for number, name in enumerate(sorted(set(old) | set(new))):
        place = fresh(tmp_path / f"{number}", old)
        before = snapshot(place)

        def refuse(event, path, to, held=str(place / name)):
            if event in ("os.rename", "os.remove", "os.link") and held in (path, to):
                raise OSError(errno.EPERM, os.strerror(errno.EPERM), path)

        told = refusal(refuse, place, new, monkeypatch)
        assert snapshot(place) == (before if told else after), (name, told)
        assert stages(place) == []
        if told:
            assert "Operation not permitted" in told
            assert "nothing was changed" in told


def test_the_current_folder_was_removed(trees, tmp_path):
    (tmp_path / "gone").mkdir()

    def fail():
        os.chdir(tmp_path / "gone")
        (tmp_path / "gone").rmdir()
        with pytest.raises(OutputError, match=r"the current folder was removed; change to another one"):
            write_tree(trees["grows"][0], Path("out"))
        write_tree(trees["grows"][0], tmp_path / "whole")

    assert forked(fail) == 0
    assert check_tree(trees["grows"][0], tmp_path / "whole").ok
    assert not (tmp_path / "gone").exists()


def test_a_limit_on_the_size_of_files(trees, tmp_path):
    resource = pytest.importorskip("resource")
    old, new = trees["grows"]
    write_tree(old, tmp_path)
    before = snapshot(tmp_path)

    def fail():
        resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
        with pytest.raises(OutputError, match=r"File too large.*nothing was changed"):
            write_tree(new, tmp_path)

    assert forked(fail) == 0
    assert snapshot(tmp_path) == before
    assert stages(tmp_path) == []
