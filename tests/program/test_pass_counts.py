"""Passes on small programs with known counts."""

import casadi as ca
import numpy as np
import pytest
from pass_tools import X, counts, lowered, optimised, rotation_times

from liegen.program import Instruction, Port, Program, Requirement
from liegen.program.passes import (
    cse,
    factor,
    fold,
    signs,
)

a, b, c, d, e, f, g, h = X


@pytest.mark.parametrize(
    ("expressions", "expected"),
    [
        # sharing
        ([a * b + c, b * a + d], {"add": 2, "mul": 1}),
        ([ca.sin(a * b), ca.cos(b * a) + ca.sin(b * a)], {"add": 1, "cos": 1, "mul": 1, "sin": 1}),
        ([(a - b) * c + (b - a) * d + ca.sin(b - a)], {"mul": 1, "sin": 1, "sub": 3}),
        ([(a - b) * c + e, (b - a) * d + f], {"add": 1, "mul": 2, "sub": 2}),
        ([-(a * b), (-a) * b, a * (-b)], {"mul": 1, "neg": 1}),
        ([ca.sin(a - b) * c, ca.sin(b - a) * d], {"mul": 2, "neg": 1, "sin": 1, "sub": 1}),
        ([ca.cos(a - b) * c, ca.cos(b - a) * d], {"cos": 1, "mul": 2, "sub": 1}),
        ([ca.fabs(a - b) * c, ca.fabs(b - a)], {"abs": 1, "mul": 1, "sub": 1}),
        ([ca.if_else(-a < -b, c, d), ca.if_else(b < a, d, c)], {"lt": 1, "select": 2}),
        # signs
        ([-(a * b) + c], {"mul": 1, "sub": 1}),
        ([c - (-a) * b], {"add": 1, "mul": 1}),
        ([-(a - b)], {"sub": 1}),
        ([(-a - b) + c], {"add": 1, "sub": 1}),
        ([-(2 * a * b)], {"mul": 2}),
        ([-(a * b + c * d)], {"add": 1, "mul": 2, "neg": 1}),
        ([-(a * (b - c))], {"mul": 1, "sub": 1}),
        ([-(a * (b - c) + d * (e - f))], {"add": 1, "mul": 2, "sub": 2}),
        ([-ca.if_else(a < b, c - d, 2.0)], {"lt": 1, "select": 1, "sub": 1}),
        ([-a * d, -a * e, -a * f, a * g], {"mul": 4, "neg": 1}),
        ([-(1 / a)], {"div": 1}),
        # constants
        ([a / 4], {"mul": 1}),
        ([a / 3], {"div": 1}),
        ([0.5 * (2 * a)], {}),
        ([a + a, 2 * a * b], {"mul": 2}),
        # reciprocals
        ([a / c, b / c, 1 / c], {"div": 1, "mul": 2}),
        ([a / c, 1 / c], {"div": 1, "mul": 1}),
        ([a / c, b / c], {"div": 2}),
        ([a / c, b / c, d / c], {"div": 1, "mul": 3}),
        ([a / c, -b / c, d / -c], {"div": 1, "mul": 3, "neg": 1}),
        # factors
        ([a * b + a * c], {"add": 1, "mul": 1}),
        ([a * b + d * a - a * c], {"add": 1, "mul": 1, "sub": 1}),
        ([2 * a * b - 2 * c * d], {"mul": 3, "sub": 1}),
        ([a / c - b / c], {"div": 1, "sub": 1}),
        ([a * b + a * c, a * b], {"add": 1, "mul": 2}),
        ([ca.if_else(a < b, c * d, c * e)], {"lt": 1, "mul": 1, "select": 1}),
    ],
    ids=str,
)
def test_known_counts(expressions, expected):
    assert counts(*expressions) == expected


def code(*instructions, results=None, requirements=()):
    """A program over the inputs t0 and t1."""
    body = [Instruction("input", (), 0.0), Instruction("input", (), 1.0)]
    body += [Instruction(op, args, value) for op, args, value in instructions]
    last = results or (len(body) - 1,)
    ports = (Port("a", (2,)),), (Port("r", (len(last),)),)
    return Program("p", *ports, tuple(body), (last,), requirements).validate()


