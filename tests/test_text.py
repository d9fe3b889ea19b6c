"""Whatever users write, generated files compile and terminals get nothing but text."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import sys
import unicodedata
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler_tools import needs_compiler
from liegen import R2, factor, require
from liegen.cli.application import app
from liegen.emit import render
from liegen.runtime.source import VALUE, emitted
from liegen.text import c_comment, c_string, docstring, hash_comment, in_json, in_latex, one_line, printable

HOSTILE = {
    "null": "a\0b",
    "surrogate": "a\ud800b\udcff",
    "escape": "\x1b[31mred\x1b[0m\x07\x08",
    "eight bits": "\x85\x9b31m",
    "trigraph": "what??/",
    "trigraphs": "???/ ??' ??( ??< ??!??! ??=define ??-",
    "end of a C comment": "a */ int x; /* b **/ /*/ */*",
    "backslash": "a\\\nb\\",
    "end of a docstring": 'say """ or """" or \\""" and \'\'\'',
    "quote": 'a "b"',
    "only quotes": '"""',
    "bidirectional": "a \u202e b \u2066 c \u200f",
    "separators": "a\u2028b\u2029c\x0bd\x0ce\x1cf\rg",
    "line breaks": "one\ntwo\r\nthree\n\n",
    "encoding": "-*- coding: nosuch -*-\n# vim: set fileencoding=nosuch :",
    "braces": "{{ header }} {% if %} {# #} {0} %s %d",
    "noncharacter": "\ufffe\uffff\U0010ffff\ue000",
    "plain": "R\u00e9sidu \u03b8 \u2264 1 \U0001f916 \u65e5\u672c",
    "empty": "",
}
ANY = st.text(
    st.one_of(st.characters(), st.sampled_from("\\/*?\"'\n\r\0\x1b#%=(<!>-\u202e\ud83d")), max_size=40
)
UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")


def unseen(text: str) -> set[str]:
    return {c for c in text if c != "\n" and unicodedata.category(c) in UNSEEN}


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain \u03b8", "plain \u03b8"),
        ("a\0b", r"a\x00b"),
        ("\x1b[31m", r"\x1b[31m"),
        ("a\nb", r"a\nb"),
        ("a\tb\u00a0c", "a b c"),
        ("\u202e", r"\u202e"),
        ("\udc80", r"\udc80"),
        ("\U000e0001", r"\U000e0001"),
        ("\u2028", r"\u2028"),
    ],
)
def test_one_line(text: str, shown: str) -> None:
    assert one_line(text) == shown


@pytest.mark.parametrize(
    ("text", "limit", "shown"),
    [
        ("a\nb", None, "a\nb"),
        ("a\r\nb", None, "a\\r\nb"),
        ("x" * 10, 4, "xxxx ... (6 more characters)"),
        ("x" * 4, 4, "xxxx"),
        ("\x1b" * 10**6, 2, r"\x1b\x1b ... (999998 more characters)"),
        (ValueError("\0"), None, r"\x00"),
        (3, None, "3"),
    ],
)
def test_printable(text: object, limit: int | None, shown: str) -> None:
    assert printable(text, limit) == shown


def test_printable_when_str_fails() -> None:
    class BadError(Exception):
        def __str__(self) -> str:
            raise RuntimeError

    assert printable(BadError()) == "<BadError that cannot be shown>"


@given(ANY)
def test_nothing_unseen_is_left(text: str) -> None:
    lines = text.split("\n")
    for shown in (
        printable(text),
        c_comment(lines),
        hash_comment(lines),
        docstring(lines, 4),
        c_string(text),
    ):
        assert not unseen(shown)
        shown.encode()


@given(ANY)
@example('"')
@example('say "a"')
@example('\\"')
@example('""""')
def test_python_reads_it_back(text: str) -> None:
    lines = text.split("\n")
    source = f"def f():\n    {docstring(lines, 4)}\n"
    function: Any = ast.parse(source).body[0]
    read = ast.get_docstring(function, clean=False)
    assert read is not None
    assert [x.strip() for x in read.strip().split("\n")] == [
        x.strip() for x in "\n".join(map(one_line, lines)).strip().split("\n")
    ]
    compile(f"{hash_comment(lines)}\nx = 1\n".encode(), "f.py", "exec")


@given(ANY, st.dictionaries(ANY, ANY, max_size=3))
def test_json_keeps_every_character(text: str, more: dict[str, str]) -> None:
    value = {"text": text, **more}
    written = in_json(json.dumps(value, ensure_ascii=False, indent=1))
    assert not unseen(written)
    assert json.loads(written.encode().decode()) == json.loads(json.dumps(value))


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("rear_left", r"rear\_left"),
        ("50% of {x} & $y^2$ #~", r"50\% of \{x\} \& \$y\hat{}2\$ \#\sim{}"),
        ("a\\b", r"a\backslash{}b"),
        ("\x1b\0", r"\backslash{}x1b\backslash{}x00"),
    ],
)
def test_latex(text: str, shown: str) -> None:
    assert in_latex(text) == shown


