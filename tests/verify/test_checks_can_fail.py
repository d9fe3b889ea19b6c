"""Each check sees the mistake that it is there for."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from liegen import R1, SE3, abs, factor, library, log, maximum, native, require, sqrt
from liegen.errors import DomainError, ToolError
from liegen.program import Program
from liegen.program.rewrite import Builder
from liegen.verify import backends as module
from liegen.verify import check_finite, verify
from liegen.verify.backends import program_evaluator
from liegen.verify.differences import differences
from liegen.verify.draws import batch, draw_samples, schedule
from liegen.verify.taylor import remainder_slopes, taylor
from liegen.verify.unit_length import off_unit

FACTORS = [library.between_se3, library.between_se2, library.prior_s2, library.sfm_cal3_bundler]


def evaluated(function, count=6):
    samples = draw_samples(function, count, 1).inside
    return samples, program_evaluator(function.kernel.jacobians)(batch(samples))


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_remainder_of_an_entry_one_per_cent_off_has_slope_1(function):
    sample = draw_samples(function, 1, 1).inside[0]
    right = {name: a[0] for name, a in program_evaluator(function.kernel.jacobians)(batch((sample,))).items()}
    for slope in remainder_slopes(function.graph, sample, right, {}).values():
        assert slope == pytest.approx(2.0, abs=0.05) or slope == np.inf
    for name in [n for n in right if n != "res"]:
        row, column = np.unravel_index(np.argmax(np.abs(right[name])), right[name].shape)
        off = right[name].copy()
        off[row, column] *= 1.01
        slopes = remainder_slopes(function.graph, sample, {**right, name: off}, {})
        assert slopes[name] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_differences_and_remainders_fail_on_a_wrong_entry(function):
    samples, results = evaluated(function)
    graph = function.graph
    value = program_evaluator(function.kernel.value)
    zeros = [0] * len(samples)
    assert differences(graph, samples, value, results).passed
    assert taylor(graph, samples, results, zeros, {}).passed
    wrong = {name: a.copy() for name, a in results.items()}
    name = f"res_D_{graph.parameters[0].name}"
    wrong[name][..., 0, 0] += 1e-5 * np.abs(wrong[name]).max(axis=(1, 2))
    assert not differences(graph, samples, value, wrong).passed
    assert not taylor(graph, samples, wrong, zeros, {}).passed


def with_wrong_entry(program: Program, k: int) -> Program:
    """The last output's entry k, one part in 1e10 too large."""
    builder = Builder()
    builder.code.extend(program.code)
    last = list(program.results[-1])
    last[k] = builder.emit("mul", (last[k], builder.const(1 + 1e-10)))
    return replace(program, code=tuple(builder.code), results=(*program.results[:-1], tuple(last)))


def test_verify_fails_for_a_program_that_is_one_part_in_1e10_off(monkeypatch):
    function = library.prior_so3
    wrong = replace(function.kernel, jacobians=with_wrong_entry(function.kernel.jacobians, 4))
    monkeypatch.setattr(module, "programs", lambda _: (
        module.Backend("program", True, program_evaluator(wrong.jacobians)),
        module.Backend("program, value", False, program_evaluator(wrong.value)),
    ))  # fmt: skip
    report = verify([function], samples=20)
    failed = {c.name for f in report.factors for c in f.checks if not c.passed}
    assert failed == {"Jacobian", "agreement", "singular points"}
    assert not report.passed


def test_without_a_compiler_c_is_reported_as_not_checked(monkeypatch):
    monkeypatch.setattr(native, "COMPILERS", ("no-such-compiler",))
    monkeypatch.delenv("CC", raising=False)
    report = verify([library.prior_so2], samples=10)
    (check,) = [c for c in report.factors[0].checks if c.name == "C"]
    assert report.passed
    assert report.compiler == ""
    assert not check.checked
    assert "no C compiler" in check.note


def test_a_compiler_that_fails_is_an_error(monkeypatch):
    monkeypatch.setenv("CC", "false")
    with pytest.raises(ToolError, match="does not compile"):
        verify([library.prior_so2], samples=10)


def test_a_residual_that_is_nan_everywhere_names_the_operation_and_the_line():
    @factor
    def hopeless(x: SE3, *, z: R1):
        return log(-x.range([0.0, 0.0, 0.0])) - z

    with pytest.raises(DomainError, match=r"hopeless.*'res'.*'log' at test_checks_can_fail.py:\d+"):
        check_finite(hopeless)


