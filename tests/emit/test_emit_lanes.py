"""The elementary functions of generated batches against mpmath, on every width."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import mpmath
import numpy as np
import pytest
from batch_tools import WIDTHS
from emit_kernels import between_r2
from emit_tools import C99, FLAGS, compiler

from liegen.emit import render

mp = mpmath.mp.clone()
mp.prec = 160

#: Largest error that the comments of the functions state, in units in the last place.
BOUNDS = {
    "sin": 1.0, "cos": 1.0, "exp": 1.0, "log": 1.0, "sqrt": 0.5, "atan2": 1.5,
    "tan": 3.0, "asin": 3.0, "acos": 3.0, "atan": 3.0,
}  # fmt: skip
UNARY = [name for name in BOUNDS if name != "atan2"]
NUMPY = {"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan}
DENORMAL = 5e-324
SPECIAL = np.array(
    [0.0, DENORMAL, 1e-310, 2.3e-308, 1e-300, 1e-20, 1e-8, 0.5, 0.7, 1.0, 1.5, 2.0, np.pi / 4, np.pi / 2,
     np.pi, 700.0, 708.5, 709.78, 709.79, 745.1, 745.2, 746.0, 1e4, 1.4e6, 1.6e6, 1e22, 1e150, 1e300, 1.7e308,
     np.inf, np.nan]
)  # fmt: skip

DRIVER = """
#include "demo_lanes.h"
#define UNARY(name) \\
void run_##name(ptrdiff_t n, const double *a, const double *b, double *to) \\
{ \\
    (void)b; \\
    for (ptrdiff_t k = 0; k < n; k += LANES) { \\
        lanes x; \\
        memcpy(&x, a + k, sizeof x); \\
        x = lanes_##name(x); \\
        memcpy(to + k, &x, sizeof x); \\
    } \\
}
UNARY(sin) UNARY(cos) UNARY(tan) UNARY(asin) UNARY(acos) UNARY(atan) UNARY(exp) UNARY(log) UNARY(sqrt)
void run_atan2(ptrdiff_t n, const double *a, const double *b, double *to)
{
    for (ptrdiff_t k = 0; k < n; k += LANES) {
        lanes y, x;
        memcpy(&y, a + k, sizeof y);
        memcpy(&x, b + k, sizeof x);
        y = lanes_atan2(y, x);
        memcpy(to + k, &y, sizeof y);
    }
}
"""


@pytest.fixture(scope="module", params=WIDTHS)
def lanes(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder: Path = tmp_path_factory.mktemp("lanes")
    for path, text in render([between_r2()], ["c"], package="demo", regenerate="").items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    (folder / "driver.c").write_text(DRIVER, encoding="utf-8")
    command = [compiler(), *C99, *FLAGS, "-Wno-psabi", *request.param, "-shared", "-fPIC", "driver.c", "-lm"]
    subprocess.run([*command, "-o", "driver.so"], check=True, cwd=folder)
    return ctypes.CDLL(str(folder / "driver.so"))


def run(lanes: ctypes.CDLL, name: str, a: np.ndarray, b: np.ndarray | None = None) -> np.ndarray:
    """The function on arrays of any size."""
    n = -(-len(a) // 8) * 8
    a, b = np.resize(a, n), np.resize(a if b is None else b, n)
    to = np.empty(n)
    function = getattr(lanes, f"run_{name}")
    function.argtypes = [ctypes.c_ssize_t, *[ctypes.c_void_p] * 3]
    function(n, a.ctypes.data, b.ctypes.data, to.ctypes.data)
    return to


def ulps(got: float, exact) -> float:
    """The error in units in the last place of the exact value."""
    unit = max(float(np.spacing(abs(float(exact)))), DENORMAL)
    return float(abs(mp.mpf(got) - exact) / unit)


def spread(rng: np.random.Generator, low: float, high: float, n: int) -> np.ndarray:
    """Numbers of all magnitudes between two, of both signs."""
    return np.exp(rng.uniform(np.log(low), np.log(high), n)) * rng.choice([-1.0, 1.0], n)


def arguments(name: str) -> np.ndarray:
    """Usual, tiny and large arguments; those next to a zero of the result."""
    rng = np.random.default_rng(7)
    turns = np.round(spread(rng, 1, 9e5, 100)) * (np.pi / 2)
    if name in ("sin", "cos", "tan"):
        return np.concatenate(
            [rng.uniform(-4, 4, 200), spread(rng, 1e-9, 1.5e6, 200), turns, spread(rng, 2e6, 1e300, 40)]
        )
    if name in ("asin", "acos"):
        near = 1.0 - spread(rng, 1e-16, 1.0, 100)
        return np.clip(
            np.concatenate([rng.uniform(-1, 1, 200), spread(rng, 1e-9, 1, 100), near, -near]), -1, 1
        )
    if name == "exp":
        return np.concatenate(
            [rng.uniform(-745, 709.7, 300), rng.uniform(-1, 1, 200), spread(rng, 1e-18, 1, 50)]
        )
    if name in ("log", "sqrt"):
        around = 1.0 + spread(rng, 1e-15, 0.5, 200)
        return np.concatenate([np.abs(spread(rng, DENORMAL, 1e308, 300)), around, [DENORMAL, 2.3e-308]])
    return spread(rng, 1e-9, 1e9, 400)


@pytest.mark.parametrize("name", UNARY)
def test_errors_are_below_the_stated_bound(lanes: ctypes.CDLL, name: str) -> None:
    given = arguments(name)
    got = run(lanes, name, given)
    function = getattr(mp, name)
    worst = max((ulps(g, function(mp.mpf(x))), x) for g, x in zip(got, given, strict=False))
    assert worst[0] <= BOUNDS[name], worst


def test_the_angle_of_a_point_is_within_its_bound(lanes: ctypes.CDLL) -> None:
    rng = np.random.default_rng(8)
    y, x = rng.normal(size=(2, 400))
    tiny = rng.integers(1, 40, (2, 50)) * DENORMAL
    pairs = [
        (y, x), (y, y * (1 + rng.uniform(-1e-3, 1e-3, 400))), (y, 2 * y * (1 + rng.uniform(-0.1, 0.1, 400))),
        (spread(rng, DENORMAL, 1.7e308, 400), spread(rng, DENORMAL, 1.7e308, 400)), tuple(tiny),
        (spread(rng, 1e299, 1.7e308, 100), spread(rng, 1e299, 1.7e308, 100)),
    ]  # fmt: skip
    for a, b in pairs:
        got = run(lanes, "atan2", a, b)
        found = [(ulps(g, mp.atan2(mp.mpf(p), mp.mpf(q))), p, q) for g, p, q in zip(got, a, b, strict=False)]
        assert max(found)[0] <= BOUNDS["atan2"], max(found)


def agree(got: np.ndarray, wanted: np.ndarray, ulp: float, what: str) -> None:
    """NaN where NaN is wanted, the same infinities, the same signs of zeros, otherwise within some ulp."""
    for g, w in zip(got, wanted, strict=False):
        if np.isnan(w) or np.isinf(w) or w == 0:
            assert (np.isnan(g) and np.isnan(w)) or (g == w and np.signbit(g) == np.signbit(w)), (what, g, w)
        else:
            assert abs(g - w) <= ulp * np.spacing(abs(w)), (what, g, w)


@pytest.mark.parametrize("name", UNARY)
def test_special_values_are_those_of_the_standard(lanes: ctypes.CDLL, name: str) -> None:
    given = np.concatenate([SPECIAL, -SPECIAL])
    with np.errstate(all="ignore"):
        wanted = NUMPY.get(name, getattr(np, name, None))(given)
    agree(run(lanes, name, given), wanted, BOUNDS[name] + 1, name)


def test_angles_of_special_values_are_those_of_the_standard(lanes: ctypes.CDLL) -> None:
    both = np.concatenate([SPECIAL, -SPECIAL])
    y, x = (np.ascontiguousarray(a.ravel()) for a in np.meshgrid(both, both))
    agree(run(lanes, "atan2", y, x), np.arctan2(y, x), BOUNDS["atan2"] + 1, "atan2")
