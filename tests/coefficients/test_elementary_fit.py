"""The polynomials of the elementary functions are what the fit derives."""

from pathlib import Path

from liegen.coefficients import elementary, elementary_fit


def test_tables_are_rederived_exactly():
    assert Path(elementary.__file__).read_text(encoding="utf-8") == elementary_fit.render()


def test_polynomials_are_those_of_the_functions():
    """Their first coefficients are close to those of the Taylor series."""
    series = {"ATAN": -1 / 3, "SIN": -1 / 6, "COS": 1 / 24, "EXP": 1 / 2, "LOG": 2 / 3}
    for name, first in series.items():
        assert abs(getattr(elementary, name)[0] - first) < 1e-13
        assert abs(getattr(elementary, f"{name}_F32")[0] - first) < 2e-6
