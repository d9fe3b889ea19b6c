"""Writing is all or nothing and spares foreign files; checking finds what is not as it would be written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from emit_kernels import between_r2, examples, wheel_step
from emit_tools import REGENERATE

from liegen.emit import check_tree, render, write, write_tree
from liegen.errors import OutputError


def files_of(kernels: list, targets: tuple[str, ...] = ("numpy", "c")) -> dict[str, str]:  # type: ignore[type-arg]
    return render(kernels, targets, package="demo", regenerate=REGENERATE)


def snapshot(directory: Path) -> dict[str, bytes | None]:
    """Every path below a folder with its bytes, None for folders."""
    found = sorted(directory.rglob("*"))
    return {p.relative_to(directory).as_posix(): p.read_bytes() if p.is_file() else None for p in found}


def test_writes_everything_and_a_second_time_nothing(tmp_path: Path) -> None:
    files = files_of(examples())
    out = tmp_path / "deep" / "out"
    done = write_tree(files, out)
    assert set(done.written) == files.keys()
    assert done.written[-1] == "demo.json"
    before = snapshot(out)
    assert {k: v.decode() for k, v in before.items() if v is not None} == files
    times = {p: p.stat().st_mtime_ns for p in out.rglob("*")}
    again = write_tree(files, out)
    assert (again.written, again.removed) == ((), ())
    assert set(again.unchanged) == files.keys()
    assert {p: p.stat().st_mtime_ns for p in out.rglob("*")} == times
    assert check_tree(files, out).ok


def test_removes_orphans_and_keeps_other_peoples_files(tmp_path: Path) -> None:
    write_tree(files_of(examples()), tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "keep.c").write_text("mine")
    cache = tmp_path / "demo" / "__pycache__"
    cache.mkdir()
    (cache / "x.pyc").write_bytes(b"0")
    fewer = files_of([between_r2()], ("numpy",))
    done = write_tree(fewer, tmp_path)
    assert "c/wheel_step.c" in done.removed
    assert "demo/_wheel_step.py" in done.removed
    left = {path for path, content in snapshot(tmp_path).items() if content is not None}
    assert left == {*fewer, "notes.txt", "other/keep.c", "demo/__pycache__/x.pyc"}
    assert not (tmp_path / "c").exists()
    assert check_tree(fewer, tmp_path).ok


@pytest.mark.parametrize(
    "place", ["demo/extra.py", "c/mine.c", "c/sub/deep.h", "demo/__init__.py", "c/between_r2.c"]
)
def test_refuses_a_folder_with_foreign_files(place: str, tmp_path: Path) -> None:
    """Without a manifest nothing is liegen's own, not even a file of the right name."""
    foreign = tmp_path / place
    foreign.parent.mkdir(parents=True)
    foreign.write_text("mine")
    before = snapshot(tmp_path)
    with pytest.raises(OutputError) as raised:
        write_tree(files_of(examples()), tmp_path)
    assert place in str(raised.value)
    assert "liegen did not write" in str(raised.value)
    assert "Choose another folder" in str(raised.value)
    assert snapshot(tmp_path) == before


def test_refuses_a_foreign_file_in_a_tree_of_its_own_too(tmp_path: Path) -> None:
    write_tree(files_of(examples()), tmp_path)
    for k in range(7):
        (tmp_path / "c" / f"mine_{k}.c").write_text("mine")
    before = snapshot(tmp_path)
    with pytest.raises(OutputError, match=r"c/mine_0\.c, .*c/mine_4\.c and 2 more"):
        write_tree(files_of([between_r2()]), tmp_path)
    assert snapshot(tmp_path) == before


def test_overwrites_a_generated_file_that_was_changed(tmp_path: Path) -> None:
    files = files_of(examples())
    write_tree(files, tmp_path)
    (tmp_path / "c" / "demo.h").write_text("changed")
    (tmp_path / "demo" / "_support.py").unlink()
    assert set(write_tree(files, tmp_path).written) == {"c/demo.h", "demo/_support.py"}
    assert check_tree(files, tmp_path).ok


