"""Every pass keeps the values of random programs, and does not add operations."""

import pytest
from hypothesis import assume, given, settings
from pass_tools import optimised
from strategies import GENERIC, VALUES, on_an_edge, programs, run, well_conditioned

from liegen.program.passes import (
    FINAL,
    PASSES,
    cse,
    dead,
    factor,
    fold,
    reciprocals,
    schedule,
    signs,
    terms,
)
from liegen.program.passes.divisions import cost
from liegen.program.passes.scheduling import live_values

EVERY = (*PASSES, *FINAL, optimised)
each_pass = pytest.mark.parametrize("step", EVERY, ids=lambda step: step.__name__)
fast = settings(max_examples=200, deadline=None)


def results(program, slots):
    return [slots[i] for i in program.results[0]], [slots[r.condition] for r in program.requirements]


@each_pass
@settings(max_examples=250, deadline=None)
@given(program=programs(), special=VALUES, generic=GENERIC)
def test_values_stay_the_same(step, program, special, generic):
    rounds = step in (factor, reciprocals, terms, optimised)  # differently, at the 50th digit
    values = generic if rounds else special
    slots = run(program, values)
    assume(well_conditioned(slots) and not (rounds and on_an_edge(program, slots)))
    after = step(program).validate()
    before_values, before_conditions = results(program, slots)
    after_values, after_conditions = results(after, run(after, values))
    assert after_conditions == before_conditions
    # a function of a constant (that x * 0 has made) is folded in doubles: rounding, not tested here
    assume(all((ins.value * 2**40).is_integer() for ins in after.code if ins.op == "const"))
    scale = max([1, *(abs(s) for s in slots if not isinstance(s, bool))])
    for a, b in zip(before_values, after_values, strict=True):
        assert abs(a - b) <= 1e-38 * scale


@each_pass
@fast
@given(program=programs())
def test_the_count_does_not_grow(step, program):
    after = step(program)
    assert cost(after) <= cost(program)
    if step not in (reciprocals, optimised):
        assert after.operations <= program.operations


@pytest.mark.parametrize("step", [cse, dead, schedule, reciprocals], ids=lambda step: step.__name__)
@fast
@given(program=programs())
def test_idempotent(step, program):
    once = step(program)
    assert step(once) == once


@pytest.mark.parametrize("step", [fold, signs, terms, factor, optimised], ids=lambda step: step.__name__)
@fast
@given(program=programs())
def test_a_second_run_adds_nothing(step, program):
    once = step(program)
    assert cost(step(once)) <= cost(once)


@each_pass
@fast
@given(program=programs())
def test_interface_and_conditions_are_kept(step, program):
    after = step(program)
    assert (after.name, after.inputs, after.outputs) == (program.name, program.inputs, program.outputs)
    assert [r.message for r in after.requirements] == [r.message for r in program.requirements]
    is_condition = [ins.op in ("lt", "le", "and", "or", "not") for ins in after.code]
    assert all(is_condition[r.condition] for r in after.requirements)
    for ins in after.code:
        wanted = {"and": [1, 1], "or": [1, 1], "not": [1], "select": [1, 0, 0]}.get(
            ins.op, [0] * len(ins.args)
        )
        assert [is_condition[a] for a in ins.args] == wanted


@fast
@given(program=programs())
def test_optimised_programs_have_nothing_left_over(program):
    after = optimised(program)
    assert dead(after) == after
    keys = [(i.op, tuple(sorted(i.args)) if i.op in ("add", "mul") else i.args, i.value) for i in after.code]
    assert len(set(keys)) == len(keys)
    for ins in after.code:  # a difference used once, a constant and a negation are never negated
        if ins.op == "neg":
            (operand,) = ins.args
            assert after.code[operand].op not in ("neg", "const")
            assert after.code[operand].op != "sub" or not _single_use(after, operand)


def _single_use(program, i):
    uses = [a for ins in program.code for a in ins.args] + [a for r in program.results for a in r]
    return uses.count(i) == 1


@fast
@given(program=programs())
def test_scheduling_never_lengthens(program):
    after = schedule(program)
    assert live_values(after) <= live_values(dead(program))
    assert after.op_counts() == dead(program).op_counts()
