"""Sums and products take first what is ready first."""

import casadi as ca
import numpy as np
from pass_tools import X, lowered

from liegen.program.passes import contract, cse
from liegen.program.passes.arrival import critical_path
from liegen.verify.backends import program_evaluator

a, b, c, d, e, f, g, h = X


def values(program, inputs):
    return program_evaluator(program)({"p": inputs})["r"]


def test_what_comes_late_is_added_last():
    late = ca.sqrt(a)
    program = lowered(((late + b) * 1 + c) + d)
    found = contract(program)
    assert critical_path(program) == 18 + 3 * 3
    assert critical_path(found) == 18 + 3
    assert found.operations == program.operations


def test_what_comes_late_is_multiplied_last():
    program = lowered(((a / b) * c) * d * e)
    assert critical_path(program) == 13 + 3 * 3
    assert critical_path(contract(program)) == 13 + 3


def test_values_change_by_rounding_only():
    late = ca.sqrt(a * a + b * b)
    program = cse(lowered(f + e * late + c * d + g * h, late * c * d * e))
    inputs = np.random.default_rng(3).normal(size=(50, 8))
    np.testing.assert_allclose(
        values(contract(program), inputs), values(program, inputs), rtol=1e-14, atol=1e-14
    )
    assert critical_path(contract(program)) < critical_path(program)


def test_a_program_in_order_stays_as_it_is():
    program = lowered(a * b + c, ca.sqrt(a + b))
    assert contract(program) is program
