"""Passes on products of rotations and matrices; schedules, and the table of counts."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

from pass_tools import X, conjugate, counts, lowered, product, rotation, rotation_times

from liegen.program import Instruction, Port, Program
from liegen.program.passes import (
    FINAL,
    PASSES,
    optimise,
    schedule,
)
from liegen.program.passes.scheduling import live_values


def test_a_negated_product_of_matrices_costs_no_negation():
    plain, negated = counts(*rotation_times(False)), counts(*rotation_times(True))
    assert "neg" not in negated
    assert sum(negated.values()) == sum(plain.values())


def test_both_signs_of_a_product_cost_one_negation_an_entry():
    both = counts(*rotation_times(False), *rotation_times(True))
    assert both["neg"] == 9


def test_a_conjugate_is_free():
    relative = product(conjugate(X[:4]), X[4:])
    assert counts(*relative) == {"add": 6, "mul": 16, "sub": 6}


def test_the_matrix_of_the_conjugate_shares_everything():
    straight = list(itertools.chain(*rotation(X[:4])))
    transposed = list(itertools.chain(*rotation(conjugate(X[:4]))))
    assert counts(*straight, *transposed) == counts(*straight)


def test_scheduling_shortens_live_ranges():
    """All products first, all sums later: 16 values wait. In a better order it is three."""
    body = [Instruction("input", (), float(k)) for k in range(8)]
    body += [Instruction("mul", (k, 4 + j)) for k in range(4) for j in range(4)]
    sums = []
    for k in range(4):
        row = 8 + 4 * k
        body += [Instruction("add", (row, row + 1)), Instruction("add", (row + 2, row + 3))]
        sums.append(len(body))
        body.append(Instruction("add", (len(body) - 2, len(body) - 1)))
    program = Program("p", (Port("p", (8,)),), (Port("r", (4,)),), tuple(body), (tuple(sums),)).validate()
    assert live_values(program) == 16
    assert live_values(schedule(program)) == 3


def test_the_table_has_a_row_a_pass():
    program = lowered(*rotation_times(True))
    after, rows = optimise(program)
    assert rows[0] == ("lower", program.operations)
    assert rows[-1] == ("schedule", after.operations)
    names = [name for name, _ in rows]
    assert {step.__name__ for step in (*PASSES, *FINAL)} <= set(names)


def test_the_same_bytes_whatever_the_hash_seed():
    script = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from pass_tools import *\n"
        "print(optimised(lowered(*rotation_times(True), *product(X[:4], X[4:]))).digest())"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", script, str(Path(__file__).parent)],
            env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("0", "1", "77")
    }  # fmt: skip
    assert len(found) == 1
    assert len(found.pop().strip()) == 64
