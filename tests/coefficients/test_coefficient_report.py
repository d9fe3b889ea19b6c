"""The command that prints the measured bounds, and the page and the picture made from it."""

import importlib.util
import re
from dataclasses import replace
from pathlib import Path

import coefficient_reference as ref
import numpy as np
import pytest

from liegen.coefficients import accuracy, measurement
from liegen.coefficients import similarity_measurement as planes

DOCS = Path(__file__).resolve().parents[2] / "docs"
THETAS = np.array([0.0, 1e-160, 1e-9, 0.3, 1.7, 2.5, 3.1])


def load(path):
    spec = importlib.util.spec_from_file_location("drawing", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_exact_values_are_those_of_the_series():
    with ref.mp.workdps(ref.DIGITS):
        squares = [ref.exact(t) ** 2 for t in THETAS]
    for k, e in enumerate(measurement.measure(measurement.STUMPFF, measurement.SQUARE, THETAS)):
        assert e.exact.tolist() == [float(ref.c(k, t * t)) for t in THETAS]
    for e, f in zip(
        measurement.measure(measurement.INVERSE, measurement.THETA, THETAS), (ref.d, ref.e), strict=True
    ):
        assert e.exact.tolist() == [float(f(s)) for s in squares]
    (e,) = measurement.measure(measurement.LOG, measurement.W, THETAS)
    assert e.exact.tolist() == [float(ref.log_factor(w)) for w in np.cos(THETAS / 2)]


@pytest.mark.parametrize("theta", [0.2, 1.3, 3.0])
def test_textbook_formulas_are_the_same_functions(theta):
    with ref.mp.workdps(ref.DIGITS):
        t = ref.exact(theta)
        w = ref.mp.cos(t / 2)
        ours = (
            *measurement.textbook_stumpff(t),
            *measurement.textbook_inverse(t),
            *measurement.textbook_log(w),
        )
        closed = [f for family in (measurement.STUMPFF, measurement.INVERSE) for f in family.closed(t * t)]
        for a, b in zip(ours, [*closed, *measurement.LOG.closed(w)], strict=True):
            assert abs(a - b) < ref.mp.mpf(10) ** -50 * abs(b)


def test_conditioning_is_the_change_over_half_a_unit():
    theta = np.array([0.4, 1.5, 3.0, 6.0, 40.0])
    for k, e in enumerate(measurement.measure(measurement.STUMPFF, measurement.THETA, theta)):
        slope = [abs(2 * t * float(ref.c_slope(k, t * t))) for t in theta]
        np.testing.assert_allclose(e.conditioning, slope * np.spacing(theta) / 2, rtol=1e-9)


def test_conditioning_at_the_double_zero_of_c2():
    """(1 - cos)/theta^2 at 2 pi +- half a unit, from half a unit away: the slope alone allows too little."""
    theta = np.array([2 * np.pi])
    e = measurement.measure(measurement.STUMPFF, measurement.THETA, theta)[2]
    half = float(np.spacing(theta[0]) / 2)
    with ref.mp.workdps(ref.DIGITS):
        t = ref.exact(theta[0])
        values = [(1 - ref.mp.cos(t + x)) / (t + x) ** 2 for x in (-ref.exact(half), 0, ref.exact(half))]
        change = float(max(abs(values[0] - values[1]), abs(values[2] - values[1])))
    assert 0.99 * change <= e.conditioning[0] <= 1.01 * change


def test_the_textbook_formulas_break_the_bounds():
    """Each by its known cancellation, so that the measure is seen to measure."""
    theta = measurement.angles_from_zero(np.pi, 300)
    theta = theta[theta > 1e-12]
    worst = {}
    arguments = (measurement.THETA, measurement.THETA, measurement.W)
    families = (measurement.STUMPFF, measurement.INVERSE, measurement.LOG)
    for family, argument in zip(families, arguments, strict=True):
        for e in measurement.measure(family, argument, theta):
            worst[e.name] = np.nanmax(e.textbook / e.unit)
    assert all(worst[name] < 4 for name in ("c0", "c1"))
    assert all(worst[name] > 1e12 for name in ("c2", "c3", "c4", "c5", "D", "E"))
    assert worst["log factor"] > 1e6


def test_all_bounds_hold_and_the_command_says_so(monkeypatch, capsys):
    monkeypatch.setattr(accuracy, "QUICK", 200)
    assert accuracy.main(["--quick"]) == 0
    assert "| log factor | w " in capsys.readouterr().out


def test_the_command_fails_when_a_bound_does_not_hold(monkeypatch, capsys):
    worse = replace(
        measurement.INVERSE,
        calls=(lambda s: tuple(v * (1 + 2e-15) for v in measurement.INVERSE.calls[0](s)),),
    )
    monkeypatch.setattr(accuracy, "INVERSE", worse)
    monkeypatch.setattr(accuracy, "QUICK", 200)
    assert accuracy.main(["--quick"]) == 1
    broken = {r.function for r in accuracy.rows(200) if not r.holds}
    assert broken <= {"D", "E"}
    assert broken


def test_a_nan_is_not_within_any_bound():
    e = measurement.measure(measurement.LOG, measurement.W, np.array([0.0, 1.0]))[0]
    sizes = e.textbook / e.unit
    row = accuracy._row(e, measurement.W, "", "ulp", 1e300, sizes)
    assert np.isnan(row.worst)
    assert not row.holds


def test_the_page_has_the_rows_of_the_command():
    """Functions, ranges, units and bounds are those of the command; figures may differ by the platform."""
    page = (DOCS / "coefficients.md").read_text(encoding="utf-8")
    found = [
        tuple(c.strip() for c in line.split("|")[1:-1]) for line in page.splitlines() if line.startswith("|")
    ]
    for r in accuracy.rows(100):
        (row,) = [x for x in found if x[:4] == (r.function, r.argument, r.interval, r.measure)]
        assert float(row[4]) == r.bound
        assert float(row[5]) <= r.bound


@pytest.fixture(scope="module")
def similarities():
    return [x for plane in planes.PLANES for x in planes.measure(plane, 20)]


def test_the_page_has_the_similarities_of_the_command(similarities):
    """In the order of the command; the second C is that of the logarithm."""
    page = (DOCS / "coefficients.md").read_text(encoding="utf-8")
    lines = page.partition("| function | theta     | bound")[2].splitlines()[2:]
    found = [[c.strip() for c in line.strip("|").split("|")] for line in lines if "|" in line]
    assert [row[0] for row in found] == [x.function for x in similarities]
    for row, x in zip(found, similarities, strict=True):
        assert float(row[2]) == x.bound
        assert max(float(row[3]), x.worst) <= x.bound


def test_the_formulas_of_the_similarities_as_they_are_written_break_the_bounds(similarities):
    assert all(x.written > 1e4 for x in similarities)


def test_the_picture_is_drawn_the_same_every_time(tmp_path, monkeypatch):
    drawing = load(DOCS / "figures" / "coefficients.py")
    monkeypatch.setattr(drawing, "BINS", 10)
    monkeypatch.setattr(drawing, "PER_BIN", 2)
    for name in ("a.svg", "b.svg"):
        drawing.draw(tmp_path / name)
    text = (tmp_path / "a.svg").read_bytes()
    assert text == (tmp_path / "b.svg").read_bytes()
    assert b"dc:date" not in text


def test_the_checked_in_picture_belongs_to_the_page():
    page = (DOCS / "coefficients.md").read_text(encoding="utf-8")
    (picture,) = re.findall(r"!\[[^]]+\]\(([^)]+)\)", page)
    text = (DOCS / picture).read_text(encoding="utf-8")
    assert text.count('id="axes_') == 9
    assert "dc:date" not in text
