"""A file of factors is a program: what it does to the process is undone, what it raises becomes one line."""

import json
import os
import signal
import subprocess
import sys

import pytest
from click.testing import CliRunner

from liegen.cli import app

FACTOR = "\n\nfrom liegen import R3, factor\n\n\n@factor\ndef pull(x: R3, *, z: R3):\n    return x - z\n"

#: What stands before the factor, and what the message says.
RAISES = {
    "BaseException": ("raise BaseException('over')", ["factors.py:1", "BaseException: over"]),
    "GeneratorExit": ("raise GeneratorExit", ["factors.py:1", "GeneratorExit"]),
    "SystemExit": ("raise SystemExit(0)", ["factors.py:1", "ends the program", "__main__"]),
    "os._exit": ("import os\nos._exit(0)", ["factors.py:2", "ends the program"]),
    "os.abort": ("import os\nos.abort()", ["factors.py:2", "ends the program"]),
    "text of the error fails": (
        "class Sly(Exception):\n    def __str__(self):\n        raise ValueError\n\n\nraise Sly",
        ["factors.py:6", "Sly", "cannot be shown"],
    ),
    "text of the error ends the program": (
        "class Sly(Exception):\n    def __str__(self):\n        raise SystemExit(0)\n\n\nraise Sly",
        ["factors.py:6", "Sly", "cannot be shown"],
    ),
    "text of the error ends it at once": (
        "import os\n\n\nclass Sly(Exception):\n    def __str__(self):\n        os._exit(0)\n\n\nraise Sly",
        ["factors.py:9", "Sly", "cannot be shown"],
    ),
    "another program": ("import os\nos.execv('/bin/true', ['true'])", ["factors.py:2", "ends the program"]),
    "text of a million characters": ("raise ValueError('a' * 10**6)", ["ValueError: aaa", "more characters"]),
    "terminal escapes": (r"raise ValueError('\x1b[2Jgone\x07')", [r"\x1b[2Jgone\x07"]),
    "endless recursion": ("def f():\n    return f()\n\n\nf()", ["factors.py:2", "RecursionError"]),
    "not UTF-8": (b"name = '\xff'", ["factors.py", "syntax error", "utf-8"]),
    "null byte": ("name = '\0'", ["factors.py", "null bytes"]),
    "of no known encoding": ("# coding: nothing", ["factors.py", "syntax error", "nothing"]),
}

#: What stands before the factor and is undone.
HARMLESS = {
    "changes the folder": "import os\nos.chdir('elsewhere')",
    "replaces stdout": "import sys\nsys.stdout = None",
    "replaces stderr": "import io, sys\nsys.stderr = io.StringIO()",
    "raises for warnings": "import warnings\nwarnings.simplefilter('error')",
    "raises for NaN": "import numpy as np\nnp.seterr(all='raise')",
    "limits recursion": "import sys\nsys.setrecursionlimit(200)",
    "deletes itself": "import os\nos.remove(__file__)",
    "ends later": "import os\nleave = os._exit",
    "a child that ends": "import os\nif os.fork() == 0:\n    os._exit(0)\nos.wait()",
    "closes files": "import os\nos.close(1)\nos.close(2)",
    "sends the output elsewhere": "import os\nos.dup2(os.open(os.devnull, os.O_WRONLY), 1)",
    "forgets folders": "import sys\nsys.path.clear()",
    "forgets modules": "import sys\nfor n in ('jinja2', 'json', 'pathlib'):\n    sys.modules.pop(n, None)",
    "shadows builtins": "import builtins\nbuiltins.open = builtins.print = builtins.sorted = None",
    "empties the environment": "import os\nos.environ.clear()",
    "chooses a compiler": "import os\nos.environ['CC'] = 'nosuch'",
    "hides what it writes": "import os\nos.umask(0o777)",
    "has an odd attribute": "def __getattr__(name):\n    raise ValueError(name)",
}


def written(folder, head):
    head = head if isinstance(head, bytes) else head.encode()
    (folder / "factors.py").write_bytes(head + FACTOR.encode())
    (folder / "elsewhere").mkdir()


@pytest.mark.parametrize("name", RAISES)
@pytest.mark.parametrize("command", [["list"], ["generate", "-o", "out"], ["verify"], ["explain", "pull"]])
def test_what_a_file_raises_is_one_line(name, command, tmp_path, monkeypatch):
    head, says = RAISES[name]
    monkeypatch.chdir(tmp_path)
    written(tmp_path, head)
    done = CliRunner().invoke(app, [command[0], *command[1:], "factors.py"])
    assert done.exit_code == 2, done.output
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr
    assert len(done.stderr) < 1000
    for words in says:
        assert words in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", HARMLESS)
