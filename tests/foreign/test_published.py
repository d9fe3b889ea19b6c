"""Jacobians that were published with a mistake: the verdict names the mistake."""

import pytest
from published import PUBLISHED

from liegen.foreign import compare
from liegen.foreign.calls import of_callable


@pytest.mark.parametrize("published", PUBLISHED, ids=lambda p: p.function.__name__)
def test_the_mistake_is_named(published):
    formula = published.formula
    found = compare(formula, of_callable(published.function, formula.kernel, "here"))
    assert not found.passed
    for finding in found.findings:
        words = published.words.get(finding.name.rpartition("_D_")[2], ())
        told = " | ".join((finding.verdict, *finding.same))
        assert finding.correct == (not words), told
        assert all(word in told for word in words), told


def test_all_that_a_report_names_is_there():
    """At least these kinds of mistakes are among those that are checked above."""
    words = " ".join(w for p in PUBLISHED for texts in p.words.values() for w in texts)
    kinds = ("left out", "opposite", "in the world", "derivative of", "stands where", "divided by", "Jr^-1",
             "Jl^-1", "from the left", "Ad(", "degrees", "transposed", "inverse of", "wxyz",
             "only entry")  # fmt: skip
    assert [kind for kind in kinds if kind not in words] == []
