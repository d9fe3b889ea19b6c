"""Output folders from the command line: several sources in one, damaged manifests, full disks, odd places."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from liegen.cli.application import app

FACTOR = """
from liegen import R2, factor

@factor
def {name}(x: R2, y: R2):
    return {formula}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with the sources a.py and b.py."""
    monkeypatch.chdir(tmp_path)
    write("a.py", "first")
    write("b.py", "second")
    return tmp_path


def write(path, name, formula="x - y"):
    Path(path).write_text(FACTOR.format(name=name, formula=formula))


def run(*arguments, code=0):
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    assert done.exit_code == code, done.output + repr(done.exception)
    return done.output


def files(top):
    return {p.relative_to(top).as_posix(): p.read_bytes() for p in Path(top).rglob("*") if p.is_file()}


# --- several sources --------------------------------------------------------------------------------------


def test_two_sources_share_a_folder(folder):
    run("generate", "a.py", "-o", "out")
    alone = files("out")
    run("generate", "b.py", "-o", "out")
    both = files("out")
    assert {p: both[p] for p in alone} == alone
    assert {"a_gen.json", "b_gen.json", "c/a_gen.h", "c/b_gen.h", "c/first.c", "c/second.c"} <= both.keys()
    run("generate", "b.py", "-o", "only_b")
    assert both == alone | files("only_b")
    assert run("check", "out").count("all up to date") == 2


def test_each_source_removes_what_is_its_own(folder):
    for source in ("a.py", "b.py"):
        run("generate", source, "-o", "out")
    write("a.py", "another")
    run("generate", "a.py", "-o", "out")
    names = files("out").keys()
    assert {"c/another.c", "c/second.c", "a_gen/_another.py", "b_gen/_second.py"} <= names
    assert "c/first.c" not in names
    assert run("check", "out").count("all up to date") == 2


def test_check_finds_the_one_that_differs(folder):
    for source in ("a.py", "b.py"):
        run("generate", source, "-o", "out")
    write("b.py", "second", "y - x")
    told = run("check", "out", code=1)
    assert "files, all up to date" in told
    assert "changed  out/c/second.c" in told
    assert "first" not in told
    mend(told)
    run("check", "out")


def test_check_takes_a_source_for_the_package_of_that_name(folder):
    for source in ("a.py", "b.py"):
        run("generate", source, "-o", "out")
    Path("elsewhere").mkdir()
    Path("b.py").rename("elsewhere/b.py")
    assert "made from b.py, which is not here" in run("check", "out", code=2)
    assert run("check", "out", "elsewhere/b.py").count("all up to date") == 2
    told = run("check", "out", "elsewhere/c.py", code=2)
    assert "nothing in out was made from elsewhere/c.py; it was made from a.py, b.py" in told


def test_the_same_factor_of_two_sources_is_refused_by_name(folder):
    run("generate", "a.py", "-o", "out")
    before = files("out")
    write("b.py", "first", "y - x")
    told = run("generate", "b.py", "-o", "out", code=2)
    assert "out already holds c/first.c, c/first.h, c/first_batch.c of a.py, as a_gen.json lists" in told
    assert "nothing was changed. Rename the factors, or choose another folder" in told
    assert files("out") == before


def test_one_name_of_a_package_for_two_sources_is_refused(folder):
    run("generate", "a.py", "-o", "out", "--package", "robot")
    before = files("out")
    told = run("generate", "b.py", "-o", "out", "--package", "robot", code=2)
    assert "robot.json belongs to the package of a.py; nothing was changed" in told
    assert "another name with --package" in told
    assert files("out") == before


def test_library_groups_and_a_file_in_one_folder(folder):
    run("generate", "-o", "out", "-f", "between_r2")
    run("generate", "-o", "out", "--group", "SO2", "-t", "numpy")
    run("generate", "a.py", "-o", "out", "-t", "numpy")
    assert run("check", "out").count("all up to date") == 3


# --- orphans ----------------------------------------------------------------------------------------------


def mend(told):
    """Do what the last line of a check says."""
    for command in told.splitlines()[-1].removeprefix("mend it with: ").split(" && "):
        tool, *words = shlex.split(command)
        if tool == "rm":
            subprocess.run([tool, *words], check=True)
        else:
            assert tool == "liegen"
            run(*words)


@pytest.mark.parametrize("orphans", [["c/old.c"], ["c/it's old.c", "a_gen/x.py"], ["c/deep/er/x.c"]])
@pytest.mark.parametrize("stale", [False, True])
def test_the_cure_of_an_orphan_works(orphans, stale, folder):
    run("generate", "a.py", "-o", "out")
    for name in orphans:
        Path("out", name).parent.mkdir(parents=True, exist_ok=True)
        Path("out", name).write_text("")
    if stale:
        write("a.py", "first", "y - x")
    told = run("check", "out", code=1)
    assert all(f"orphan   out/{name}: no manifest lists it" in told for name in orphans)
    mend(told)
    assert "all up to date" in run("check", "out")


@pytest.mark.parametrize("name", ["-out", "-- -x", "it's out", "a/-b"])
def test_the_cure_in_a_folder_with_an_odd_name(name, folder):
    run("generate", "a.py", "-o", name)
    Path(name, "c/old.c").write_text("")
    Path(name, "c/first.c").unlink()
    mend(run("check", "--", name, code=1))
    assert "all up to date" in run("check", "--", name)


def test_an_orphan_that_the_manifest_lists_goes_with_generate(folder):
    run("generate", "a.py", "-o", "out")
    write("a.py", "another")
    told = run("check", "out", code=1)
    assert "orphan   out/c/first.c: liegen would not write it" in told
    assert told.splitlines()[-1] == "mend it with: liegen generate a.py -o out"
    mend(told)
    run("check", "out")


def test_the_cure_of_a_missing_file_works(folder):
    run("generate", "a.py", "-o", "out")
    Path("out/c/first.c").unlink()
    Path("out/c/old.c").write_text("")
    told = run("check", "out", code=1)
    assert "missing  out/c/first.c" in told
    mend(told)
    assert "all up to date" in run("check", "out")


def test_a_link_in_place_of_a_file_is_a_change(folder):
    """Not followed: neither to say that all is well, nor to write where it leads."""
    run("generate", "a.py", "-o", "out")
    target, place = Path("same.c"), Path("out/c/first.c")
    place.rename(target)
    place.symlink_to(target.resolve())
    told = run("check", "out", code=1)
    assert "changed  out/c/first.c" in told
    assert "is a link" in told
    target.write_text("mine")
    mend(told)
    assert target.read_text() == "mine"
    assert not place.is_symlink()
    assert "all up to date" in run("check", "out")


@pytest.mark.parametrize("name", ["c/mine.c", "c/sub", "a_gen/nowhere.py"])
def test_a_link_is_a_file_of_the_tree(name, folder):
    run("generate", "a.py", "-o", "out")
    (folder / "target").mkdir()
    Path("out", name).symlink_to(folder / "target" if name == "c/sub" else folder / "nothing")
    assert f"orphan   out/{name}: no manifest lists it" in run("check", "out", code=1)
    write("a.py", "first", "y - x")
    assert f"did not write: {name}" in run("generate", "a.py", "-o", "out", code=2)


# --- manifests --------------------------------------------------------------------------------------------

SHALLOW = {
    "format": "liegen manifest 1",
    "files": {},
    "options": {"regenerate": "liegen generate a.py -o DIR"},
}


def with_(**changes):
    return json.dumps({**SHALLOW, **changes})


def commanded(text):
    return with_(options={"regenerate": text})


MANIFESTS = {
    "nests deeply": ('{"a":' * 100_000, "nests too deeply"),
    "nests deeply behind its format": ('{"format": "liegen manifest 1", "x": ' + "[" * 100_000, "too deeply"),
    "is cut": (with_()[:-20], "no manifest that liegen wrote"),
    "is empty": ("", "no manifest that liegen wrote"),
    "options are a number": (with_(options=3), "options.regenerate is no text"),
    "options are a list": (with_(options=["regenerate"]), "options.regenerate is no text"),
    "no options": (json.dumps({"format": SHALLOW["format"], "files": {}}), "options.regenerate is no text"),
    "command is a number": (commanded(3), "options.regenerate is no text"),
    "command is null": (commanded(None), "options.regenerate is no text"),
    "files are a list": (with_(files=["c/first.c"]), "files are not those of a tree"),
    "files are outside": (with_(files={"../a.py": ""}), "files are not those of a tree"),
    "another version": (with_(format="liegen manifest 9"), "another version of liegen wrote out/a_gen.json"),
    "command with an open quote": (commanded("liegen generate 'a.py"), "No closing quotation"),
    "command with an unknown option": (commanded("liegen generate a.py -o D --nosuch"), "--nosuch"),
    "command with a wrong choice": (commanded("liegen generate a.py -o D --major diagonal"), "diagonal"),
    "command that asks for help": (commanded("liegen generate --help"), "--help"),
    "another command": (commanded("rm -rf out"), "does not begin with liegen generate"),
    "an empty command": (commanded(""), "does not begin with liegen generate"),
}


@pytest.mark.parametrize("kind", MANIFESTS)
def test_a_damaged_manifest_is_named(kind, folder):
    text, message = MANIFESTS[kind]
    run("generate", "b.py", "-o", "out", "-t", "numpy")
    Path("out/a_gen").mkdir()
    Path("out/a_gen.json").write_text(text)
    before = files("out")
    told = run("check", "out", code=2)
    assert "a_gen.json" in told
    assert message in told
    assert len(told.strip().splitlines()) == 1
    assert files("out") == before


@pytest.mark.parametrize("kind", MANIFESTS)
def test_generate_does_not_write_beside_or_over_a_damaged_manifest(kind, folder):
    """One whose files can be read is good enough: only its command is not understood."""
    text, message = MANIFESTS[kind]
    Path("out/a_gen").mkdir(parents=True)
    Path("out/a_gen.json").write_text(text)
    readable = "command" in kind and "number" not in kind and "null" not in kind
    for source in ("b.py", "a.py"):
        before = files("out")
        over = source == "a.py" and readable and "liegen generate a.py " not in text
        told = run("generate", source, "-o", "out", "-t", "numpy", code=0 if readable and not over else 2)
        if over:
            assert "out/a_gen.json belongs to the package of" in told
        elif not readable:
            assert "out/a_gen.json" in told
            assert message in told
        if over or not readable:
            assert files("out") == before


def test_a_pipe_in_place_of_a_manifest_is_not_waited_for(folder):
    Path("out").mkdir()
    os.mkfifo("out/a_gen.json")
    assert "is no plain file" in run("generate", "a.py", "-o", "out", code=2)
    assert "holds no manifest" in run("check", "out", code=2)


@pytest.mark.parametrize("text", ["[]", "3", '{"name": "a"}', "{", "\xff"])
def test_other_peoples_json_is_no_manifest(text, folder):
    run("generate", "a.py", "-o", "out", "-t", "numpy")
    Path("out/package.json").write_bytes(text.encode("latin-1"))
    run("generate", "a.py", "-o", "out", "-t", "numpy")
    assert "all up to date" in run("check", "out")


@pytest.mark.parametrize("part", ["out/c", "out/c/", "out/a_gen", "out/x/../c", "link"])
def test_no_tree_is_written_into_the_folder_of_another(part, folder):
    """Its files would be orphans of that one, which its check says are to be removed."""
    run("generate", "a.py", "-o", "out")
    Path("out/x").mkdir()
    Path("link").symlink_to("out/c")
    before = files(folder)
    told = run("generate", "b.py", "-o", part, code=2)
    assert "is a part of the tree of a.py, as a_gen.json in the folder above it lists; nothing was" in told
    assert files(folder) == before
    run("generate", "b.py", "-o", "out/x")
    assert "all up to date" in run("check", "out")


def test_a_folder_that_cannot_be_read(folder):
    run("generate", "a.py", "-o", "out")
    Path("out/c").chmod(0)
    words = shlex.join([sys.executable, "-m", "liegen", "check", "out"])
    plain = ["capsh", "--drop=cap_dac_override,cap_dac_read_search", "--", "-c", words]
    if os.getuid() == 0 and not shutil.which("capsh"):
        pytest.skip("root reads everything, and capsh is not here")
    command = plain if os.getuid() == 0 else shlex.split(words)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    Path("out/c").chmod(0o755)
    assert done.returncode == 2
    assert done.stderr == "Error: cannot read out/c/a_gen.h: Permission denied\n"


def test_a_folder_whose_name_has_a_line_feed(folder):
    told = run("generate", "a.py", "-o", "x\ny\x1b[31m")
    assert told.splitlines()[-1].endswith(r" to x\ny\x1b[31m/a_gen and x\ny\x1b[31m/c")
    assert run("check", "x\ny\x1b[31m") == "x\\ny\\x1b[31m: 12 files, all up to date\n"


# --- places -----------------------------------------------------------------------------------------------

LONG = "n" * 300


@pytest.mark.parametrize(("place", "message"), [
    ("a.py", "a.py is a file; choose another folder"),
    ("a.py/deeper/still", "is a file, so nothing can be written to a.py/deeper/still"),
    (LONG, "File name too long"),
    (f"new/{LONG}/x", "File name too long"),
    ("d/" * 3000, "File name too long"),
    ("/proc/out", "cannot write to /proc/out"),
    ("loop/out", "cannot write to loop/out|is a link to nothing"),
    ("dangling", "dangling is a link to nothing; choose another folder"),
])  # fmt: skip
def test_a_place_that_cannot_be_written_to(place, message, folder):
    Path("loop").symlink_to("loop")
    Path("dangling").symlink_to("nowhere")
    before = files(folder)
    told = run("generate", "a.py", "-o", place, "-t", "numpy", code=2)
    assert any(part in told for part in message.split("|"))
    assert len(told) < 600
    assert str(folder) not in told
    assert files(folder) == before
    assert not Path("new").exists()


def test_a_name_that_is_too_long_for_a_file(folder):
    write("a.py", "f" * 250)
    told = run("generate", "a.py", "-o", "out", code=2)
    assert "its name is longer than 100 characters; rename it" in told
    assert not Path("out").exists()


def test_a_folder_in_place_of_a_file(folder):
    run("generate", "a.py", "-o", "out")
    Path("out/c/first.c").unlink()
    Path("out/c/first.c").mkdir()
    told = run("generate", "a.py", "-o", "out", code=2)
    assert "out/c/first.c is a folder where a file is to be written; nothing was changed" in told


# --- killed runs ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [("check", "out"), ("generate", "a.py", "-o", "out")])
def test_what_a_killed_run_left_is_put_back_first(command, folder):
    run("generate", "a.py", "-o", "out")
    stage = Path("out/.liegen-abcdefgh")
    for part in ("new", "old"):
        (stage / part / "c").mkdir(parents=True)
    shutil.move("out/c/first.c", stage / "old/c/first.c")
    Path("out/c/first.c").write_text("half")
    changes = {"fresh": ["c/first.c"], "removed": [], "had": ["c/first.c"], "made": []}
    (stage / "journal.json").write_text(json.dumps({"format": "liegen journal 1", **changes}))
    told = run(*command)
    assert "out: a run of liegen was killed while it wrote here" in told
    assert "put back" in told
    assert not stage.exists()
    assert "all up to date" in run("check", "out")


# --- standard output --------------------------------------------------------------------------------------


def shell(line):
    command = shlex.join([sys.executable, "-m", "liegen"])
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", line.replace("liegen", command, 1)], capture_output=True, text=True,
        check=False, timeout=120,
    )  # fmt: skip


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize(("line", "code", "told"), [
    ("liegen generate a.py -o out > /dev/full", 1, "Error: cannot write to standard output: No space left"),
    ("PYTHONUNBUFFERED=1 liegen list a.py > /dev/full", 1, "Error: cannot write to standard output: No sp"),
    ("liegen --help > /dev/full", 1, "Error: cannot write to standard output: No space left"),
    ("liegen generate a.py -o out | head -0", 0, ""),
    ("liegen generate a.py -o out >&-", 0, ""),
    ("liegen generate a.py -o out >&- 2>&-", 0, ""),
])  # fmt: skip
def test_an_output_that_takes_nothing(line, code, told, folder):
    done = shell(line)
    assert done.returncode == code
    assert done.stderr.startswith(told)
    assert len(done.stderr.splitlines()) == bool(told)
    if "generate" in line:
        assert "all up to date" in run("check", "out")
