"""Single rules of the passes, each on the smallest program that needs it."""

import math
from functools import partial
from itertools import product

import casadi as ca
import pytest
from pass_tools import X, lowered

from liegen.program import Instruction, Port, Program
from liegen.program.kinds import fused
from liegen.program.passes import contract, cse, factor, fold, signs
from liegen.program.passes.nary import Pairs
from liegen.program.rewrite import Builder


def program(build):
    """One output from three inputs; ``build`` gets the builder and their places."""
    b = Builder()
    result = build(b, *(b.emit("input", (), float(k)) for k in range(3)))
    return Program("p", (Port("a", (3,)),), (Port("r", (1,)),), tuple(b.code), ((result,),)).validate()


def value(made, x=(1.0, 2.0, 3.0)):
    (found,) = made.evaluate({"a": x})["r"]
    return float(found)


def nested(b, pair, arms):
    """A select within a select, both by the same comparison."""
    c = b.emit("lt", pair)
    return b.emit("select", arms(c, lambda one, two: b.emit("select", (c, one, two))))


#: By rule: the program, and its value at (x, y, z).
FOLDED = {
    "not exchanges the arms of a select": (
        lambda b, x, y, z: b.emit("select", (b.emit("not", (b.emit("lt", (x, y)),)), y, z)),
        lambda x, y, z: z if x < y else y,
    ),
    "x <= x holds": (
        lambda b, x, y, z: b.emit("select", (b.emit("le", (x, x)), y, z)),
        lambda x, y, z: y,
    ),
    "x < x does not hold": (
        lambda b, x, y, z: b.emit("select", (b.emit("lt", (x, x)), y, z)),
        lambda x, y, z: z,
    ),
    "the second arm asks the same again": (
        lambda b, x, y, z: nested(b, (x, y), lambda c, again: (c, x, again(y, z))),
        lambda x, y, z: x if x < y else z,
    ),
    "the first arm asks the same again": (
        lambda b, x, y, z: nested(b, (x, y), lambda c, again: (c, again(y, z), x)),
        lambda x, y, z: y if x < y else x,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FOLDED)
def test_folding_keeps_the_value(name):
    build, expected = FOLDED[name]
    before = program(build)
    after = fold(before)
    assert after.operations <= before.operations
    for x in product((1.0, 2.0), repeat=3):
        assert value(after, x) == expected(*x)


def test_zero_over_zero_is_not_folded():
    after = fold(program(lambda b, x, y, z: b.emit("div", (b.const(0.0), b.const(0.0)))))
    assert math.isnan(value(after))


def test_comparisons_that_say_the_same_are_one():
    a, b = X[:2]
    after = signs(lowered(*(-a < b, -b < a)))
    assert after.op_counts().get("lt") == 1
    assert len(set(after.results[0])) == 1


def test_factoring_leaves_terms_with_other_uses():
    a, b, c = X[:3]
    before = cse(lowered(a * b + a * c, a * b, a * c))
    assert factor(before).op_counts() == before.op_counts() == {"add": 1, "mul": 2}


def scaled(constant, b, x, y, z):
    """(c x) y"""
    return b.emit("mul", (b.emit("mul", (b.const(constant), x)), y))


def test_factoring_moves_no_constant_whose_product_is_rounded():
    for constant, moves in ((4.0, True), (0.5, True), (3.0, False)):
        made = factor(program(partial(scaled, constant)))
        outer = made.code[made.results[0][0]]
        assert ("const" in [made.code[k].op for k in outer.args]) is moves
        assert value(made) == 2 * constant


def test_a_pair_is_replaced_with_its_own_sign():
    """In a - b + b the pair a + b is a and the second b."""
    a, b, new = 1, 2, 9
    pairs = Pairs({0: [(a, 1), (b, -1), (b, 1)], 1: [(a, 1), (b, 1)]})
    pairs.replace((a, b, 1), [0, 1], new)
    assert pairs.groups == {0: [(new, 1), (b, -1)], 1: [(new, 1)]}


def test_constants_of_both_zeros_are_one():
    builder = Builder()
    index = builder.const(-0.0)
    assert index == builder.const(0.0)
    assert math.copysign(1.0, builder.code[index].value) == 1.0


@pytest.mark.parametrize("operand", [0, 1, -1])
def test_an_instruction_refers_to_earlier_ones(operand):
    made = Program("p", (), (Port("r", (1,)),), (Instruction("neg", (operand,)),), ((0,),))
    with pytest.raises(ValueError, match="refers to a later one"):
        made.validate()


def test_sums_begin_with_what_is_no_product():
    """e + a b + c d is two fused operations, a b + c d + e one and a product; also where e is late."""
    a, b, c, d, e = X[:5]
    before = lowered(a * b + c * d + ca.sin(e))
    assert fused(before) == 1
    assert fused(contract(before)) == 2
