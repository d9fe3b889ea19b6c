"""`check-jacobian` on functions that are right and on functions with one known mistake.

The functions use matrices, SciPy's expm, and central differences, nothing of liegen.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from compiler_tools import needs_compiler
from liegen import R3, SE3, factor, library
from liegen.cli import app
from liegen.errors import LiegenError, SourceError, ToolError
from liegen.foreign import compare, foreign
from liegen.foreign.calls import of_callable
from liegen.native import compile_shared

SWAP = [3, 4, 5, 0, 1, 2]


def hat(d):
    w, v = d[:3], d[3:]
    return np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0, 0, 0, 0.0]])


def matrix(pose):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_quat(pose[:4]).as_matrix(), pose[4:]
    return T


def log(T):
    """(w, v) with T = expm(hat(w, v)) and t = V v: V is a block of expm([[hat(w), I], [0, 0]])."""
    w = Rotation.from_matrix(T[:3, :3]).as_rotvec()
    both = np.zeros((6, 6))
    both[:3, :3], both[:3, 3:] = hat(np.array([*w, 0, 0, 0]))[:3, :3], np.eye(3)
    return np.array([*w, *np.linalg.solve(expm(both)[:3, 3:], T[:3, 3])])


def adjoint(T):
    R, t = T[:3, :3], T[:3, 3]
    A = np.zeros((6, 6))
    A[:3, :3] = A[3:, 3:] = R
    A[3:, :3] = hat(np.array([*t, 0, 0, 0]))[:3, :3] @ R
    return A


def differences(f, step=1e-5):
    columns = [(f(step * e) - f(-step * e)) / (2 * step) for e in np.eye(6)]
    return np.stack(columns, axis=-1)


def residual(X, Y, Z):
    return log(np.linalg.inv(Z) @ np.linalg.inv(X) @ Y)


def right(x, y, z):
    X, Y, Z = matrix(x), matrix(y), matrix(z)
    by_x = differences(lambda d: residual(X @ expm(hat(d)), Y, Z))
    return residual(X, Y, Z), by_x, differences(lambda d: residual(X, Y @ expm(hat(d)), Z))


def left(x, y, z):
    X, Y, Z = matrix(x), matrix(y), matrix(z)
    by_x = differences(lambda d: residual(expm(hat(d)) @ X, Y, Z))
    return residual(X, Y, Z), by_x, differences(lambda d: residual(X, expm(hat(d)) @ Y, Z))


def left_in_x(x, y, z):
    return *left(x, y, z)[:2], right(x, y, z)[2]


def translation_first(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r[SWAP], by_x[SWAP][:, SWAP], by_y[SWAP][:, SWAP]


def columns_translation_first(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r, by_x[:, SWAP], by_y[:, SWAP]


def opposite_sign(x, y, z):
    return tuple(-a for a in right(x, y, z))


def opposite_sign_by_x(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r, -by_x, by_y


def without_jr(x, y, z):
    X, Y, Z = matrix(x), matrix(y), matrix(z)
    return residual(X, Y, Z), -adjoint(np.linalg.inv(Y) @ X), np.eye(6)


def half_angles(x, y, z):
    r, by_x, by_y = right(x, y, z)
    scale = np.array([2, 2, 2, 1, 1, 1.0])
    return r, by_x * scale, by_y * scale


def without_jr_and_swapped(x, y, z):
    r, by_x, by_y = without_jr(x, y, z)
    return r[SWAP], by_x[SWAP][:, SWAP], by_y[SWAP][:, SWAP]


def nonsense(x, y, z):
    r, by_x, by_y = right(x, y, z)
    by_y[1, 4] += 0.25
    return r, by_x, by_y


ROWS, COLUMNS = "the tangent of the residual has the", "the tangent of {} has the translation before rotation"
SWAPPED_ROWS = f"{ROWS} translation before rotation"
JR = "Jr^-1(res) is missing (right at zero residual only)"
LEFT = "{0} is perturbed from the left, Exp(d) {0}"
SIGN = "the sign is opposite"
HALF = "rotations are given by half of the angle"


@pytest.mark.parametrize(
    ("function", "verdicts"),
    [
        (right, [(), (), ()]),
        (left, [(), (LEFT.format("x"),), (LEFT.format("y"),)]),
        (left_in_x, [(), (LEFT.format("x"),), ()]),
        (
            translation_first,
            [
                (SWAPPED_ROWS,),
                (COLUMNS.format("x"), SWAPPED_ROWS),
                (COLUMNS.format("y"), SWAPPED_ROWS),
            ],
        ),
        (columns_translation_first, [(), (COLUMNS.format("x"),), (COLUMNS.format("y"),)]),
        (opposite_sign, [(SIGN,)] * 3),
        (opposite_sign_by_x, [(), (SIGN,), ()]),
        (without_jr, [(), (JR,), (JR,)]),
        (half_angles, [(), (HALF,), (HALF,)]),
        (
            without_jr_and_swapped,
            [
                (SWAPPED_ROWS,),
                (JR, COLUMNS.format("x"), SWAPPED_ROWS),
                (JR,),  # the identity, in any order
            ],
        ),
    ],
    ids=lambda p: getattr(p, "__name__", ""),
)
def test_it_says_which_convention_differs(function, verdicts):
    between = library.between_se3
    found = compare(between, of_callable(function, between.kernel, "here"), samples=6)
    assert [f.name for f in found.findings] == ["res", "res_D_x", "res_D_y"]
    assert [f.differences for f in found.findings] == verdicts
    assert [f.correct for f in found.findings] == [not v for v in verdicts]
    assert found.passed == (not any(verdicts))


def test_what_no_convention_explains_is_located():
    between = library.between_se3
    res, by_x, by_y = compare(between, of_callable(nonsense, between.kernel, "here"), samples=6).findings
    assert res.correct
    assert by_x.correct
    assert by_y.entry == (1, 4)
    assert by_y.found - by_y.expected == pytest.approx(0.25, abs=1e-7)
    assert by_y.verdict == (
        f"wrong, none of {by_y.tried} known explanations fits: "
        "only entry [1, 4] (row 1, column 4, y [m]) is 0.25 above the right value, at all samples"
    )
    assert by_y.tried > 10_000
    assert by_y.sample.startswith("x = [")


def test_right_at_zero_residual_only():
    """The gradient of the residual scaled by a function of its length that is 1 at 0."""
    between = library.between_se3

    def scaled(x, y, z):
        r, by_x, by_y = right(x, y, z)
        return r, by_x * np.cos(r @ r), by_y

    found = compare(between, of_callable(scaled, between.kernel, "here"), samples=6).findings
    assert [f.correct for f in found] == [True, False, True]
    assert found[1].verdict.startswith("wrong away from zero residual, none of ")
    assert "at all samples" not in found[1].verdict


def test_not_a_number_is_never_correct():
    between = library.between_se3

    def broken(x, y, z):
        r, by_x, by_y = right(x, y, z)
        by_x[2, 3] = np.nan
        return r, by_x, by_y

    found = compare(between, of_callable(broken, between.kernel, "here"), samples=3).findings
    assert (found[1].correct, found[1].entry, found[1].worst) == (False, (2, 3), np.inf)


# the command line

RANGE = """
import numpy as np

