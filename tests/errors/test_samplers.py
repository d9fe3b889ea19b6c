"""Samplers that users write: what they give may be arrays, what they do wrong is one clear error."""

import numpy as np
import pytest
from click.testing import CliRunner

import liegen
from liegen import R1, R3, SE3, DefinitionError, factor
from liegen.cli import app
from liegen.samples import CASES, Draw, sampler_of

HEAD = """import numpy as np
import liegen
from liegen import R1, R3, SE3, factor


def sample(draw, case):
    {body}


@factor(sample={sampler})
def pull(x: R3, *, z: R3):
    return x - z
"""
X = "R3(0, 0, 0)"
#: What a sampler does, and what the message says.
GIVES = {
    "another name": ("return {'p': 1}", ["gave a value for 'p'", "it has x, z"]),
    "a name too many": (f"return {{'x': {X}, 'z': {X}, 'w': 1}}", ["gave a value for 'w'", "it has x, z"]),
    "numbers as names": (f"return {{1: {X}, 2: {X}}}", ["gave a value for 1"]),
    "one argument": (f"return {{'x': {X}}}", ["gave nothing for 'z'", "return a R3 for it"]),
    "None": ("return None", ["gave None", "{argument: value} for x, z"]),
    "a list": (f"return [{X}, {X}]", ["gave a list"]),
    "text": ("return 'xz'", ["gave text"]),
    "a generator": ("yield 1", ["gave a generator"]),
    "None for an argument": (f"return {{'x': None, 'z': {X}}}", ["for 'x'", "got None"]),
    "text for an argument": (f"return {{'x': 'abc', 'z': {X}}}", ["for 'x'", "got text"]),
    "complex numbers": (f"return {{'x': [1j, 0, 0], 'z': {X}}}", ["for 'x'", "complex numbers"]),
    "ragged": (f"return {{'x': [[1], [1, 2]], 'z': {X}}}", ["for 'x'", "differ in length"]),
    "a wrong shape": (f"return {{'x': np.zeros(4), 'z': {X}}}", ["for 'x'", "(..., 3)", "(4,)"]),
    "a number": (f"return {{'x': 1.0, 'z': {X}}}", ["for 'x'", "(..., 3)", "shape ()"]),
    "a batch": (f"return {{'x': np.zeros((5, 3)), 'z': {X}}}", ["for 'x'", "a batch of shape (5,)"]),
    "another manifold": (f"return {{'x': SE3.identity(), 'z': {X}}}", ["for 'x'", "must be R3, got SE3"]),
    "NaN": (f"return {{'x': R3(np.nan, 0, 0), 'z': {X}}}", ["for 'x'", "not finite"]),
    "NaN in an array": (f"return {{'x': [np.nan, 0, 0], 'z': {X}}}", ["for 'x'", "not finite"]),
    "infinite": (f"return {{'x': R3(np.inf, 0, 0), 'z': {X}}}", ["for 'x'", "not finite"]),
    "raises": ("raise ValueError('why')", ["raised ValueError: why at factors.py:7", "'random'"]),
    "raises BaseException": ("raise BaseException('why')", ["raised BaseException: why at factors.py:7"]),
    "exits": ("import sys; sys.exit(0)", ["raised SystemExit: 0 at factors.py:7"]),
    "exits at once": ("import os; os._exit(0)", ["raised SystemExit at factors.py:7"]),
    "aborts": ("import os; os.abort()", ["raised SystemExit at factors.py:7"]),
    "no such method": (f"return {{'x': draw.nosuch(), 'z': {X}}}", ["AttributeError", "factors.py:7"]),
    "a mapping that fails": (
        "import collections; return type('M', (collections.UserDict,), {'__iter__': lambda self: 1 / 0})()",
        ["raised ZeroDivisionError", "factors.py:7"],
    ),
}
#: What stands for a sampler.
IS = {
    "a number": ("3", ["factors.py:10: pull: sample= is a function (draw, case)", "got 3"]),
    "text": ("'abc'", ["sample= is a function", "got 'abc'"]),
    "True": ("True", ["sample= is a function", "got True"]),
    "without arguments": (
        "lambda: {}",
        ["its sampler <lambda> raised TypeError", "called with (draw, case)"],
    ),
    "with one argument": ("lambda a: {}", ["raised TypeError", "called with (draw, case)"]),
    "print": ("lambda *a: None", ["gave None"]),
    "a class": ("dict", ["its sampler dict raised TypeError", "called with (draw, case)"]),
}


