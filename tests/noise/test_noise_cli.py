"""--noise, --loss and --mode of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from liegen.cli import app


def run(*words: str):
    return CliRunner().invoke(app, list(words))


def test_generate_then_check(tmp_path: Path):
    options = ("--noise", "full", "--loss", "huber", "--mode", "triggs")
    made = run("generate", "-f", "between_so2", "-o", str(tmp_path), *options)
    assert made.exit_code == 0, made.output
    header = (tmp_path / "c" / "between_so2.h").read_text()
    assert "--noise full --loss huber --mode triggs" in header
    assert "sqrt_info[1 * 1]" in header
    assert run("check", str(tmp_path)).exit_code == 0


def test_verify_reports_the_gradient():
    done = run("verify", "-f", "prior_so2", "--noise", "isotropic", "--loss", "cauchy", "--samples", "8")
    assert done.exit_code == 0, done.output
    assert "does not apply: Jacobians of mode irls" in done.output
    title, row = done.output.splitlines()[:2]
    columns = {name: title.index(name) + len(name) for name in ("Jacobian", "gradient", "differences")}
    figures = {name: row[:end].split()[-1] for name, end in columns.items()}
    assert 0 < float(figures["gradient"]) < 1e-12
    assert 0 < float(figures["Jacobian"]) < 1e-12
    assert row[columns["gradient"] : columns["differences"]].strip() == ""


def test_unknown_names_list_those_that_exist(tmp_path: Path):
    done = run("generate", "-f", "between_so2", "-o", str(tmp_path), "--loss", "hubert")
    assert done.exit_code == 2
    assert "between_so2: unknown loss 'hubert'; choose from huber, pseudo-huber" in done.output


@pytest.mark.parametrize(
    ("noise", "kind", "meaning"),
    [
        ("full", "3 x 3 upper triangular", "square root S of the information, S^T S = covariance^-1"),
        ("packed", "R6 packed upper triangle", "square root S of the information, S^T S = covariance^-1"),
        ("diagonal", "R3 diagonal", "1 / standard deviation of each entry"),
        ("isotropic", "R1 isotropic", "1 / standard deviation, the same of every entry"),
    ],
)
def test_explain_says_what_the_keywords_are(noise: str, kind: str, meaning: str):
    done = run("explain", "between_so3", "--noise", noise, "--loss", "barron")
    first, *lines = done.output.splitlines()
    assert first.endswith(f"*, z: SO3, sqrt_info: {kind}, alpha: R1, c: R1) -> res: 3")
    assert any(line.startswith(f"  sqrt_info ({kind}): {meaning}") for line in lines)
    assert any(line.startswith("  alpha (R1): shape of the loss, any real number or -inf") for line in lines)
    assert any(line.startswith("  c (R1): scale of the loss, a length of the whitened") for line in lines)


def test_the_document_shows_what_explain_prints():
    document = Path(__file__).parents[2] / "docs" / "noise.md"
    shown = document.read_text(encoding="utf-8").partition("```text\n")[2].partition("```")[0]
    done = run("explain", "between_se3", "--noise", "full", "--loss", "cauchy")
    assert len(shown.splitlines()) == 5
    for line in shown.splitlines():
        assert line in done.output
