"""The command line: what each command prints and writes, and its exit codes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import liegen
from liegen.cli import app

FACTORS = '''
from liegen import R1, R2, R3, SE3, factor, norm, require, stack
from liegen.library import between_se3, projection_cal3_s2


@factor
def lever_arm_range(T_WB: SE3, lever: R3, *, anchor: R3, z: R1):
    """Distance from an anchor to an antenna at `lever`, metres.

    More words.
    """
    return norm(T_WB.transform_from(lever) - anchor) - z


@factor
def first_entries(x: R3, *, z: R2):
    require(x[2] > 0, "must be positive")
    return x[:2] / x[2] - z


alias = first_entries
located = projection_cal3_s2.fix("p", name="located")
'''


def run(*arguments, code=0):
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    assert done.exit_code == code, done.output
    return done


@pytest.fixture
def source(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "robot.py"
    file.write_text(FACTORS)
    return file


def tree(folder):
    files = (p for p in Path(folder).rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    return {p.relative_to(folder).as_posix(): p.read_text() for p in files}


# list


def test_list_names_the_files_own_factors(source):
    lines = run("list", source).stdout.splitlines()
    assert lines[0].split() == ["factor", "arguments", "result", "meaning"]
    assert [line.split()[0] for line in lines[1:]] == ["lever_arm_range", "first_entries", "located"]
    assert "T_WB: SE3, lever: R3, *, anchor: R3, z: R1" in lines[1]
    assert "res: 1" in lines[1]
    assert lines[1].endswith("Distance from an anchor to an antenna at `lever`, metres.")


def test_list_as_json(source):
    (first, *_) = json.loads(run("list", source, "--json").stdout)
    assert first == {
        "name": "lever_arm_range",
        "variables": {"T_WB": "SE3", "lever": "R3"},
        "given": {"anchor": "R3", "z": "R1"},
        "outputs": {"res": {"manifold": "R1", "dim": 1}},
        "doc": "Distance from an anchor to an antenna at `lever`, metres.",
    }


def test_list_of_the_library_and_of_dotted_modules(source):
    everything = {row["name"] for row in json.loads(run("list", "--json").stdout)}
    assert {"between_se3", "prior_s2", "range_r2", "bearing_se3_gtsam", "sfm_cal3_bundler"} <= everything
    assert {row["name"] for row in json.loads(run("list", "liegen.library", "--json").stdout)} == everything
    names = [row["name"] for row in json.loads(run("list", "liegen.library.between", "--json").stdout)]
    assert names[0] == "between_r2"
    assert len(names) == 6


def test_a_file_may_import_its_neighbours(source, tmp_path):
    (tmp_path / "arms_of_robot.py").write_text(
        "from liegen import R3, factor\n\n\n@factor\ndef theirs(x: R3):\n    return x\n"
        "\n\nOFFSET = [1.0, 2.0, 3.0]\n"
    )
    (tmp_path / "uses.py").write_text(
        "from arms_of_robot import *\nfrom liegen import R3, factor\n\n\n"
        "@factor\ndef mine(x: R3):\n    return theirs(x) - OFFSET\n"
    )
    assert [row["name"] for row in json.loads(run("list", tmp_path / "uses.py", "--json").stdout)] == ["mine"]


# generate


def test_generate_writes_both_languages(source, tmp_path):
    done = run("generate", source, "-o", tmp_path / "out")
    assert [line.split() for line in done.stdout.splitlines()[1:4]] == [
        [name, str(k.value.operations), str(k.jacobians.operations)]
        for name, k in ((f.name, f.kernel) for f in liegen_sources(source))
    ]
    files = tree(tmp_path / "out")
    assert {"robot_gen.json", "robot_gen/__init__.py", "c/lever_arm_range.h", "c/located.c"} <= set(files)
    for path, text in files.items():
        assert str(tmp_path) not in text, path
    assert "Regenerate: liegen generate robot.py -o DIR" in files["c/lever_arm_range.h"]
    assert "res_D_lever = unit(a)^T R(T_WB)" in files["c/lever_arm_range.h"]


def liegen_sources(source):
    from liegen.sources import load

    return load(str(source))


def test_generated_python_computes_what_the_factor_does(source, tmp_path):
    run("generate", source, "-o", tmp_path / "out", "-t", "numpy", "--package", "made")
    program = (
        "import made, numpy as np\n"
        "r = made.first_entries_jacobians(np.array([3.0, 4.0, 2.0]), z=np.array([0.5, 1.0]))\n"
        "print(r.res.tolist(), r.res_D_x.tolist())"
    )
    out = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path / "out", capture_output=True, text=True, check=True
    )
    assert out.stdout.strip() == "[1.0, 1.0] [[0.5, 0.0, -0.75], [0.0, 0.5, -1.0]]"
    assert not (tmp_path / "out" / "c").exists()


def test_generate_of_chosen_factors_and_targets(source, tmp_path):
    run("generate", source, "-f", "first_entries", "-t", "c", "-o", "out", "--major", "col")
    files = tree(tmp_path / "out")
    assert sorted(p for p in files if p.endswith(".c")) == ["c/first_entries.c", "c/first_entries_batch.c"]
    assert not any(p.endswith(".py") for p in files)
    assert "first_entries_cm" in files["c/first_entries.h"]
    command = "liegen generate robot.py -f first_entries -t c -o DIR --major col"
    assert f"Regenerate: {command}" in files["c/first_entries.h"]


def test_generate_is_the_same_everywhere(source, tmp_path):
    trees = []
    for k, seed in enumerate(("0", "1")):
        env = {**os.environ, "PYTHONHASHSEED": seed}
        command = [sys.executable, "-m", "liegen", "generate", "robot.py", "-o", f"out{k}"]
        subprocess.run(command, cwd=tmp_path, env=env, check=True, capture_output=True)
        trees.append(tree(tmp_path / f"out{k}"))
    assert trees[0] == trees[1]


def test_foreign_files_are_left_untouched(source, tmp_path):
    (tmp_path / "out" / "c").mkdir(parents=True)
    (tmp_path / "out" / "c" / "notes.txt").write_text("mine")
    done = run("generate", source, "-o", "out", code=2)
    assert "c/notes.txt" in done.stderr
    assert "did not write" in done.stderr
    assert "another folder" in done.stderr
    assert tree(tmp_path / "out") == {"c/notes.txt": "mine"}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["generate", "nowhere.py", "-o", "out"], "nowhere.py does not exist"),
        (["generate", ".", "-o", "out"], ". is a folder; give a Python file with factors"),
        (["generate", "not.there", "-o", "out"], "there is no module 'not.there'"),
        (["generate", "robot", "-o", "out", "-f", "nothing"], "there are: lever_arm_range, first_entries"),
        (["generate", "robot.py", "-f", "first_entry", "-o", "out"], "did you mean first_entries?"),
        (["generate", "robot.py"], "Missing option '-o'"),
        (["generate", "robot.py", "-o", "out", "-t", "rust"], "'rust' is not one of 'numpy', 'c'"),
        (["generate", "robot.py", "-o", "out", "--package", "for"], "'for' is a"),
        (["generate", "robot.py", "-o", "out", "--package", "numpy"], "hide the Python module"),
        (["generate", "robot.py", "-o", "robot.py/x"], "is a file"),
        (["explain", "first_entry", "robot.py"], "did you mean first_entries?"),
        (["explain"], "Missing argument 'NAME'"),
        (["verify", "--samples", "0"], "--samples"),
        (["check", "empty"], "liegen generate -o empty"),
        (["nothing"], "No such command"),
    ],
)
def test_wrong_use_is_code_2(source, arguments, says):
    done = run(*arguments, code=2)
    assert says in done.stderr
    assert "Traceback" not in done.stderr


# check


def test_check_of_a_fresh_tree_is_clean(source):
    run("generate", source, "-o", "out", "--package", "made", "-f", "located", "-f", "first_entries")
    assert "up to date" in run("check", "out").stdout


def test_check_finds_what_differs_and_the_command_mends_it(source, tmp_path):
    run("generate", "robot.py", "-o", "out")
    (tmp_path / "out" / "c" / "located.c").unlink()
    changed = tmp_path / "out" / "robot_gen" / "_first_entries.py"
    changed.write_text(changed.read_text().replace(" - ", " + "))
    done = run("check", "out", code=1)
    assert "missing  out/c/located.c" in done.stdout
    assert "changed  out/robot_gen/_first_entries.py" in done.stdout
    assert any(line.startswith("    +") and " - " in line for line in done.stdout.splitlines())
    assert "c/lever_arm_range.c" not in done.stdout
    command = done.stdout.splitlines()[-1].removeprefix("mend it with: liegen ")
    run(*command.split())
    run("check", "out")


def test_check_finds_orphans(source, tmp_path):
    run("generate", "robot.py", "-o", "out")
    (tmp_path / "out" / "c" / "old.c").write_text("old")
    assert "orphan   out/c/old.c" in run("check", "out", code=1).stdout


def test_check_sees_that_the_source_changed(source, tmp_path):
    run("generate", "robot.py", "-o", "out")
    source.write_text(FACTORS.replace("/ x[2] - z", "/ x[2] - 2 * z").replace("alias =", "another ="))
    done = run("check", "out", code=1)
    assert "changed  out/c/first_entries.c" in done.stdout
    assert (
        "located" not in done.stdout.replace("located.c", "") or "changed  out/c/located.c" not in done.stdout
    )


def test_check_needs_the_source(source, tmp_path, monkeypatch):
    run("generate", "robot.py", "-o", "out")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    source.rename(elsewhere / "robot.py")
    done = run("check", "out", code=2)
    assert "made from robot.py" in done.stderr
    assert "liegen check out PATH/robot.py" in done.stderr
    run("check", "out", elsewhere / "robot.py")


# verify and explain


def test_verify_passes_and_says_what_it_did(source):
    done = run("verify", source, "-f", "first_entries", "--samples", "6", "--seed", "3")
    row = done.stdout.splitlines()[1].split()
    assert row[0] == "first_entries"
    assert row[2] == "passed"
    assert "1 factor, 0 failed (6 samples each, seed 3" in done.stdout
    assert "C was" in done.stdout


def test_verify_as_json(source):
    report = json.loads(run("verify", source, "-f", "first_entries", "--samples", "4", "--json").stdout)
    assert report["passed"] is True
    assert report["samples"] == 4
    assert [f["factor"] for f in report["factors"]] == ["first_entries"]


def test_verify_fails_with_code_1(source, monkeypatch):
    """A kernel whose Jacobian has a wrong entry."""
    from dataclasses import replace

    from liegen import sources

    def wrong(name, groups):
        (function,) = sources.select(load(name), ["first_entries"])
        program = function.kernel.jacobians
        k = next(i for i, port in enumerate(program.outputs) if port.name == "res_D_x")
        entries = program.results[k]
        results = (*program.results[:k], (entries[1], entries[0], *entries[2:]), *program.results[k + 1 :])
        kernel = replace(function.kernel, jacobians=replace(program, results=results))
        function.__dict__["kernel"] = kernel
        return (function,)

    load = sources.load
    monkeypatch.setattr(sources, "load", wrong)
    done = run("verify", source, "--samples", "4", code=1)
    assert "first_entries: Jacobian failed" in done.stdout
    assert "1 failed: first_entries" in done.stdout


def test_explain_shows_formula_jacobians_and_passes():
    text = run("explain", "between_se3").stdout
    assert "res = z.local(x.between(y))" in text
    assert "res_D_x = -Jr^-1(res) Ad(a^-1)" in text
    assert "with y fixed, x has covariance Ad(z) S Ad(z)^T" in text
    kernel = liegen.library.between_se3.kernel
    rows = [line.split() for line in text.splitlines()]
    for step in kernel.passes:
        assert any(
            row[: len(step.name.split()) + 1] == [*step.name.split(), str(step.operations)] for row in rows
        )
    assert ["total", str(kernel.value.operations), str(kernel.jacobians.operations)] in rows
    assert ["mul", *(str(p.op_counts()["mul"]) for p in (kernel.value, kernel.jacobians))] in rows


# the program itself


def test_help_and_version_load_nothing_heavy():
    program = (
        "import sys, liegen.cli as cli\n"
        "for words in (['--help'], ['--version'], ['generate', '--help'], ['verify', '--help'],\n"
        "              ['check', '--help'], ['list', '--help'], ['explain', '--help']):\n"
        "    cli.app(words, standalone_mode=False)\n"
        "print(sorted({'sympy', 'casadi', 'numpy', 'mpmath', 'jinja2', 'rich'} & set(sys.modules)))"
    )
    out = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "[]"
    assert f"liegen, version {liegen.__version__}" in out
    for command in ("list", "generate", "verify", "check", "explain"):
        assert f"\n  {command} " in out


def test_internal_errors_are_code_3_in_one_line(monkeypatch):
    import liegen.explain

    def fail(_):
        raise RuntimeError("something\nunexpected")

    monkeypatch.setattr(liegen.explain, "explanation", fail)
    done = run("explain", "between_se3", code=3)
    assert done.stderr.splitlines() == [
        "Error: liegen itself failed: RuntimeError: something unexpected",
        "See the traceback with: liegen --debug explain ...",
    ]
    debugged = CliRunner().invoke(app, ["--debug", "explain", "between_se3"])
    assert isinstance(debugged.exception, RuntimeError)
    assert isinstance(
        CliRunner(env={"LIEGEN_DEBUG": "1"}).invoke(app, ["explain", "between_se3"]).exception, RuntimeError
    )


def test_python_dash_m():
    command = [sys.executable, "-m", "liegen", "--version"]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout.startswith(
        "liegen, version"
    )