def right(x, y, z):
    d = y - x
    n = max(np.linalg.norm(d), 1e-300)
    return n - z, -d / n, d / n

def wrong(x, y, z):
    r, by_x, by_y = right(x, y, z)
    return r, by_y, by_y

def short(x, y, z):
    return right(x, y, z)[:2]

def odd(x, y, z):
    return right(x, y, z)[0], np.zeros((3, 1)), np.zeros(3)

def fails(x, y, z):
    raise ZeroDivisionError("no luck")
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(RANGE)
    return path


def run(*arguments, code):
    done = CliRunner().invoke(app, ["check-jacobian", *map(str, arguments)])
    assert done.exit_code == code, done.output
    return done.output


def test_command_on_a_file(file):
    lines = run("range_r3", "--against", f"{file}:right", code=0).splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["res", "res_D_x", "res_D_y"]
    assert all(line.endswith("correct") for line in lines[1:4])
    output = run("range_r3", "--against", f"{file}:wrong", code=1)
    assert SIGN in next(line for line in output.splitlines() if line.startswith("res_D_x"))
    assert "res_D_x is worst at: x = [" in output


def test_command_on_a_module_and_as_json(file, monkeypatch):
    monkeypatch.chdir(file.parent)
    monkeypatch.setattr(sys, "path", [str(file.parent), *sys.path])
    found = json.loads(run("range_r3", "--against", "mine:wrong", "--json", "--samples", "5", code=1))
    assert (found["factor"], found["passed"]) == ("range_r3", False)
    assert found["samples"] > 5  # the random ones, and special ones beside them
    assert [f["differences"] for f in found["findings"]] == [[], [SIGN], []]


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("{}", "is not FILE.py:FUNCTION"), ("{}:nothing", "has no function 'nothing'"),
        ("{}x.py:right", "does not exist"), ("nosuchmodule:f", "cannot be imported"),
        ("{}:short", "must return 3 arrays: the residual, the Jacobian by x, the Jacobian by y"),
        ("{}:odd", "the Jacobian by x has shape (3, 1), (1, 3) is needed"),
        ("{}:fails", "raised ZeroDivisionError: no luck"), ("{}.so:right", "cannot be loaded"),
        ("{}.c:right", "is not compiled; compile it and give the library, for example: cc -shared"),
    ],
)  # fmt: skip
def test_wrong_use_is_explained(file, place, words):
    assert words in run("range_r3", "--against", place.format(file), code=2)


