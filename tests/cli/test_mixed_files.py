"""Files with factors and functions under the options of factors; names that a decorator gives."""

import pytest
from click.testing import CliRunner

from liegen import R3, DefinitionError, factor, function
from liegen.cli import app

MIXED = """from liegen import R3, SE3, factor, function

@factor
def prior(x: R3, *, z: R3):
    return x - z

@function
def moved(x: SE3, p: R3):
    return x @ p
"""
FACTORY = """from liegen import R2, R3, factor

def prior(kind):
    @factor(name=f"prior_{kind.__name__.lower()}")
    def anything(x: kind, *, z: kind):
        return x - z
    return anything

A = prior(R2)
B = prior(R3)
"""


def run(folder, text, *words):
    (folder / "mine.py").write_text(text)
    return CliRunner().invoke(app, [w.replace("FILE", str(folder / "mine.py")) for w in words])


@pytest.mark.parametrize("option", [("--noise", "full"), ("--loss", "huber"), ("--gauss-newton",)])
def test_options_of_factors_leave_functions_as_they_are(tmp_path, option):
    out = tmp_path / "out"
    done = run(tmp_path, MIXED, "generate", "FILE", "-o", str(out), *option)
    assert done.exit_code == 0, done.output
    assert done.stderr.count("note:") == 1
    assert "left as they are: moved" in done.stderr
    code = (out / "mine_gen" / "_moved.py").read_text()
    assert "def moved(x: npt.ArrayLike, p: npt.ArrayLike) -> Array:" in code
    changed = "prior_gauss_newton" if option == ("--gauss-newton",) else "prior"
    text = (out / "mine_gen" / f"_{changed}.py").read_text()
    assert {"--noise": "sqrt_info", "--loss": "rho", "--gauss-newton": "H_x_x"}[option[0]] in text
    checked = run(tmp_path, MIXED, "check", str(out), "FILE")
    assert checked.exit_code == 0, checked.output


def test_verify_takes_the_whole_file(tmp_path):
    done = run(tmp_path, MIXED, "verify", "FILE", "--noise", "isotropic", "--gauss-newton", "--samples", "2")
    assert done.exit_code == 0, done.output
    assert "2 factors, 0 failed" in done.stdout
    assert "left as they are: moved" in done.stderr


@pytest.mark.parametrize("option", [("--noise", "full"), ("--loss", "huber"), ("--gauss-newton",)])
def test_a_function_alone_is_refused_at_its_own_line(tmp_path, option):
    done = run(tmp_path, MIXED, "generate", "FILE", "-f", "moved", "-o", str(tmp_path / "out"), *option)
    assert done.exit_code == 2
    assert "mine.py:7: " in done.stderr
    assert "moved" in done.stderr
    assert not (tmp_path / "out").exists()


def test_factories_give_names(tmp_path):
    done = run(tmp_path, FACTORY, "list", "FILE")
    assert done.exit_code == 0, done.output
    assert "prior_r2  x: R2, *, z: R2" in done.stdout
    assert "prior_r3  x: R3, *, z: R3" in done.stdout


def test_two_factors_of_one_name_are_refused_with_both_lines(tmp_path):
    done = run(tmp_path, FACTORY.replace('name=f"prior_{kind.__name__.lower()}"', ""), "list", "FILE")
    assert done.exit_code == 2
    for words in ("A (mine.py:9)", "B (mine.py:10)", "'anything'", "name=... in @factor"):
        assert words in done.stderr


def test_the_name_of_a_function():
    @function(name="twice")
    def f(x: R3):
        return x + x

    assert f.name == f.kernel.name == "twice"


@pytest.mark.parametrize(
    ("name", "says"), [(5, "got 5"), ("a b", "'a b'"), (None, "got None"), ("1x", "'1x'")]
)
def test_odd_names_are_refused(name, says):
    with pytest.raises(DefinitionError, match=f"test_mixed_files.py:.*f: name= is .*{says}"):

        @factor(name=name)
        def f(x: R3):
            return x
