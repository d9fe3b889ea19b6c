"""What users of other libraries write gets what to write here, with the user's own words and line."""

from __future__ import annotations

import importlib.util
import linecache
import re
import subprocess
import sys

import pytest
from click.testing import CliRunner

import liegen
from liegen import R1, R3, SE3, SO3, DefinitionError, factor, norm, stack
from liegen.cli import app

HEAD = """import math
import casadi as ca
import sympy as sp
import numpy as np
import liegen
from liegen import R1, R2, R3, R6, S2, SE2, SE3, SO2, SO3, Sim3, Cal3_S2, NavState, Product
from liegen import factor, dot, norm, outputs, require, stack, where, sin
class State(Product):
    pose: SE3
    vel: R3


"""
ARGUMENTS = (
    "x: R1, y: R1, p: R3, q: R3, v: R3, d: R6, T: SE3, U: SE3, P: SE2, R: SO3, S: SO3, h: SO2, n: S2, m: S2, "
    "K: Cal3_S2, N: NavState, s: Sim3, X: State"
)
LINE = HEAD.count("\n") + 3

#: The body of a factor, and what the message says to write.
MISTAKES = {
    # methods that are functions here
    "return p.norm()": "write norm(p)",
    "return (p - q).norm()": "write norm(p - q)",
    "return p.squaredNorm()": "write dot(p, p)",
    "return p.normalized()": "write p / norm(p)",
    "return p.dot(q)": "write dot(p, q)",
    "return p.cross(q)": "write cross(p, q) (from liegen import cross)",
    "return x.sqrt()": "write sqrt(x) (from liegen import sqrt)",
    "return x.exp()": "write exp(x)",
    "return p.sum()": "write sum(p)",
    "return p.head(2)": "write p[:2]",
    "return p.normm()": "write norm(p)",
    "return n.dot(v)": "write dot(n.vector, v)",
    "return n.dot(m)": "write dot(n.vector, m.vector)",
    # attributes
    "return v.x": "write v[0]",
    "return x.item()": "write x",
    "return p.T @ q": "write dot(p, q)",
    "return n.z": "write n.vector[2]",
    "return K.fx": "write K.uncalibrate(q)",
    "return K.project(p)": "write K.uncalibrate(p[:2] / p[2])",
    "return T.t": "write T.translation",
    "return T.R": "write T.rotation",
    "return T.x()": "write T.translation[0]",
    "return P.theta()": "write P.rotation.log()[0]",
    "return h.angle": "write h.log()[0]",
    "return N.v": "write N.velocity",
    "return N.transform_from(p)": "write N.pose @ p",
    "return s.s": "write s.scale",
    "return X.velo": "write X.vel",
    "return X.translation": "write X.pose.translation",
    "return T.tranlation": "write T.translation",
    "return T.rotation()": "write T.rotation, without parentheses",
    "return p(0)": "write p[0]",
    # groups in the words of GTSAM, Sophus and manif
    "return T.inv()": "write T.inverse()",
    "return R.conj()": "write R.inverse()",
    "return R.T @ p": "write R.inverse()",
    "return T.transformFrom(p)": "write T.transform_from(p)",
    "return T.act(p)": "write T @ p",
    "return T.localCoordinates(U)": "write T.local(U)",
    "return U.minus(T)": "write T.local(U)",
    "return R.as_rotvec()": "write R.log()",
    "return R.slerp(S, x)": "write R @ SO3.exp(x * R.between(S).log())",
    "return T.adjoint()": "write (T @ SE3.exp(v) @ T.inverse()).log()",
    "return T.AdjointMap()": "write (T @ SE3.exp(v) @ T.inverse()).log()",
    "return T.matrix() @ p": "write T @ p",
    "return SE3.Logmap(T)": "write T.log()",
    "return SE3.Expmap(d).log()": "write SE3.exp(d)",
    "return SO3.Rx(x).log()": "write SO3.exp(stack(x, 0, 0))",
    "return SO3(v).log()": "write SO3.exp(v)",
    "return SE3().log()": "write SE3.identity()",
    "return Pose3(R, p).log()": "write SE3(R, p)",
    # operators
    "return T * p": "write T @ p",
    "return p * T": "write T @ p",
    "return R * S": "write R @ S",
    "return T + d": "write T.retract(d)",
    "return T - U": "write U.local(T)",
    "return T / U": "write T @ U.inverse()",
    "return T ** -1": "write T.inverse()",
    "return -T": "write T.inverse()",
    "return 2 * T": "write SE3.exp(2 * T.log())",
    "return p - T": "write p - T.translation",
    "return p + n": "write p + n.vector",
    "return R @ T": "write R @ T.rotation",
    "return T @ N": "write T @ N.pose",
    "return n @ m": "write dot(n.vector, m.vector)",
    "return R * n": "write R @ n.vector",
    "return K @ p": "write K.uncalibrate(p[:2] / p[2])",
    "return p @ q": "write dot(p, q)",
    "return p @ T": "write T @ p",
    "return x ** y": "write exp(y * log(x))",
    "return x ** 0.5": "write sqrt(x)",
    "return x ** -2": "write 1 / x ** 2",
    "return 2 ** x": "write exp(x * log(2))",
    "return x % y": "write atan2(sin(x), cos(x))",
    "return p ^ q": "write cross(p, q)",
    # functions of Python, math and NumPy
    "return atan(x)": "write atan2(x, 1) (from liegen import atan2)",
    "return sqrt(x)": "write from liegen import sqrt",
    "return liegen.arctan2(x, y)": "write atan2(x, y)",
    "return np.sin(x)": "write sin(x)",
    "return math.sqrt(x)": "write sqrt(x)",
    "return math.hypot(x, y)": "write norm(stack(x, y))",
    "return float(x)": "write x",
    "return abs(R)": "write norm(R.log())",
    "return max(x, y)": "write maximum(x, y) (from liegen import maximum)",
    "return min([x, y, 1])": "write minimum(minimum(x, y), 1)",
    "return np.linalg.norm(p - q)": "write norm(p - q)",
    "return np.dot(p, q)": "write dot(p, q)",
    "return np.dot(R.matrix(), p)": "write R.matrix() @ p",
    "return np.array([x, y])": "write stack(x, y)",
    "return np.concatenate([p, q])": "write stack(p, q)",
    "return np.arctan2(x, y)": "write atan2(x, y)",
    "return np.clip(x, 0, 1)": "write minimum(maximum(x, 0), 1)",
    "return np.where(x > 0, x, y)": "write where(x > 0, x, y)",
    "return np.linalg.inv(T)": "write T.inverse()",
    "return np.power(x, 3)": "write x ** 3",
    "return np.trace(R.matrix())": "write R.matrix()[0, 0] + R.matrix()[1, 1] + R.matrix()[2, 2]",
    "return sp.sqrt(x)": "write sqrt(x)",
    "return sp.Matrix([x, y])": "write stack(x, y)",
    "return ca.norm_2(p)": "write norm(p)",
    "return ca.if_else(x > 0, x, y)": "write where(x > 0, x, y)",
    "return jnp.sin(x)": "write sin(x)",
    "return np.array([[x, y], [y, x]]) @ p[:2]": "write stack(dot([x, y], v), dot([y, x], v))",
    "return pi * x": "write math.pi",
    "return len(T)": "write 6, the dimension of SE3",
    "return sum(T)": "write T.rotation, T.translation",
    "a, b = T; return a": "write T.rotation, T.translation",
    "return norm(T)": "write norm(T.translation)",
    "return dot(n, p)": "write dot(n.vector, p)",
    # conditions
    "return x if x > 0 else -x": "write where(x > 0, x, -x)",
    "if x > 0: return x\n    return -x": "write return where(x > 0, x, -x)",
    "if x > 0: y = x\n    return y": "write y = where(x > 0, x, y)",
    "return where(x > 0 and y > 0, x, y)": "write (x > 0) & (y > 0)",
    "return where(x > 0 or y > 0, x, y)": "write (x > 0) | (y > 0)",
    "return where(not x > 0, x, y)": "write ~(x > 0)",
    "return where(0 < x < 1, x, y)": "write (0 < x) & (x < 1)",
    "return where(0 < x < 1 and not y > 0, x, y)": "write (0 < x) & (x < 1) & (~(y > 0))",
    "return where(x > 0 & y > 0, x, y)": "write (x > 0) & (y > 0)",
    "return where(any([x > 0, y > 0]), x, y)": "write (x > 0) | (y > 0)",
    "return (x > 0) and x or y": "write where(x > 0, x, y)",
    "return where(x in (1, 2), x, y)": "write (abs(x - 1) < 1e-9) | (abs(x - 2) < 1e-9)",
    "return where((x > 0) == False, x, y)": "write ~(x > 0)",
    "return where(x, x, y)": "where needs a condition first, got x (R1); write one, such as x > 0",
    "return where(x and y, x, y)": "such as (x > 0) & (y > 0)",
    "return where(x > 0, T, U).log()": "write SE3.exp(where(x > 0, T.log(), U.log()))",
    "return (x > 0) * y": "write where(x > 0, y, 0.0)",
    "assert x > 0; return x": 'write require(x > 0, "why")',
    "return where(x == y, x, y)": "write abs(x - y) < 1e-9",
    "return where(T != U, x, y)": "write norm(T.local(U)) >= 1e-9",
    "return where(p > q, x, y)": "norm(q) < norm(p) for lengths",
    # entries
    "return n[0]": "write n.vector[0]",
    "return R[0, 1]": "write R.matrix()[0, 1]",
    "return T[:3, :3]": "write T.rotation.matrix()",
    "return p[0, 1]": "write stack(p[0], p[1])",
    "p[0] = x; return p": "write p = stack(x, p[1], p[2])",
    "return R.matrix()[:2, :2]": "the rows [i] and the columns [:, j]",
}