def test_what_a_file_changes_of_the_process_is_undone(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, HARMLESS[name])
    done = CliRunner().invoke(app, ["generate", "factors.py", "-o", "out"])
    assert done.exit_code == 0, done.output
    assert "pull" in done.stdout
    assert (tmp_path / "out" / "c" / "pull.c").is_file()
    assert not any((tmp_path / "elsewhere").iterdir())


def test_a_file_that_closes_the_output(tmp_path):
    written(tmp_path, "import sys\nsys.stdout.close()\nsys.stderr.close()")
    done = subprocess.run(
        [sys.executable, "-m", "liegen", "list", "factors.py"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "pull" in done.stdout


@pytest.mark.parametrize("name", ["numpy", "math", "casadi", "sympy", "mpmath", "jinja2", "random", "rich"])
def test_a_file_may_have_the_name_of_a_package(name, tmp_path):
    (tmp_path / f"{name}.py").write_text(FACTOR.lstrip())
    source, output = str(tmp_path / f"{name}.py"), str(tmp_path / "out")
    command = [sys.executable, "-m", "liegen.__main__", "generate", source, "-o", output]
    done = subprocess.run(command, cwd=tmp_path.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("end", ["raise SystemExit(0)", "raise GeneratorExit", "raise BaseException('over')"])
def test_a_sampler_that_ends_the_program(end, tmp_path):
    (tmp_path / "factors.py").write_text(
        f"from liegen import R3, factor\n\n\ndef sample(draw, case):\n    {end}\n\n\n"
        "@factor(sample=sample)\ndef pull(x: R3, *, z: R3):\n    return x - z\n"
    )
    done = CliRunner().invoke(app, ["verify", str(tmp_path / "factors.py")])
    assert done.exit_code in (2, 3)
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith("Error: ")


def test_the_current_folder_is_removed(tmp_path):
    gone = tmp_path / "gone"
    gone.mkdir()
    command = f"rmdir {gone}; exec {sys.executable} -m liegen.__main__ list"
    done = subprocess.run(["sh", "-c", command], cwd=gone, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == "Error: the current folder does not exist any more; change to another one\n"


@pytest.mark.parametrize("end", ["import sys\nsys.exit(0)", "import os\nos._exit(0)", "raise GeneratorExit"])
def test_a_package_that_ends_the_program(end, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "leaving").mkdir()
    (tmp_path / "leaving" / "__init__.py").write_text(end)
    (tmp_path / "leaving" / "factors.py").write_text(FACTOR)
    for name in ("leaving", "leaving.factors"):
        done = CliRunner().invoke(app, ["list", name])
        assert done.exit_code == 2
        assert "leaving" in done.stderr
        assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "head",
    [
        "import os\nos.environ['CC'] = 'nosuch'\nos.environ.pop('PATH', None)",
        "import os\nos.umask(0o777)",
        "import builtins\nbuiltins.ascii = None",
        "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)",
        "import sys\nsys.settrace(lambda *a: None)\nsys.setprofile(lambda *a: None)",
        "import sys\nsys.path.clear()",
    ],
)
def test_the_process_is_as_it_was(head, tmp_path):
    def state():
        mask = os.umask(0)
        os.umask(mask)
        handler = signal.getsignal(signal.SIGINT)
        searched = set(sys.path) - {str(tmp_path)}  # where its neighbours are
        return dict(os.environ), mask, ascii, handler, sys.gettrace(), sys.getprofile(), searched

    written(tmp_path, head.encode())
    before = state()
    done = CliRunner().invoke(app, ["list", str(tmp_path / "factors.py")])
    assert done.exit_code == 0, done.output
    assert state() == before


def test_what_a_file_prints_is_no_result(tmp_path):
    written(tmp_path, "print('hello')")
    done = CliRunner().invoke(app, ["list", "--json", str(tmp_path / "factors.py")])
    assert done.exit_code == 0
    assert json.loads(done.stdout)
    assert done.stderr == "hello\n"


def test_the_current_folder_is_removed_by_the_file(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    written(tmp_path, "import os\nos.rmdir(os.getcwd())")
    done = CliRunner().invoke(app, ["list", str(tmp_path / "factors.py")])
    monkeypatch.chdir(tmp_path)
    assert done.exit_code == 2
    assert "the code of the factors removed the current folder" in done.stderr
    assert done.stderr.count("\n") == 1