def const(value):
    return "const", (), value


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        (code(const(0.0), ("add", (0, 2), 0)), {}),
        (code(const(0.0), ("sub", (2, 0), 0)), {"neg": 1}),
        (code(("sub", (0, 0), 0)), {}),
        (code(const(0.0), ("sqrt", (0,), 0), ("mul", (3, 2), 0)), {}),
        (code(const(1.0), ("mul", (2, 0), 0)), {}),
        (code(const(-1.0), ("mul", (0, 2), 0), ("neg", (3,), 0)), {}),
        (code(const(1.0), ("div", (0, 2), 0)), {}),
        (code(const(2.0), const(3.0), ("add", (2, 3), 0), ("mul", (4, 0), 0)), {"mul": 1}),
        (code(const(4.0), ("sqrt", (2,), 0), ("div", (0, 3), 0)), {"mul": 1}),
        (code(("lt", (0, 1), 0), ("select", (2, 0, 0), 0)), {}),
        (code(const(1.0), const(2.0), ("lt", (2, 3), 0), ("select", (4, 0, 1), 0)), {}),
        (code(("lt", (0, 0), 0), ("select", (2, 0, 1), 0)), {}),
        (
            code(("lt", (0, 1), 0), ("not", (2,), 0), ("not", (3,), 0), ("select", (4, 0, 1), 0)),
            {"lt": 1, "select": 1},
        ),
        (code(("lt", (0, 1), 0), ("not", (2,), 0), ("select", (3, 0, 1), 0)), {"lt": 1, "select": 1}),
        (code(("lt", (0, 1), 0), ("and", (2, 2), 0), ("select", (3, 0, 1), 0)), {"lt": 1, "select": 1}),
        (
            code(("lt", (0, 1), 0), ("select", (2, 0, 1), 0), ("select", (2, 3, 0), 0), results=(4,)),
            {},
        ),
    ],
)  # fmt: skip
def test_folding(program, expected):
    assert fold(program).op_counts() == expected


@pytest.mark.parametrize("op", ["and", "or"])
@pytest.mark.parametrize(("left", "right"), [(1.0, 2.0), (2.0, 1.0)], ids=["true", "false"])
@pytest.mark.parametrize("first", [True, False])
def test_decided_conditions_are_folded(op, left, right, first):
    """(left < right) and/or (a < b), either way round: decided, or what a < b says."""
    body = [const(left), const(right), ("lt", (2, 3), 0), ("lt", (0, 1), 0)]
    body += [(op, (4, 5) if first else (5, 4), 0), ("select", (6, 0, 1), 0)]
    program = code(*body)
    after = fold(program)
    decided = (left < right) == (op == "or")
    assert after.op_counts() == ({} if decided else {"lt": 1, "select": 1})
    for values in ([3.0, 4.0], [4.0, 3.0]):
        assert after.evaluate({"a": values}) == program.evaluate({"a": values})


def test_cse_shares_across_outputs():
    program = lowered(a * b + c, d - b * a, ca.sin(c + a * b))
    assert program.op_counts() == {"add": 2, "mul": 3, "sin": 1, "sub": 1}
    assert cse(program).op_counts() == {"add": 1, "mul": 1, "sin": 1, "sub": 1}


def test_opposite_constants_are_one_factor():
    program = code(const(2.0), const(-2.0), ("mul", (2, 0), 0), ("mul", (3, 1), 0), ("add", (4, 5), 0))
    after = factor(program)
    assert after.op_counts() == {"mul": 1, "sub": 1}
    assert after.evaluate({"a": [3.0, 5.0]})["r"] == [-4.0]


def test_a_division_by_a_number_that_is_no_power_of_two_stays():
    assert fold(code(const(3.0), ("div", (0, 2), 0))).op_counts() == {"div": 1}


@pytest.mark.parametrize(
    "op", ["sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "neg"]
)
def test_a_function_of_a_constant_is_folded(op):
    program = code(const(0.625), (op, (2,), 0))
    assert fold(program).op_counts() == {}
    expected = program.evaluate({"a": [0.0, 0.0]})["r"]
    assert fold(program).evaluate({"a": [0.0, 0.0]})["r"] == pytest.approx(expected, rel=3e-16)


def test_folding_leaves_what_is_not_finite():
    program = code(const(0.0), const(1.0), ("div", (3, 2), 0), ("sqrt", (0,), 0), ("mul", (4, 5), 0))
    assert fold(program).op_counts() == program.op_counts()


def test_a_requirement_that_is_decided_stays_a_condition():
    requirement = (Requirement(4, "always"),)
    program = code(const(1.0), const(2.0), ("lt", (2, 3), 0), results=(0,), requirements=requirement)
    after = optimised(program)
    assert after.code[after.requirements[0].condition].op == "lt"
    assert after.evaluate({"a": [5.0, 0.0]}) == {"r": [5.0], "status": [True]}


def test_a_select_still_guards():
    """The arm that is not taken is NaN, and does not reach the output."""
    program = optimised(lowered(ca.if_else(a < 0, -a, ca.sqrt(a) * b) * -c + ca.if_else(a < 0, b, ca.log(a))))
    out = program.evaluate({"p": [-4.0, 3.0, 2.0, 0, 0, 0, 0, 0]})
    assert out["r"] == [-5.0]


def test_signs_are_exact():
    """Rounding is symmetric: bit for bit the same floats."""
    rng = np.random.default_rng(3)
    program = lowered(*rotation_times(negated=True))
    values = {"p": list(rng.normal(size=(8, 100)))}
    before, after = program.evaluate(values)["r"], signs(program).evaluate(values)["r"]
    np.testing.assert_array_equal(before, after)
