"""Every mistake in a factor file gets one message: the line, the factor, the argument, the cure."""

import pytest
from click.testing import CliRunner

from liegen.cli import app

HEAD = """import math
import numpy as np
import liegen
from liegen import R1, R2, R3, SE2, SE3, SO3, S2, factor, function, norm, outputs, require, stack


"""
#: The `def` of the factor is on this line, its body on the next; errors name the decorator's or these.
DEF = HEAD.count("\n") + 2


def broken(signature, body, decorator="@factor"):
    return f"{HEAD}{decorator}\ndef broken({signature}):\n    {body}\n"


BODY, HERE = f"factors.py:{DEF + 1}", f"factors.py:{DEF}"
DECORATOR = f"factors.py:{DEF - 1}"
NO_NUMBER = "while a factor is traced it has no number"

#: Source, then what the message must say: place, names, cure.
MISTAKES = {
    "unknown annotation": (
        broken("x: SE4, *, z: SE3", "return z.local(x)"),
        [HERE, "broken", "'x'", "unknown annotation 'SE4'", "R1 to R9", "SE3", "class R12(R, dim=12)"],
    ),
    "annotation that is not imported": (
        "from __future__ import annotations\nfrom liegen import SE3, factor\n\n\n@factor\n"
        "def broken(x: SE3, *, z: SE2):\n    return x.log()\n",
        ["factors.py:5", "broken", "'z'", "unknown annotation 'SE2'", "from liegen import SE2"],
    ),
    "annotation that is no manifold": (
        broken("x: float", "return x"),
        [DECORATOR, "broken", "'x'", "annotated with float", "no manifold", "R1 to R9"],
    ),
    "missing annotation": (
        broken("x, *, z: SE3", "return z.local(x)"),
        [DECORATOR, "broken", "'x'", "no annotation", "x: SE3"],
    ),
    "variable that is never used": (
        broken("x: SE3, y: SE3, *, z: SE3", "return z.local(x)"),
        [DECORATOR, "broken", "'y'", "never used", "remove it", "after the *"],
    ),
    "no variables": (
        broken("*, z: SE3", "return z.log()"),
        [DECORATOR, "broken", "no variables", "before the *"],
    ),
    "frames that do not cancel": (
        broken("T_AB: SE3, T_CB: SE3", "return (T_AB @ T_CB).log()"),
        [
            BODY,
            "broken",
            "inner frame of T_AB is B",
            "outer frame of T_CB is C",
            "write T_AB @ T_CB.inverse()",
        ],
    ),
    "point of another frame": (
        broken("T_WB: SE3, p_W: R3, *, z_W: R3", "return T_WB.transform_from(p_W) - z_W"),
        [BODY, "broken", "inner frame of T_WB is B", "frame of p_W is W", "write T_WB.transform_to(p_W)"],
    ),
    "frames that a manifold does not have": (
        "from typing import Annotated\n" + broken("x: Annotated[R1, liegen.frames('W')]", "return x"),
        ["broken", "'x'", "R1 has no frames, frames('W') names 1"],
    ),
    "frames that are not imported": (
        "from __future__ import annotations\nfrom typing import Annotated\n"
        "from liegen import SE3, factor\n\n\n"
        "@factor\ndef broken(x: Annotated[SE3, frames('W', 'B')]):\n    return x.log()\n",
        ["factors.py:6", "broken", "'x'", "from liegen import frames"],
    ),
    "manifolds that do not compose": (
        broken("x: SE3, y: SO3", "return (x @ y).log()"),
        [BODY, "broken", "compose", "x (SE3)", "y (SO3)", "give it two of SE3"],
    ),
    "local of two manifolds": (
        broken("x: SE3, y: SE2", "return x.local(y)"),
        [BODY, "broken", "local", "x (SE3)", "y (SE2)", "give it two of SE3"],
    ),
    "sum of two dimensions": (
        broken("x: R3, y: R2", "return x + y"),
        [BODY, "broken", "x (R3)", "y (R2)", "same dimension"],
    ),
    "tangent vector of another dimension": (
        broken("x: SE3, v: R3", "return x.retract(v).log()"),
        [BODY, "broken", "SE3.retract", "6 entries", "v (R3)", "stack()"],
    ),
    "matrix of another shape": (
        broken("x: R3", "return np.eye(2) @ x"),
        [BODY, "broken", "(2, 2)", "x (R3)", "3 columns"],
    ),
    "array that is no vector": (
        broken("x: R3", "return x / np.eye(3)"),
        [BODY, "broken", "(3, 3)", "constant of a formula", "make it an argument"],
    ),
    "index out of range": (broken("x: R3", "return x[3]"), [BODY, "broken", "x (R3)", "0 to 2", "[3]"]),
    "empty slice": (broken("x: R3", "return x[5:]"), [BODY, "broken", "x (R3)", "0 to 2"]),
    "ufunc of NumPy": (
        broken("x: R3", "return np.sin(x)"),
        [BODY, "broken", "np.sin", "x (R3)", "write sin(x) (from liegen import sin)"],
    ),
    "function of NumPy": (
        broken("x: R3", "return R1(np.linalg.norm(x))"),
        [BODY, "broken", "x (R3)", "NumPy array", NO_NUMBER, "write norm(x)"],
    ),
    "function of math": (
        broken("x: R1", "return R1(math.sin(x))"),
        [BODY, "broken", "x (R1)", "float", NO_NUMBER, "write sin(x)"],
    ),
    "float": (
        broken("x: R1", "return R1(float(x))"),
        [BODY, "broken", "x (R1)", "float()", NO_NUMBER, "write x"],
    ),
    "if": (
        broken("x: R1", "return x if x > 0 else -x"),
        [BODY, "broken", "branch on 0 < x", NO_NUMBER, "write where(x > 0, x, -x)"],
    ),
    "and": (
        broken("x: R1", "return liegen.where(x > 0 and x < 1, x, -x)"),
        [BODY, "broken", "branch on 0 < x", NO_NUMBER, "write (x > 0) & (x < 1)"],
    ),
    "comparison with ==": (
        broken("x: R1", "return x if x == 0 else -x"),
        [BODY, "broken", "compare x (R1) with ==", NO_NUMBER, "write abs(x) < 1e-9"],
    ),
    "operator that a group lacks": (
        broken("x: SE3, y: SE3", "return (x * y).log()"),
        [BODY, "broken", "'SE3' and 'SE3'", "write x @ y"],
    ),
    "method that does not exist": (
        broken("x: R3", "return x.foo"),
        [BODY, "broken", "x (R3)", "'foo'", "entries [k]", "norm", "dot"],
    ),
    "assignment": (broken("x: R3", "x[0] = 1"), [BODY, "broken", "item assignment"]),
    "return is missing": (
        broken("x: R1", "y = x + 1"),
        [DECORATOR, "broken", "returns one vector", "got nothing", "is the return missing?"],
    ),
    "return of a group element": (
        broken("x: SE3", "return x.inverse()"),
        [DECORATOR, "broken", "returns one vector", "SE3", "x.local(y)", "@function"],
    ),
    "output that is no value": (
        broken("x: SE3", "return outputs(a=1)", "@function"),
        [BODY, "broken", "'a'", "int"],
    ),
    "output of constants alone": (
        broken("x: R3", "return outputs(a=x, b=R3(1, 2, 3))", "@function"),
        [DECORATOR, "broken", "'b'", "depends on no argument"],
    ),
    "starred arguments": (
        broken("*x: R1", "return x[0]"),
        [DECORATOR, "broken", "*x", "name every argument"],
    ),
    "starred keywords": (
        broken("x: R1, **y: R1", "return x"),
        [DECORATOR, "broken", "**y", "name every argument"],
    ),
    "requirement that cannot hold": (
        broken("x: R1", "require(1 < 0, 'never'); return x"),
        [BODY, "broken", "never"],
    ),
    "another factor called with the wrong manifold": (
        broken("x: SE3, y: SE2", "return liegen.library.prior_se3(y, z=x)").replace(
            "import liegen\n", "import liegen.library\n"
        ),
        [BODY, "broken", "prior_se3", "'x'", "must be SE3", "y (SE2)"],
    ),
    "another factor called without an argument": (
        broken("x: SE3", "return liegen.library.prior_se3(x)").replace(
            "import liegen\n", "import liegen.library\n"
        ),
        [BODY, "broken", "prior_se3(x, z=)"],
    ),
    "constant of the wrong size": (
        f"{HEAD}LEVER = SE3.exp([1.0, 2.0])\n",
        [DECORATOR, "SE3.exp", "6 entries", "with 2"],
    ),
    "factor of no function": (f"{HEAD}broken = factor(3)\n", [DECORATOR, "made of a function", "int"]),
    "vary of an unknown argument": (
        broken("x: R3, *, z: R3", "return x - z") + "\n\nfree = broken.vary('w')\n",
        ["factors.py:12", "broken", "'w'", "x, z"],
    ),
    "class of vectors without a dimension": (
        f"{HEAD}class R12(liegen.R):\n    pass\n",
        ["R12", "R12(R, dim=12)"],
    ),
    # names
    "argument is a C keyword": (
        broken("x: SE3, *, double: SE3", "return double.local(x)"),
        ["factors.py", "broken", "'double'", "C keyword", "rename it"],
    ),
    "argument is reserved": (
        broken("res: SE3, *, z: SE3", "return z.local(res)"),
        ["factors.py", "broken", "'res'", "reserved", "rename it"],
    ),
    "argument is reserved too": (
        broken("np: SE3, *, z: SE3", "return z.local(np)"),
        ["factors.py", "broken", "'np'", "reserved", "rename it"],
    ),
    "argument is no C identifier": (
        broken("é: SE3, *, z: SE3", "return z.local(é)"),
        ["factors.py", "broken", "'é'", "no C identifier", "rename it"],
    ),
    "factor is a C keyword": (
        broken("x: R3", "return x").replace("broken", "register"),
        ["factors.py", "'register'", "C keyword", "rename it"],
    ),
    "factor has no name": (f"{HEAD}broken = factor(lambda x: x)\n", [DECORATOR, "'x'", "no annotation"]),
    "two factors with one name": (
        broken("x: R1", "return x") + "\n\n@factor\ndef broken(x: R2):\n    return x\n",
        ["factors.py:13", "factors.py:8", "'broken'", "rename one of them"],
    ),
    "vary keeps the name": (
        broken("x: R1, y: R1", "return x - y") + "\n\nother = broken.fix('y')\n",
        ["broken (factors.py:8)", "other (factors.py:12)", "'broken'", "name=..."],
    ),
    # domains
    "not a number everywhere": (
        broken("x: R3", "return liegen.log(-1 - norm(x))"),
        [DECORATOR, BODY, "broken", "'res'", "'log'", "32 random samples", "require(...)"],
    ),
    "Jacobian not a number everywhere": (
        broken("x: R3", "return liegen.sqrt(norm(x) / norm(x) - 1)"),
        [DECORATOR, BODY, "broken", "'res_D_x'", "'sqrt'", "32 random samples", "require(...)"],
    ),
    "domain that no sample reaches": (
        broken("x: R3", "require(norm(x) < 0, 'never near'); return x"),
        [DECORATOR, "broken", "never near", "correct the require", "@factor(sample=...)"],
    ),
    # files
    "syntax error": (broken("x: R1", "return x +"), [BODY, "syntax error", "return x +"]),
    "module that is not there": (
        "import liegen\nimport not_there\n",
        ["factors.py:2", "cannot import not_there", "install it"],
    ),
    "exception": (f"{HEAD}VALUE = 1 / 0\n", [DECORATOR, "ZeroDivisionError", "division by zero"]),
    "exception of a helper": (
        f"{HEAD}def helper():\n    return [][0]\n\n\nhelper()\n",
        ["factors.py:8", "IndexError"],
    ),
    "name that does not exist": (f"{HEAD}VALUE = SE5\n", [DECORATOR, "NameError", "'SE5'"]),
    "end of the program": ("import sys\n\nsys.exit(3)\n", ["factors.py:3", "__main__"]),
    "no factor": ("from liegen.library import between_se3\n", ["factors.py", "no factor", "@factor"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_gets_a_clear_error(name, tmp_path, monkeypatch):
    source, says = MISTAKES[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "factors.py").write_text(source, encoding="utf-8")
    done = CliRunner().invoke(app, ["generate", "factors.py", "-o", "out"])
    assert done.exit_code == 2, done.output
    assert not (tmp_path / "out").exists()
    for words in says:
        assert words in done.stderr, done.stderr
    assert done.stderr.startswith("Error: ")
    assert done.stderr.count("\n") == 1
    for machinery in ("Traceback", "casadi", "sympy", "site-packages", str(tmp_path)):
        assert machinery not in done.stderr.lower()


def test_a_neighbour_with_a_mistake_is_named(tmp_path):
    (tmp_path / "my_neighbour_file.py").write_text("x = (\n")
    (tmp_path / "factors.py").write_text("import my_neighbour_file\n")
    done = CliRunner().invoke(app, ["list", str(tmp_path / "factors.py")])
    assert done.exit_code == 2
    assert "my_neighbour_file.py:1: syntax error" in done.stderr


def test_isolated_singular_points_are_no_error(tmp_path):
    """The identity is singular here, random samples are not."""
    (tmp_path / "factors.py").write_text(broken("x: R3", "return x / norm(x)"))
    done = CliRunner().invoke(app, ["generate", str(tmp_path / "factors.py"), "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
