"""Sums and products of many operands: what they share, and what must not be taken apart."""

import casadi as ca
import numpy as np
import pytest

from liegen.program import Instruction, Port, Program
from liegen.program.kinds import KINDS, kinds
from liegen.program.lower import lower
from liegen.program.passes import cse, terms
from liegen.program.passes.nary import Pairs

X = [ca.SX.sym(name) for name in "abcdefgh"]
a, b, c, d, e, f, g, h = X
PORT = Port("p", (8,))


def lowered(*expressions):
    return cse(lower("f", [(PORT, X)], [(Port("r", (len(expressions),)), expressions)]))


def test_products_share_a_pair_in_any_order():
    before = lowered(a * b * c, d * (c * a))
    assert before.op_counts() == {"mul": 4}
    assert terms(before).op_counts() == {"mul": 3}


def test_sums_share_a_pair_in_any_order():
    before = lowered(a * b + c * d + e * f, e * f + g * h + a * b)
    assert before.op_counts() == {"add": 4, "mul": 4}
    assert terms(before).op_counts() == {"add": 3, "mul": 4}


def test_pairs_are_shared_up_to_their_sign():
    before = lowered(a * b - c * d + e * f, g * h - a * b + c * d)
    after = terms(before)
    assert (before.operations, after.operations) == (8, 7)


def test_a_factor_is_taken_out_of_terms_that_are_no_neighbours():
    before = lowered(a * b + c * d + a * e + a * f)
    assert before.op_counts() == {"add": 3, "mul": 4}
    assert terms(before).op_counts() == {"add": 3, "mul": 2}


def test_a_factor_is_taken_out_of_what_is_left_in_brackets():
    """a (b c + b d) is a b (c + d)."""
    assert terms(lowered(a * b * c + a * b * d + e)).op_counts() == {"add": 2, "mul": 2}


@pytest.mark.parametrize("seed", range(3))
def test_values_stay(seed):
    rng = np.random.default_rng(seed)
    rows = [sum(X[i] * X[j] * X[k] for i, j, k in rng.integers(0, 8, (4, 3))) for _ in range(12)]
    before = lowered(*rows)
    after = terms(before)
    assert after.operations < before.operations
    values = {"p": list(rng.normal(size=(8, 50)))}
    np.testing.assert_allclose(after.evaluate(values)["r"], before.evaluate(values)["r"], rtol=0, atol=1e-13)


def test_a_difference_of_inputs_is_exact_and_stays():
    """(a - b) + c d and (e - b) + c d share c d; were -b + c d shared, a - b would lose its digits."""
    program = terms(lowered((a - b) + c * d + e * f, (g - b) + c * d))
    values = [1e16, 1e16 - 2, 3.0, 5.0, 0.0, 0.0, 1e16 + 2, 0.0]
    assert program.evaluate({"p": values})["r"] == [17.0, 19.0]


def test_what_a_select_scales_stays():
    """A power of two that keeps a square from overflow is not moved behind another factor."""
    scale = ca.if_else(a < b, 2.0**-600, 1.0)
    program = terms(lowered((c * scale) * d, c * d))
    scaled, plain = program.evaluate({"p": [0.0, 1.0, 1e200, 1e200, 0.0, 0.0, 0.0, 0.0]})["r"]
    assert np.isfinite(scaled)
    assert np.isinf(plain)


def test_what_gains_nothing_is_returned_as_it_is():
    before = lowered(a * b + c * d, ca.sin(a) - e)
    assert terms(before) == before


def test_the_best_pair_comes_first():
    groups = {0: [(1, 1), (2, 1), (3, 1)], 1: [(1, -1), (2, -1)], 2: [(2, 1), (1, 1), (3, -1)]}
    pairs = Pairs(groups)
    assert pairs.best() == ((1, 2, 1), [0, 1, 2])
    pairs.replace((1, 2, 1), [0, 1, 2], 9)
    assert groups == {0: [(9, 1), (3, 1)], 1: [(9, -1)], 2: [(9, 1), (3, -1)]}
    assert pairs.best() is None


def test_kinds():
    square = ca.sin(a) * b - ca.sqrt(c)
    program = lowered(ca.if_else(a < b, square, -d / e) + ca.fabs(f), a * b, a * b + g)
    counts = kinds(program)
    expected = {"add": 3, "mul": 2, "div": 1, "sqrt": 1, "call": 1, "select": 2, "sign": 2, "fused": 1}
    assert counts == expected
    assert sum(counts[kind] for kind in KINDS) == program.operations


def test_a_product_with_two_uses_is_not_fused():
    body = [Instruction("input", (), 0.0), Instruction("mul", (0, 0)), Instruction("add", (1, 0))]
    ports = (Port("p", (1,)),), (Port("r", (2,)),)
    assert kinds(Program("f", *ports, tuple(body), ((2, 2),)))["fused"] == 1
    assert kinds(Program("f", *ports, tuple(body), ((2, 1),)))["fused"] == 0
