"""The accuracy check catches every mutant of a program that changes a value beyond rounding."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from liegen import library
from liegen.verify.backends import Array, program_evaluator
from liegen.verify.draws import batch, draw_samples
from liegen.verify.expected import Expected, compare, expect
from liegen.verify.mutate import mutants

SAMPLES, SEED = 96, 11
#: A change above this, relative to the largest entry of the block or 1, is more than rounding.
CHANGED = 1e-10

FACTORS = [
    library.between_se3,
    library.between_se2,
    library.prior_so3,
    library.prior_s2,
    library.bearing_se2_r2,
    library.range_se3_r3,
    library.projection_cal3_ds2,
    library.sfm_cal3_bundler,
]


def changes(expected: Expected, before: Mapping[str, Array], after: Mapping[str, Array]) -> bool:
    """Whether any entry changed beyond rounding at a sample that the reference covers."""
    for block in expected.blocks:
        a, b = (r[block.name].reshape(len(expected.samples), -1) for r in (before, after))
        with np.errstate(all="ignore"):
            apart = np.abs(a - b).max(axis=1) / np.maximum(1.0, np.abs(a).max(axis=1))
        if (block.kept & ~(apart <= CHANGED)).any():
            return True
    return False


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_every_mutant_that_changes_a_value_is_caught(function, record_property, capsys):
    samples = draw_samples(function, SAMPLES, SEED).inside
    expected, arguments = expect(function, samples, conditioned=False), batch(samples)
    program = function.kernel.jacobians
    before = program_evaluator(program)(arguments)
    assert all(c.ratio.max() <= 1 for c in compare(expected, before))
    changed = caught = total = 0
    escaped = []
    for description, mutant in mutants(program, SEED):
        after = program_evaluator(mutant)(arguments)
        found = any(c.ratio.max() > 1 for c in compare(expected, after))
        different = changes(expected, before, after)
        total, changed, caught = total + 1, changed + different, caught + (different and found)
        if different and not found:
            escaped.append(description)
    with capsys.disabled():
        print(f"\n{function.name}: {total} mutants, {changed} change a value, {caught} caught", end=" ")
    record_property("mutants", {"all": total, "changed": changed, "caught": caught})
    assert changed > total / 2
    assert not escaped