def test_a_function_with_several_outputs_is_refused():
    from liegen import function, outputs

    @function
    def both(x: SE3, p: R3):
        return outputs(q=x @ p, t=x.translation)

    with pytest.raises(LiegenError, match="both has several outputs"):
        compare(both, lambda _: ())


def test_users_factor_without_a_sampler():
    @factor
    def moved(x: SE3, p: R3, *, z: R3):
        return x @ p - z

    def mine(x, p, z):
        T = matrix(x)
        by_x = T[:3, :3] @ np.hstack([-hat(np.array([*p, 0, 0, 0]))[:3, :3], np.eye(3)])
        return (T @ [*p, 1])[:3] - z, by_x, T[:3, :3]

    assert compare(moved, of_callable(mine, moved.kernel, "here"), tolerance=1e-12).passed


C_RANGE = """
#include <math.h>
int good(const double *x, const double *y, const double *z, double *res, double *by_x, double *by_y) {
    double d[3], n = 0;
    for (int k = 0; k < 3; ++k) { d[k] = y[k] - x[k]; n += d[k] * d[k]; }
    n = sqrt(n);
    res[0] = n - z[0];
    for (int k = 0; k < 3; ++k) { by_x[k] = -d[k] / n; by_y[k] = d[k] / n; }
    return 0;
}
int bad(const double *x, const double *y, const double *z, double *res, double *by_x, double *by_y) {
    good(x, y, z, res, by_x, by_y);
    by_y[2] *= 2;
    return 0;
}
"""


@needs_compiler
def test_c_functions(tmp_path):
    (tmp_path / "mine.c").write_text(C_RANGE)
    shared = tmp_path / "mine.so"
    compile_shared([tmp_path / "mine.c"], shared, ["-O1"])
    assert compare(library.range_r3, foreign(f"{shared}:good", library.range_r3)).passed
    _, by_x, by_y = compare(library.range_r3, foreign(f"{shared}:bad", library.range_r3)).findings
    assert by_x.correct
    assert (by_y.correct, by_y.entry, by_y.differences) == (False, (0, 2), ())
    with pytest.raises(SourceError, match="has no function 'ugly'"):
        foreign(f"{shared}:ugly", library.range_r3)
    assert Path(shared).is_file()


def test_errors_of_the_function_are_its_own():
    def fails(x, y, z):
        raise KeyError(x[0])

    between = library.between_se3
    with pytest.raises(ToolError, match="here raised KeyError"):
        compare(between, of_callable(fails, between.kernel, "here"))