def run(folder, text):
    (folder / "factors.py").write_text(text)
    done = CliRunner().invoke(app, ["verify", str(folder / "factors.py")])
    assert done.exit_code == 2, done.output
    assert done.stderr.startswith("Error: factors.py:10: pull: ")
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    return done.stderr


@pytest.mark.parametrize("name", GIVES)
def test_what_a_sampler_does_wrong_is_told(name, tmp_path):
    body, says = GIVES[name]
    message = run(tmp_path, HEAD.format(body=body, sampler="sample"))
    for words in says:
        assert words in message


@pytest.mark.parametrize(
    "command", [["generate", "-o", "out"], ["verify", "--accuracy"], ["verify", "--gauss-newton"], ["bench"]]
)
@pytest.mark.parametrize("name", ["None", "exits at once"])
def test_every_command_tells_it(name, command, tmp_path, monkeypatch):
    body, says = GIVES[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "factors.py").write_text(HEAD.format(body=body, sampler="sample"))
    done = CliRunner().invoke(app, [command[0], "factors.py", *command[1:]])
    assert done.exit_code == 2, done.output
    assert done.stderr.startswith("Error: factors.py:10: pull: ")
    assert done.stderr.count("\n") == 1
    assert says[0] in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", IS)
def test_what_is_no_sampler_is_told(name, tmp_path):
    sampler, says = IS[name]
    message = run(tmp_path, HEAD.format(body="return {}", sampler=sampler))
    for words in says:
        assert words in message


def test_a_sampler_may_give_arrays_and_numbers():
    pose = np.array([0, 0, np.sin(0.5), np.cos(0.5), 1, 2, 3])

    @factor(sample=lambda draw, case: {"x": pose, "p": [1, 2, 3], "k": 0.5}, layout={"x": "wxyz"})
    def seen(x: SE3, p: R3, *, k: R1):
        return x.transform_to(p) * k[0]

    drawn = sampler_of(seen)(Draw(np.random.default_rng(0)), CASES[0])
    np.testing.assert_array_equal(np.asarray(drawn["k"]), [0.5])
    np.testing.assert_array_equal(np.asarray(drawn["p"]), [1, 2, 3])
    # as in a call: in the layout of the argument
    np.testing.assert_array_equal(np.asarray(drawn["x"]), [0, np.sin(0.5), np.cos(0.5), 0, 1, 2, 3])


def test_a_sampler_serves_the_formula_with_bound_arguments():
    def sample(draw, case):
        return {"x": R3(1, 2, 3), "z": R3(0, 0, 0), "k": 2.0}

    @factor(sample=sample)
    def pull(x: R3, *, z: R3, k: R1):
        return k[0] * (x - z)

    for changed in (pull.bind(k=1.0), pull.vary("z"), pull.whitened("diagonal")):
        assert set(sampler_of(changed)(Draw(np.random.default_rng(0)), CASES[0])) >= {"x", "z"}


@pytest.mark.parametrize(
    "end", ["raise SystemExit(0)", "import os; os._exit(0)", "raise BaseException('no')"]
)
def test_a_formula_that_ends_the_program_when_it_is_traced_again(end, tmp_path, monkeypatch):
    """A chart traces the formula once more, long after the file was imported."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "factors.py").write_text(
        "from liegen import SO3, factor\n\ncalls = []\n\n\n@factor\ndef pull(x: SO3, *, z: SO3):\n"
        f"    calls.append(1)\n    if len(calls) > 1:\n        {end}\n    return z.local(x)\n"
    )
    done = CliRunner().invoke(app, ["generate", "factors.py", "-o", "out", "--chart", "sophus"])
    assert done.exit_code == 2
    assert done.stderr.startswith("Error: factors.py:10: pull: ")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_an_error_whose_text_fails_in_a_formula():
    class SlyError(Exception):
        def __str__(self):
            raise ValueError

    with pytest.raises(DefinitionError, match=r"SlyError: .*cannot be shown"):

        @liegen.factor
        def pull(x: R3):
            raise SlyError