def module(folder, text, name="factors"):
    path = folder / f"{name}.py"
    path.write_text(text)
    linecache.clearcache()
    spec = importlib.util.spec_from_file_location(name, path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


@pytest.mark.parametrize("body", MISTAKES)
def test_the_message_says_what_to_write(body, tmp_path, recwarn):
    with pytest.raises(DefinitionError) as caught:
        module(tmp_path, f"{HEAD}@factor\ndef wrong({ARGUMENTS}):\n    {body}\n")
    text = str(caught.value)
    assert text.startswith(f"factors.py:{LINE}: wrong: "), text
    assert re.search(re.escape(MISTAKES[body]) + r"(\W|$)", text), text
    assert "\n" not in text
    assert "their operations" not in text
    assert not recwarn.list


def cure_of(body, folder):
    with pytest.raises(DefinitionError) as caught:
        module(folder, f"{HEAD}@factor\ndef wrong({ARGUMENTS}):\n    {body}\n")
    return re.search(r"write (.*?)(?: for | \(from|, without|, the |, or |;|$)", str(caught.value))[1]


#: Mistakes in a whole expression, whose cure is one too: no conditions, several values or imports.
WHOLE = [
    body
    for body, says in MISTAKES.items()
    if body.startswith("return ")
    and "\n" not in body
    and says.startswith("write ")
    and not any(
        words in body + says
        for words in ("write from", "math.pi", "stack(dot", "len(", "sum(T", "&", "|", "~", "1e-9")
    )
]


@pytest.mark.parametrize("body", WHOLE)
def test_what_the_message_says_can_be_written(body, tmp_path):
    """The cure is a formula of the language: put into the factor, it is a value."""
    cure = cure_of(body, tmp_path)
    formula = cure.replace("SE3.exp(v)", "SE3.exp(d)").replace("uncalibrate(q)", "uncalibrate(p[:2])")
    used = "stack(x, y, p, q, v, d, T.log(), U.log(), P.log(), R.log(), S.log(), h.log(), n.vector, m.vector)"
    rest = "stack(K.uncalibrate(p[:2]), N.log(), s.log(), X.pose.log(), X.vel)"
    text = f"""{HEAD}from liegen import *
from liegen.manifolds import Manifold
from liegen.manifolds.rotation import RotationMatrix
@factor
def right({ARGUMENTS}):
    z = {formula}
    assert isinstance(z, Manifold | RotationMatrix)
    return stack({used}, {rest})
"""
    assert module(tmp_path, text, "cured").right.name == "right"


def test_entries_of_a_rotation_matrix_are_those_of_its_array():
    @factor
    def entries(R: SO3):
        M = R.matrix()
        return stack(M[0, 1], M[2], M[:, 1], M[1, :], M.T[0, 1], M[-1, -1])

    R = SO3.exp([0.3, -0.7, 0.4])
    M = R.matrix()
    expected = [M[0, 1], *M[2], *M[:, 1], *M[1], M[1, 0], M[2, 2]]
    assert list(entries(R).coords) == pytest.approx(expected, abs=1e-15)


def test_lists_with_values_are_stacked():
    @factor
    def listed(x: R1, p: R3):
        return [x, 1.0] - stack([x, 2 * x]) + stack([norm(p), 0.0])

    assert list(listed(R1(2.0), R3(3, 4, 0)).coords) == [5.0, -3.0]


def test_a_helper_shows_its_line_and_that_of_the_factor(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "helping_hand.py").write_text("def length(p):\n    return p.norm()\n")
    text = (
        "from liegen import R3, factor\nfrom helping_hand import length\n\n\n"
        "@factor\ndef wrong(p: R3):\n    return length(p)\n"
    )
    (tmp_path / "factors.py").write_text(text)
    done = CliRunner().invoke(app, ["list", str(tmp_path / "factors.py")])
    assert done.exit_code == 2
    assert done.stderr.startswith(
        "Error: helping_hand.py:2: wrong: p (R3) has no attribute 'norm'; write norm(p)"
    )
    assert "(called at factors.py:7)" in done.stderr


def test_a_cause_is_told(tmp_path):
    text = (
        "from liegen import R3, factor\n\n\n@factor\ndef wrong(p: R3):\n    try:\n        return {}['a']\n"
        "    except KeyError as error:\n        raise ValueError('no table') from error\n"
    )
    with pytest.raises(
        DefinitionError, match=r"factors.py:9: wrong: ValueError: no table \(caused by KeyError: 'a'\)"
    ):
        module(tmp_path, text)


@pytest.mark.parametrize("where", ["factor", "module"])
def test_debug_shows_the_users_own_traceback_and_the_cause(where, tmp_path):
    helper = (
        "from liegen import R3, factor\n\n\ndef inner():\n    return {}['a']\n\n\ndef outer():\n"
        "    try:\n        return inner()\n    except KeyError as error:\n"
        "        raise ValueError('no table') from error\n\n\n"
    )
    use = {"factor": "@factor\ndef wrong(p: R3):\n    return outer()\n", "module": "outer()\n"}[where]
    (tmp_path / "factors.py").write_text(helper + use)
    done = subprocess.run(
        [sys.executable, "-m", "liegen", "--debug", "list", str(tmp_path / "factors.py")],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    for line in (
        "return {}['a']",
        "return inner()",
        "raise ValueError('no table') from error",
        "KeyError: 'a'",
    ):
        assert line in done.stderr, done.stderr
    assert 'factors.py", line 5, in inner' in done.stderr


def test_attributes_that_are_not_there_are_attribute_errors_on_numbers_too():
    p = R3(1, 2, 3)
    assert not hasattr(p, "shape")
    assert getattr(p, "norm", None) is None
    with pytest.raises(AttributeError, match=r"write norm\(p\)"):
        p.norm()
    T = SE3.identity()
    with pytest.raises(AttributeError, match=r"write T\.inverse\(\)"):
        T.inv()


def test_classes_of_other_libraries_are_told_in_annotations():
    with pytest.raises(DefinitionError, match="'x' is annotated with float, which is no manifold; write R1"):

        @factor
        def scalar(x: float):
            return x

    assert liegen.factor is factor


@pytest.mark.parametrize("group", [liegen.SO2, SO3, liegen.SE2, SE3, liegen.SE23, liegen.Gal3, liegen.Sim3])
@pytest.mark.parametrize("size", [0.0, 800.0, 1e200, float("nan")])
def test_numbers_without_a_result_give_no_warnings(group, size, recwarn):
    """A warning would name a line of liegen's own."""
    v = [size] * group.form.dim
    x = group.exp(v)
    for method in (x.matrix, x.adjoint, x.log, x.inverse):
        method()
    for jacobian in (group.Jr, group.Jl, group.Jr_inv, group.Jl_inv):
        jacobian(v)
    x.local(x.retract(v))
    assert not recwarn.list
