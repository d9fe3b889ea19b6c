"""LaTeX of parts, of noise and losses, and what `explain` says of the noise in a chart."""

import pytest
from click.testing import CliRunner
from test_latex import typeset

from liegen import R3, SE3, Product, factor, library
from liegen.cli import app
from liegen.trace import latex_rows


def test_parts_of_products():
    class State(Product):
        T_WB: SE3
        bias: R3

    @factor
    def f(x_B1: State, y: State):
        return x_B1.T_WB.local(y.T_WB)[3:] + y.bias

    first = latex_rows(f.graph)[0]
    log = r"\mathrm{Log}\left(x_{B1}.T_{WB}^{-1} y.T_{WB}\right)"
    assert first == rf"r &= {{{log}}}_{{[3:6]}} + y.\mathrm{{bias}}"


@pytest.mark.parametrize(
    ("options", "rows"),
    [
        (
            {"noise": "full"},
            [r"\mathrm{res} &= S\, r", r"\mathrm{res}_{x} &= S\, \frac{\partial r}{\partial x}"],
        ),
        (
            {"noise": "diagonal", "loss": "huber"},
            [
                r"u &= S\, r,\; s = \left\lVert u \right\rVert^{2},\; w = \rho'(s)",
                r"\mathrm{res} &= \sqrt{w}\, u",
                r"\mathrm{res}_{x} &= \sqrt{w}\, S\, \frac{\partial r}{\partial x}",
            ],
        ),
        (
            {"loss": "cauchy", "mode": "triggs"},
            [
                r"u &= r,\; s = \left\lVert u \right\rVert^{2},\; w = \rho'(s),\; "
                r"\alpha_t = 1 - \sqrt{1 + 2 s \rho''(s) / w}",
                r"\mathrm{res} &= \frac{\sqrt{w}}{1 - \alpha_t}\, u",
                r"\mathrm{res}_{x} &= \sqrt{w} \left(I - \frac{\alpha_t}{s} u u^{\top}\right) "
                r"\frac{\partial r}{\partial x}",
            ],
        ),
    ],
)
def test_noise_and_loss_follow_the_residual(options, rows):
    plain = [f"  {row}" for row in latex_rows(library.prior_so3.graph)]
    shown = library.prior_so3.whitened(**options)._repr_latex_()
    lines = [line.removesuffix(r" \\") for line in shown.splitlines()[2:-2]]
    assert lines == [*plain, *(f"  {row}" for row in rows)]
    for row in rows:
        assert typeset(row).width > 10


def test_the_notes_know_the_chart():
    run = CliRunner().invoke
    own = run(app, ["explain", "between_se3"]).output
    assert "noise of covariance S in the frame of z: with x fixed, y has covariance S in its own" in own
    other = run(app, ["explain", "between_se3", "--chart", "sophus"]).output
    assert "noise of covariance S in the chart sophus at z, S' = M(z) S M(z)^T" in other
    assert "with y fixed, x has covariance Ad(z) S' Ad(z)^T in its own frame" in other
    assert "exact" not in other
