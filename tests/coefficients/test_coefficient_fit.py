"""The tables are what the fit derives, and the fit is minimax."""

from pathlib import Path

from liegen.coefficients import fit, tables

mp = fit.mp


def test_tables_are_rederived_exactly():
    assert Path(tables.__file__).read_text(encoding="utf-8") == fit.render()


def test_polynomials_do_not_cancel():
    """All coefficients of the logarithm's P and Q are positive: Horner's rule loses nothing."""
    assert min(*tables.LOG_P, *tables.LOG_Q) > 0


def test_minimax_finds_a_known_polynomial():
    """x^3 on [0, 1] is approximated in degree 2 with the error 2^-5 of the shifted Chebyshev polynomial."""
    samples = [fit.Sample(x, x**3, mp.mpf(1)) for x in fit.chebyshev(1.0, 4000)]
    coefficients, level = fit.minimax(samples, 2)
    assert abs(level * 32 - 1) < 1e-5
    expected = [1 / 32, -18 / 32, 48 / 32]  # x^3 - T_3(2x - 1)/32
    assert all(abs(a - b) < 1e-4 for a, b in zip(coefficients, expected, strict=True))


def test_extrema_alternate_and_keep_the_largest():
    errors = [1, 3, -2, 0.1, -4, 5, -1, 2]
    chosen = fit._extrema(errors, 4)
    assert [errors[i] for i in chosen] == [3, -4, 5, -1] or [errors[i] for i in chosen] == [-4, 5, -1, 2]
    assert 5 in [errors[i] for i in chosen]