def compiled(source: str, folder: Path, language: str) -> None:
    place = folder / f"text.{language}"
    place.write_text(source)
    standard = ["-std=c99"] if language == "c" else ["-x", "c++", "-std=c++11"]
    flags = ["-fsyntax-only", "-Wall", "-Wextra", "-pedantic", "-Werror", "-trigraphs", *standard]
    done = subprocess.run(["cc", *flags, str(place)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@needs_compiler
@pytest.mark.parametrize("language", ["c", "cpp"])
@settings(max_examples=3, deadline=None)
@given(texts=st.lists(ANY, min_size=50, max_size=200))
def test_any_text_in_c(language: str, texts: list[str], tmp_path_factory: pytest.TempPathFactory) -> None:
    texts = [*texts, *HOSTILE.values()]
    parts = [
        f"{c_comment([text])}\n{c_comment(text.splitlines())}\n"
        f"extern const char text_{k}[];\nconst char text_{k}[] = {c_string(text)};"
        for k, text in enumerate(texts)
    ]
    compiled("\n".join(parts) + "\n", tmp_path_factory.mktemp("text"), language)


def hostile(text: str) -> Any:
    def pull(x: R2, *, z: R2) -> R2:
        require(x[0] > 0, text)
        return x - z

    pull.__doc__ = text
    return factor(pull)


@needs_compiler
def test_a_package_of_hostile_texts(tmp_path: Path) -> None:
    """Docstring, message of require, and the name of the file in the command."""
    for k, text in enumerate(HOSTILE.values()):
        files = render(
            [hostile(text).kernel], ("numpy", "c"), package=f"p{k}", regenerate=f"liegen {text}.py"
        )
        for path, content in files.items():
            assert not unseen(content), path
            (tmp_path / path).parent.mkdir(exist_ok=True, parents=True)
            (tmp_path / path).write_bytes(content.encode())
        assert json.loads(files[f"p{k}.json"])["factors"]["pull"]["requirements"] == [text]
        loops = emitted(hostile(text).kernel).c[VALUE]["pull_loops.c"]
        assert not unseen(loops)
        (tmp_path / "c" / f"strings{k}.c").write_bytes(_strings(loops).encode())
    names = [f"p{k}" for k in range(len(HOSTILE))]
    script = f"import numpy as np, {', '.join(names)}\n" + "\n".join(
        f"assert {n}.pull([1, 2], z=[0, 0]).tolist() == [1, 2] and {n}.pull.__doc__" for n in names
    )
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=True)
    flags = ["-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-trigraphs", "-std=c99"]
    sources = sorted(map(str, (tmp_path / "c").glob("*.c")))
    done = subprocess.run(["cc", *flags, *sources], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    headers = "".join(f'#include "p{k}.h"\n' for k in range(len(HOSTILE)))
    (tmp_path / "c" / "all.cpp").write_text(headers)
    if shutil.which("g++"):
        flags = ["-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-trigraphs", "-std=c++11"]
        done = subprocess.run(
            ["g++", *flags, str(tmp_path / "c" / "all.cpp")], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr


def _strings(loops: str) -> str:
    """The literals of the loops' source, compiled alone: the rest is the same for every factor."""
    found = [line.strip().rstrip(",") for line in loops.splitlines() if line.strip().startswith('"')]
    return f"extern const char *const all[];\nconst char *const all[] = {{{', '.join(found)}}};\n"


FILE = """
from liegen import R2, factor, require

@factor
def pull(x: R2, *, z: R2):
    {doc!r}
    require(x[0] > 0, {doc!r})
    return x - z
"""


@pytest.mark.parametrize("command", [["list"], ["list", "--json"], ["explain", "pull"]])
@pytest.mark.parametrize("name", ["null", "surrogate", "escape", "bidirectional", "eight bits", "separators"])
def test_terminals_get_text(command: list[str], name: str, tmp_path: Path) -> None:
    place = tmp_path / "hostile.py"
    place.write_text(FILE.format(doc=HOSTILE[name]), encoding="utf-8")
    done = CliRunner().invoke(app, [*command, str(place)])
    assert done.exit_code == 0, done.output
    assert not unseen(done.output)


def test_errors_get_text(tmp_path: Path) -> None:
    place = tmp_path / "hostile.py"
    place.write_text("raise ValueError('\\x1b[31m\\0 \\ud800 \\u202e')")
    done = CliRunner().invoke(app, ["list", str(place)])
    assert done.exit_code == 2
    assert not unseen(done.output)
    assert r"\x1b[31m\x00 \ud800 \u202e" in done.output


@needs_compiler
def test_file_and_folder_names_with_line_breaks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a\nb.py", "a*/b\n.py", "a??\n.py", "a\udcff.py", "a\x1b[31m.py"):
        folder = tmp_path / name.replace(".py", "").replace("/", "")
        folder.mkdir()
        place = folder / Path(name).name
        place.write_text(FILE.format(doc="plain"), encoding="utf-8")
        out = folder / "out"
        done = CliRunner().invoke(app, ["generate", str(place), "-o", str(out), "--package", "gen"])
        assert done.exit_code == 0, done.output
        assert not unseen(done.output)
        for path in out.rglob("*.py"):
            compile(path.read_bytes(), "f.py", "exec")
        sources = sorted(map(str, (out / "c").glob("*.c")))
        flags = ["-fsyntax-only", "-Wall", "-Werror", "-trigraphs", "-std=c99"]
        assert subprocess.run(["cc", *flags, *sources], check=False).returncode == 0
        done = CliRunner().invoke(app, ["check", str(out)])
        assert done.exit_code == 0, done.output


def test_a_package_called_coding() -> None:
    """Its name stands in the first line of a file: not as a choice of the encoding."""
    files = render([hostile("plain").kernel], ("numpy",), package="encoding", regenerate="liegen")
    for path, text in files.items():
        if path.endswith(".py"):
            compile(text.encode(), path, "exec")
