"""``--group`` on the command line, the tree that is checked in, and the examples of the documentation."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from compiler_tools import needs_compiler
from liegen.cli import app
from liegen.native import find_compiler

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "generated" / "groups"
DOCUMENT = (ROOT / "docs" / "group_modules.md").read_text(encoding="utf-8")


def run(*arguments, code=0):
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    assert done.exit_code == code, done.output
    return done.output


def test_generate_check_and_mend(tmp_path):
    out = tmp_path / "out"
    run("generate", "--group", "SO2", "--group", "SO3", "-o", out)
    manifest = json.loads((out / "liegen_groups.json").read_text())
    assert manifest["options"]["regenerate"] == "liegen generate --group SO2 --group SO3 -o DIR"
    assert len(manifest["factors"]) == 30
    assert "all up to date" in run("check", out)
    (out / "c" / "so3_log.c").write_text("int x;\n")
    said = run("check", out, code=1)
    assert "so3_log.c" in said
    assert f"liegen generate --group SO2 --group SO3 -o {out}" in said
    run("generate", "--group", "SO2", "--group", "SO3", "-o", out)
    run("check", out)


def test_one_function_under_another_name(tmp_path):
    run("generate", "--group", "SE2", "-f", "se2_exp", "--package", "mine", "-t", "numpy", "-o", tmp_path)
    assert sorted(p.name for p in (tmp_path / "mine").iterdir()) == [
        "__init__.py",
        "_se2_exp.py",
        "_support.py",
        "py.typed",
    ]
    assert "--group SE2 -f se2_exp" in (tmp_path / "mine" / "_se2_exp.py").read_text()
    assert "all up to date" in run("check", tmp_path)


def test_check_looks_into_the_folders_below(tmp_path):
    run("generate", "-f", "prior_r2", "-o", tmp_path)
    run("generate", "--group", "SO2", "-o", tmp_path / "groups")
    assert run("check", tmp_path).count("all up to date") == 2
    (tmp_path / "groups" / "c" / "so2_log.h").unlink()
    assert "missing" in run("check", tmp_path, code=1)


def test_the_tree_that_is_checked_in_is_up_to_date():
    assert "all up to date" in run("check", TREE)


def test_wrong_groups():
    assert "no group 'se3'; did you mean SE3? there are: " in run("list", "--group", "se3", code=2)
    assert "there are:" in run("generate", "--group", "Banana", "-o", "nowhere", code=2)
    assert "not both" in run("verify", "factors.py", "--group", "SE3", code=2)
    assert "did you mean" in run("explain", "se3_jr", "--group", "SE3", code=2)
    assert not Path("nowhere").exists()


def test_list_and_explain():
    listed = json.loads(run("list", "--group", "SE3", "--json"))
    assert [row["name"] for row in listed][:3] == ["se3_compose", "se3_inverse", "se3_between"]
    told = run("explain", "se3_compose", "--group", "SE3")
    assert "out_D_y = I" in told
    matrix = run("explain", "se3_Jr", "--group", "SE3")
    assert matrix.startswith("se3_Jr(d: R6) -> out: 36\n")
    assert "with Jacobians" not in matrix


def test_verify():
    said = run("verify", "--group", "SO2", "-f", "so2_exp", "-f", "so2_adjoint", "--samples", "4")
    assert re.search(r"so2_exp +\d+ passed", said)
    assert "0 failed" in said


# the documentation


def block(language: str) -> str:
    (found,) = re.findall(rf"```{language}\n(.*?)```", DOCUMENT, re.DOTALL)
    return found


def test_the_example_in_numpy():
    done = subprocess.run(
        [sys.executable, "-c", block("python")], cwd=TREE, capture_output=True, text=True, check=True
    )
    assert done.stdout == block("text")


@needs_compiler
@pytest.mark.parametrize("compiler", ["c", "c++"])
def test_the_example_in_c(compiler, tmp_path):
    command = find_compiler() if compiler == "c" else (shutil.which("c++") or shutil.which("g++"),)
    if command is None or command[0] is None:
        pytest.skip("there is no C++ compiler")
    sources = [str(TREE / "c" / f"{name}.c") for name in ("se3_retract", "se3_Jr_inv", "se3_log")]
    program = tmp_path / ("main.c" if compiler == "c" else "main.cpp")
    program.write_text(block("c"))
    flags = ["-Wall", "-Wextra", "-Werror", *(["-std=c99", "-pedantic"] if compiler == "c" else [])]
    language = [] if compiler == "c" else ["-x", "c++"]
    built = [*command, *flags, *language, "-I", str(TREE / "c"), str(program), *sources, "-lm", "-o"]
    subprocess.run([*built, str(tmp_path / "main")], check=True)
    printed = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=True).stdout
    numbers = np.array([float(word) for word in printed.split()])
    # Log(x Exp(d)) of an x without rotation or translation is d
    np.testing.assert_allclose(numbers, [0.1, -0.2, 0.3, 1, 2, 3], atol=5e-7)
