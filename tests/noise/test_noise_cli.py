"""--noise, --loss and --mode of the command line."""

from __future__ import annotations

from pathlib import Path

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
