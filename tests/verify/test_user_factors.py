"""Factors as users write them: the same checks, in this process and in others."""

from __future__ import annotations

import json

import pytest
from verify_tools import failures, user_factors

from liegen.verify import verify

USER = user_factors()


@pytest.fixture(scope="module")
def report():
    return verify(list(USER.values()), samples=40, seed=3, workers=1)


@pytest.mark.parametrize("name", USER)
def test_every_check_passes(report, name):
    (mine,) = [f for f in report.factors if f.factor == name]
    assert not failures(mine)


def test_kinks_are_compared_and_listed(report):
    """Ties take part in the accuracy check; the remainder test lists them as not smooth."""
    (corners,) = [f for f in report.factors if f.factor == "corners"]
    checks = {c.name: c for c in corners.checks}
    assert checks["Jacobian"].kept == 40
    assert any("identity" in s for s in checks["Taylor"].skipped)


def test_outside_of_the_domain_is_nan_with_the_bit(report):
    (inverse_depth,) = [f for f in report.factors if f.factor == "inverse_depth"]
    (domain,) = [c for c in inverse_depth.checks if c.name == "domain"]
    assert domain.passed
    assert domain.kept == 8


def test_the_result_does_not_depend_on_the_workers(report):
    told = []
    parallel = verify(
        list(USER.values()), samples=40, seed=3, workers=2, reload=user_factors,
        progress=lambda f, done, total: told.append((f.factor, done, total)),
    )  # fmt: skip
    assert parallel == report
    assert [t[1:] for t in told] == [(k + 1, len(USER)) for k in range(len(USER))]
    assert json.loads(parallel.to_json())["passed"] is True