@pytest.mark.parametrize(
    "content",
    [
        "not json",
        "[]",
        '{"format": "other", "files": {}}',
        json.dumps({"format": "liegen manifest 1", "files": {"../precious.txt": ""}}),
        json.dumps({"format": "liegen manifest 1", "files": {"/etc/passwd": ""}}),
        json.dumps({"format": "liegen manifest 1", "files": {"demo.json": ""}}),
    ],
)
def test_a_manifest_that_liegen_did_not_write_is_never_believed(content: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (tmp_path / "precious.txt").write_text("mine")
    (out / "demo.json").write_text(content)
    before = snapshot(tmp_path)
    with pytest.raises(OutputError, match="no manifest that liegen wrote"):
        write_tree(files_of(examples()), out)
    assert snapshot(tmp_path) == before


def test_refuses_a_link_to_a_folder_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    out = tmp_path / "out"
    out.mkdir()
    (out / "c").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    with pytest.raises(OutputError, match="holds files that liegen did not write: c;"):
        write_tree(files_of(examples()), out)
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_a_link_to_a_file_with_the_right_text_becomes_a_file(tmp_path: Path) -> None:
    files, out = files_of(examples()), tmp_path / "out"
    write_tree(files, out)
    (out / "c" / "wheel_step.c").rename(tmp_path / "elsewhere.c")
    (out / "c" / "wheel_step.c").symlink_to(tmp_path / "elsewhere.c")
    assert write_tree(files, out).written == ("c/wheel_step.c",)
    assert not (out / "c" / "wheel_step.c").is_symlink()
    assert (tmp_path / "elsewhere.c").read_text() == files["c/wheel_step.c"]


def test_a_file_in_place_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputError, match="is a file"):
        write_tree(files_of(examples()), tmp_path / "out" / "deeper")
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.parametrize("fatal", [1, 2, 5, 9])
@pytest.mark.parametrize("moment", ["write", "move"])
def test_a_failure_half_way_leaves_the_old_tree(
    moment: str, fatal: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk is full when a file is written, or a move is refused."""
    write_tree(files_of([between_r2(), wheel_step()]), tmp_path)
    (tmp_path / "demo" / "__init__.py").write_text("changed by hand")
    before = snapshot(tmp_path)
    calls = 0
    method = {"write": "write_bytes", "move": "replace"}[moment]
    real = getattr(Path, method)

    def failing(self: Path, argument: object) -> object:
        nonlocal calls
        calls += 1
        if calls == fatal:
            raise OSError(28, "No space left on device")
        return real(self, argument)

    monkeypatch.setattr(Path, method, failing)
    new = {path: text + "// new\n" for path, text in files_of(examples()).items() if "wheel" not in path}
    with pytest.raises(OutputError, match="No space left on device"):
        write_tree(new, tmp_path)
    monkeypatch.undo()
    assert snapshot(tmp_path) == before


def test_a_failure_takes_new_folders_away_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(write.Path, "replace", failing)
    with pytest.raises(OutputError):
        write_tree(files_of(examples()), tmp_path / "new" / "out")
    assert list(tmp_path.iterdir()) == []


def test_check_finds_missing_changed_and_orphan_files(tmp_path: Path) -> None:
    files = files_of(examples())
    report = check_tree(files, tmp_path / "nowhere")
    assert report.missing == tuple(sorted(files))
    assert not report.ok
    write_tree(files, tmp_path)
    (tmp_path / "c" / "between_r2.h").unlink()
    source = tmp_path / "demo" / "_wheel_step.py"
    source.write_text(source.read_text().replace("t0 = (w_0", "t0 = (2 * w_0"))
    (tmp_path / "c" / "left_over.c").write_text("")
    (tmp_path / "demo" / "__pycache__").mkdir()
    (tmp_path / "demo" / "__pycache__" / "x.pyc").write_bytes(b"0")
    (tmp_path / "unrelated.py").write_text("")
    before = snapshot(tmp_path)
    report = check_tree(files, tmp_path)
    assert report.missing == ("c/between_r2.h",)
    assert report.orphans == ("c/left_over.c",)
    (change,) = report.changed
    assert change.path == "demo/_wheel_step.py"
    assert "\n-    t0 = (2 * w_0 - bias_y) * dt_0\n+    t0 = (w_0 - bias_y) * dt_0\n" in change.diff
    assert not report.ok
    assert snapshot(tmp_path) == before


def test_check_lists_what_an_older_manifest_wrote(tmp_path: Path) -> None:
    write_tree(files_of(examples()), tmp_path)
    report = check_tree(files_of([between_r2()], ("numpy",)), tmp_path)
    assert "c/wheel_step.c" in report.orphans
    assert "demo/_wheel_step.py" in report.orphans
    assert {change.path for change in report.changed} == {"demo.json", "demo/__init__.py", "demo/_support.py"}
