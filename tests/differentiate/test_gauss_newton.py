"""Gauss-Newton terms: cost, J^T r and J^T J, without J."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from liegen import SE3, DefinitionError, factor, function, library
from liegen.cli import app
from liegen.gauss_newton import gauss_newton_kernel
from liegen.program.rewrite import Builder
from liegen.verify import verify
from liegen.verify.backends import program_evaluator
from liegen.verify.draws import batch, draw_samples
from liegen.verify.run import library as every_factor
from liegen.verify.sphere_slack import slack_of

WEIGHTED = [
    library.between_se3.whitened("full"),
    library.between_se3.whitened("full", "huber"),
    library.between_se3.whitened("diagonal", "cauchy", "triggs"),
    library.between_se2.whitened(None, "barron"),
    library.between_se3.in_chart("ceres"),
    library.sfm_cal3_bundler.whitened("isotropic"),
]


@factor
def twice(x: SE3, y: SE3, *, z: SE3):
    """x is there twice: on its own, and beside y."""
    return z.local(x.between(y)) + x.log()


@pytest.mark.parametrize(
    "f", [*every_factor().values(), *WEIGHTED, twice], ids=lambda f: f"{f.name}-{f.weighting is not None}"
)
def test_terms_are_products_of_the_factors_own_jacobians(f):
    samples = draw_samples(f, 12, 3).inside
    arguments = batch(samples)
    slack = np.array([slack_of(f.plain, s.values) for s in samples])  # of directions near the antipode
    J = program_evaluator(f.kernel.jacobians)(arguments)
    found = program_evaluator(f.gauss_newton_kernel.value)(arguments)
    names = [v.name for v in f.kernel.variables]
    exact = {f"g_{x}": (J[f"res_D_{x}"], J["res"][..., None]) for x in names}
    exact |= {
        f"H_{x}_{y}": (J[f"res_D_{x}"], J[f"res_D_{y}"]) for x, y in combinations_with_replacement(names, 2)
    }
    assert list(found) == ["cost", *exact]
    inputs = np.max([np.abs(x).max(axis=1) for x in arguments.values()], axis=0)
    for name, (a, b) in exact.items():
        # both programs round: J to its largest entry, r to the inputs
        sizes = [np.maximum(np.abs(x).max(axis=(1, 2)), inputs if x.shape[2] == 1 else 1.0) for x in (a, b)]
        error = np.einsum("nij,nik->njk", a, b) - found[name].reshape(len(a), a.shape[2], b.shape[2])
        assert np.nanmax(np.abs(error).max(axis=(1, 2)) / (sizes[0] * sizes[1] * slack)) < 4e-14
    for x in names:
        H = found[f"H_{x}_{x}"]
        np.testing.assert_array_equal(H, np.swapaxes(H, 1, 2))
    if f.weighting is None or f.weighting.loss is None:
        error = np.abs(found["cost"][:, 0] - 0.5 * (J["res"] ** 2).sum(axis=1))
        assert (error / np.maximum(np.abs(J["res"]).max(axis=1), inputs) ** 2).max() < 4e-14


def test_congruence_costs_less_than_products_of_jacobians():
    """H_xx comes from H_yy; products of the Jacobians have 21 + 36 + 21 + 12 entries of six terms."""
    f = library.between_se3.whitened("full")
    products = f.kernel.jacobians.operations + (21 + 36 + 21 + 12) * 11
    assert f.gauss_newton_kernel.value.operations < 0.8 * products


def test_verify_sees_a_wrong_entry(monkeypatch):
    f = library.between_se2.whitened("diagonal")
    assert verify([f], samples=8, gauss_newton=True).passed
    kernel = f.gauss_newton_kernel
    builder = Builder()
    program = kernel.value
    place = [builder.emit(i.op, i.args, i.value) for i in program.code]
    entry = program.results[-1][1]
    place.append(builder.emit("mul", (entry, builder.const(1 + 1e-10))))
    results = (
        *program.results[:-1],
        tuple(place[-1] if i == 1 else k for i, k in enumerate(program.results[-1])),
    )
    wrong = replace(program, code=tuple(builder.code), results=results).validate()
    broken = replace(f)
    broken.__dict__["gauss_newton_kernel"] = replace(kernel, value=wrong, jacobians=wrong)
    (report,) = verify([broken], samples=8, gauss_newton=True).factors
    assert [c.name for c in report.checks if not c.passed] == ["Gauss-Newton"]


def test_a_function_has_no_terms():
    @function
    def middle(x: SE3, y: SE3):
        return x.compose(y)

    with pytest.raises(DefinitionError, match="middle is a @function, without a residual"):
        _ = middle.gauss_newton_kernel


def test_evaluated_by_the_factor():
    x = np.array([0.0, 0, 0, 1, 1, 2, 3])
    terms = library.prior_se3.gauss_newton(x, z=np.array([0.0, 0, 0, 1, 1, 2, 2]))
    np.testing.assert_allclose(terms["cost"], [0.5])
    np.testing.assert_allclose(terms["g_x"], [0, 0, 0, 0, 0, 1], atol=1e-15)
    assert terms["H_x_x"].shape == (6, 6)


DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "gauss_newton.md"
ROWS = re.findall(
    r"^\| `(\w+)`(, full noise)? \| (\d+) \| (\d+) \| \d+ \|$", DOCUMENT.read_text(), re.MULTILINE
)


def test_the_document_has_the_counts():
    assert len(ROWS) == 6
    for name, noise, jacobians, terms in ROWS:
        plain = getattr(library, name)
        f = plain.whitened("full") if noise else plain
        counts = f.kernel.jacobians.operations, f.gauss_newton_kernel.value.operations
        assert counts == (int(jacobians), int(terms)), name


def test_generate_and_check(tmp_path):
    runner = CliRunner()
    out = str(tmp_path / "out")
    arguments = ["generate", "-f", "prior_r3", "--noise", "full", "--gauss-newton", "-o", out]
    done = runner.invoke(app, arguments)
    assert done.exit_code == 0, done.output
    manifest = json.loads((tmp_path / "out" / "liegen_factors.json").read_text())
    assert list(manifest["factors"]) == ["prior_r3", "prior_r3_gauss_newton"]
    assert runner.invoke(app, ["check", out]).exit_code == 0
    assert (
        gauss_newton_kernel(library.prior_r3.kernel, library.prior_r3.plain, None).name
        == "prior_r3_gauss_newton"
    )