def test_a_jacobian_that_is_nan_everywhere_names_the_derivative():
    @factor
    def flat(x: R1):
        return sqrt(abs(x) - sqrt(x * x))

    with pytest.raises(DomainError, match=r"flat.*'res_D_x'.*derivative of 'sqrt'"):
        check_finite(flat)


def test_a_domain_that_no_sample_meets_is_named():
    @factor
    def nowhere(x: R1):
        require(x > 1e9, "x is huge")
        return x * 2.0

    with pytest.raises(DomainError, match=r"nowhere.*x is huge"):
        check_finite(nowhere)
    report = verify([nowhere], samples=4)
    assert not report.passed
    assert "x is huge" in report.factors[0].checks[0].note


def test_fewer_than_half_of_the_samples_is_a_failure():
    @factor
    def rarely(x: R1):
        return x / maximum(x - 1.0, 0.0)

    report = verify([rarely], samples=30)
    checks = {c.name: c for c in report.factors[0].checks}
    assert not checks["value"].passed
    assert "could be compared" in checks["value"].note
    assert 0 < checks["value"].kept < 15


def test_samples_are_drawn_where_roots_and_logarithms_have_values():
    """Half of all numbers have no logarithm: they are drawn again, and no sample is left out for it."""

    @factor
    def of_a_logarithm(x: R1, *, z: R1):
        return x - log(z) - sqrt(z)

    drawn = draw_samples(of_a_logarithm, 60, 0)
    assert len(drawn.inside) == 60
    assert all(s.values["z"][0] >= 0 for s in drawn.inside)
    assert drawn.outside == drawn.refused == ()


def test_a_factor_that_is_finite_nowhere_is_told_with_line_and_cure_and_without_warnings(recwarn):
    @factor
    def no_logarithm(x: SE3, *, z: R1):
        return log(-x.range([0.0, 0.0, 0.0]) - 1.0) - z

    @factor
    def no_quotient(x: R1, *, z: R1):
        return x / (z - z)

    report = verify([no_logarithm, no_quotient], samples=5, workers=1)
    notes = [f.checks[0].note for f in report.factors]
    assert not any(f.passed for f in report.factors)
    assert re.search(r"log at test_checks_can_fail.py:\d+ needs -norm\(.*> 0.*draw inside with", notes[0])
    assert re.search(r"'div' at test_checks_can_fail.py:\d+ .*require\(", notes[1])
    assert not [w for w in recwarn if issubclass(w.category, RuntimeWarning)]


def test_figures_off_unit_length_are_of_samples_that_have_numbers():
    """Half of all numbers have no logarithm; that says nothing of quaternions."""

    @factor
    def of_a_logarithm(x: SE3, *, z: R1):
        return x.range([0.0, 0.0, 0.0]) - log(z)

    figures = off_unit(of_a_logarithm, 0)
    assert len(figures) == 2
    assert all(o.as_is < 1e-2 and o.normalised < 1e-12 for o in figures)


def test_a_constant_that_is_not_finite_is_told_with_its_line():
    @factor
    def beyond(x: SE3):
        return x.log() * float("inf")

    report = verify([beyond], samples=5, workers=1)
    assert re.search(
        r"'mul' at test_checks_can_fail.py:\d+ is the first that is not finite, of a constant",
        report.factors[0].checks[0].note,
    )
    assert report.factors[0].off_unit == ()


def test_cases_without_a_sample_inside_say_which_requirement_refuses_them():
    def far(draw, case):
        return {"x": R1(2.0 if case.spread > 1 else 0.5), "z": R1(0.0)}

    @factor(sample=far)
    def near_only(x: R1, *, z: R1):
        require(x < 1.0, "x is far")
        return x - z

    refused = draw_samples(near_only, 60, 0).refused
    assert "kilometres: no sample inside the domain, outside `x is far`" in refused


def test_samples_are_the_same_in_every_run_and_cover_every_case():
    first, second = (draw_samples(library.between_se3, 30, 5) for _ in range(2))
    assert first == second
    assert first != draw_samples(library.between_se3, 30, 6)
    names = [case.name for case, _ in schedule("between_se3", 60, 5)]
    assert len(set(names[:30])) == min(30, len(set(names)))
    assert "identity" in names
    assert "negated quaternions" in names
