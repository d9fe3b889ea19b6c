"""The checks of ``liegen verify`` on every factor of the library."""

from __future__ import annotations

import pytest
from verify_tools import failures

from liegen.verify.factor import check_factor
from liegen.verify.run import library

FACTORS = list(library().values())


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_every_check_passes(function, library_place):
    report = check_factor(function, library_place, 45, 0, conditioned=False)
    assert not failures(report)
    assert {c.name for c in report.checks} >= {
        "value",
        "Jacobian",
        "agreement",
        "domain",
        "differences",
        "Taylor",
    }


@pytest.mark.slow
@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_every_check_passes_on_many_samples(function, library_place):
    report = check_factor(function, library_place, 400, 2024, conditioned=False)
    assert not failures(report)


def test_there_are_31_factors():
    assert len(FACTORS) == 31
