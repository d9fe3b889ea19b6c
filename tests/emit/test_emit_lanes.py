"""The elementary functions of generated batches against mpmath, on every width, in double and single."""

from __future__ import annotations

import ctypes
import subprocess
from dataclasses import dataclass
from pathlib import Path

import mpmath
import numpy as np
import pytest
from batch_tools import WIDTHS
from emit_kernels import between_r2
from emit_tools import C99, FLAGS, compiler

from liegen.emit import render
from liegen.emit.precision import in_single

mp = mpmath.mp.clone()
mp.prec = 160

#: Largest error that the comments of the functions state, in units in the last place.
BOUNDS = {
    "sin": 1.0, "cos": 1.0, "exp": 1.0, "log": 1.0, "sqrt": 0.5, "atan2": 1.6,
    "tan": 3.0, "asin": 3.0, "acos": 3.0, "atan": 3.0,
}  # fmt: skip
UNARY = [name for name in BOUNDS if name != "atan2"]
NUMPY = {"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan}


@dataclass(frozen=True)
class Scalar:
    """A type of number; ``far``: where sin and cos go to libm; ``growth``: exp is finite and not 0 within."""

    name: str
    dtype: type
    far: float
    growth: tuple[float, float]
    special: tuple[float, ...]

    @property
    def denormal(self) -> float:
        return float(np.finfo(self.dtype).smallest_subnormal)

    @property
    def largest(self) -> float:
        return float(np.finfo(self.dtype).max)

    @property
    def eps(self) -> float:
        return float(np.finfo(self.dtype).eps)

    def array(self, *parts) -> np.ndarray:
        with np.errstate(all="ignore"):
            return np.concatenate([np.asarray(p) for p in parts]).astype(self.dtype)


USUAL = (
    0.0,
    1e-20,
    1e-8,
    0.5,
    0.7,
    1.0,
    1.5,
    2.0,
    np.pi / 4,
    np.pi / 2,
    np.pi,
    1e4,
    1.6e6,
    1e22,
    np.inf,
    np.nan,
)
DOUBLE = Scalar(
    "double", np.float64, 1.5e6, (-745.0, 709.7),
    (*USUAL, 5e-324, 1e-310, 2.3e-308, 1e-300, 700.0, 708.5, 709.78, 709.79, 745.1, 745.2, 746.0, 1.4e6,
     1e150, 1e300, 1.7e308),
)  # fmt: skip
SINGLE = Scalar(
    "float", np.float32, 1.5e3, (-103.2, 88.7),
    (*USUAL, 1.4e-45, 1e-40, 1.2e-38, 1e-37, 87.0, 88.72, 88.73, 103.9, 103.98, 104.0, 1.4e3, 1.6e3, 1e19,
     1e37, 3.4e38),
)  # fmt: skip
BUILDS = [(scalar, flags) for scalar in (DOUBLE, SINGLE) for flags in WIDTHS] + [(SINGLE, ["-DLANES=16"])]

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


@dataclass(frozen=True)
class Functions:
    """The driver, built for a type of number."""

    scalar: Scalar
    library: ctypes.CDLL

    def run(self, name: str, a: np.ndarray, b: np.ndarray | None = None) -> np.ndarray:
        """The function on arrays of any size."""
        n = -(-len(a) // 16) * 16
        a, b = (np.resize(x, n).astype(self.scalar.dtype) for x in (a, a if b is None else b))
        to = np.empty_like(a)
        function = self.library[f"run_{name}"]
        function.argtypes = [ctypes.c_ssize_t, *[ctypes.c_void_p] * 3]
        function(n, a.ctypes.data, b.ctypes.data, to.ctypes.data)
        return to

    def ulps(self, got: float, exact) -> float:
        """The error in units in the last place of the exact value."""
        with np.errstate(over="ignore"):
            size = abs(self.scalar.dtype(float(exact)))
        unit = max(float(np.spacing(min(size, self.scalar.dtype(self.scalar.largest)))), self.scalar.denormal)
        return float(abs(mp.mpf(float(got)) - exact) / unit)


def title(build: tuple[Scalar, list[str]]) -> str:
    return f"{build[0].name} {' '.join(build[1])}"


@pytest.fixture(scope="module", params=BUILDS, ids=title)
def lanes(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Functions:
    scalar, flags = request.param
    folder: Path = tmp_path_factory.mktemp("lanes")
    for path, text in render([between_r2()], ["c"], package="demo", regenerate="", scalar="float").items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    driver = in_single(DRIVER).replace("_lanes.h", "_lanes_f32.h") if scalar is SINGLE else DRIVER
    (folder / "driver.c").write_text(driver, encoding="utf-8")
    strict = ["-Wdouble-promotion", "-Wconversion"] if scalar is SINGLE else []
    command = [compiler(), *C99, *FLAGS, *strict, "-Wno-psabi", *flags, "-shared", "-fPIC", "driver.c", "-lm"]
    subprocess.run([*command, "-o", "driver.so"], check=True, cwd=folder)
    return Functions(scalar, ctypes.CDLL(str(folder / "driver.so")))


def spread(rng: np.random.Generator, low: float, high: float, n: int) -> np.ndarray:
    """Numbers of all magnitudes between two, of both signs."""
    return np.exp(rng.uniform(np.log(low), np.log(high), n)) * rng.choice([-1.0, 1.0], n)


def arguments(name: str, scalar: Scalar) -> np.ndarray:
    """Usual, tiny and large arguments; those next to a zero of the result."""
    rng = np.random.default_rng(7)
    tiny, huge = 1e-9, scalar.largest / 1e8
    if name in ("sin", "cos", "tan"):
        turns = np.round(spread(rng, 1, 0.6 * scalar.far, 100)) * (np.pi / 2)
        within, beyond = spread(rng, tiny, scalar.far, 200), spread(rng, 1.3 * scalar.far, huge, 40)
        return scalar.array(rng.uniform(-4, 4, 200), within, turns, beyond)
    if name in ("asin", "acos"):
        near = 1.0 - spread(rng, scalar.eps / 2, 1.0, 100)
        return np.clip(scalar.array(rng.uniform(-1, 1, 200), spread(rng, tiny, 1, 100), near, -near), -1, 1)
    if name == "exp":
        return scalar.array(
            rng.uniform(*scalar.growth, 300), rng.uniform(-1, 1, 200), spread(rng, tiny**2, 1, 50)
        )
    if name in ("log", "sqrt"):
        around = 1.0 + spread(rng, scalar.eps, 0.5, 200)
        everywhere = np.abs(spread(rng, scalar.denormal, scalar.largest, 300))
        return scalar.array(everywhere, around, [scalar.denormal, 1.01 * np.finfo(scalar.dtype).tiny])
    return scalar.array(spread(rng, tiny, 1e9, 400))


@pytest.mark.parametrize("name", UNARY)
def test_errors_are_below_the_stated_bound(lanes: Functions, name: str) -> None:
    given = arguments(name, lanes.scalar)
    got = lanes.run(name, given)
    function = getattr(mp, name)
    worst = max((lanes.ulps(g, function(mp.mpf(float(x)))), x) for g, x in zip(got, given, strict=False))
    assert worst[0] <= BOUNDS[name], worst


def test_the_angle_of_a_point_is_within_its_bound(lanes: Functions) -> None:
    rng, scalar = np.random.default_rng(8), lanes.scalar
    y, x = rng.normal(size=(2, 400))
    tiny = rng.integers(1, 40, (2, 50)) * scalar.denormal
    large = scalar.largest / 1.001
    pairs = [
        (y, x), (y, y * (1 + rng.uniform(-1e-3, 1e-3, 400))), (y, 2 * y * (1 + rng.uniform(-0.1, 0.1, 400))),
        (spread(rng, scalar.denormal, large, 400), spread(rng, scalar.denormal, large, 400)), tuple(tiny),
        (spread(rng, large / 1e9, large, 100), spread(rng, large / 1e9, large, 100)),
    ]  # fmt: skip
    # where the reduced argument is least accurate, next to 1/2
    pairs.append((y, 2 * y * (1 + rng.uniform(-0.06, 0.0, 400))))
    for a, b in ((scalar.array(a), scalar.array(b)) for a, b in pairs):
        got = lanes.run("atan2", a, b)
        exact = [mp.atan2(mp.mpf(float(p)), mp.mpf(float(q))) for p, q in zip(a, b, strict=True)]
        found = [(lanes.ulps(g, e), p, q) for g, e, p, q in zip(got, exact, a, b, strict=False)]
        assert max(found)[0] <= BOUNDS["atan2"], max(found)


def agree(got: np.ndarray, wanted: np.ndarray, ulp: float, what: str) -> None:
    """NaN where NaN is wanted, the same infinities, the same signs of zeros, otherwise within some ulp."""
    for g, w in zip(got, wanted, strict=False):
        if np.isnan(w) or np.isinf(w) or w == 0:
            assert (np.isnan(g) and np.isnan(w)) or (g == w and np.signbit(g) == np.signbit(w)), (what, g, w)
        else:
            assert abs(g - w) <= ulp * np.spacing(abs(w)), (what, g, w)


def rounded(function, scalar: Scalar, *given: np.ndarray) -> np.ndarray:
    """NumPy's function in double, rounded to the type."""
    with np.errstate(all="ignore"):
        return function(*(a.astype(np.float64) for a in given)).astype(scalar.dtype)


@pytest.mark.parametrize("name", UNARY)
def test_special_values_are_those_of_the_standard(lanes: Functions, name: str) -> None:
    given = lanes.scalar.array(lanes.scalar.special, np.negative(lanes.scalar.special))
    wanted = rounded(NUMPY.get(name, getattr(np, name, None)), lanes.scalar, given)
    agree(lanes.run(name, given), wanted, BOUNDS[name] + 1, name)


def test_angles_of_special_values_are_those_of_the_standard(lanes: Functions) -> None:
    both = lanes.scalar.array(lanes.scalar.special, np.negative(lanes.scalar.special))
    y, x = (np.ascontiguousarray(a.ravel()) for a in np.meshgrid(both, both))
    agree(lanes.run("atan2", y, x), rounded(np.arctan2, lanes.scalar, y, x), BOUNDS["atan2"] + 1, "atan2")


@pytest.mark.parametrize("name", UNARY)
@pytest.mark.parametrize("lanes", [b for b in BUILDS if b[0] is SINGLE], indirect=True, ids=title)
def test_the_whole_range_of_floats(lanes: Functions, name: str) -> None:
    """Every 9973rd number of single precision, denormal to infinite; the reference has twice the digits."""
    given = np.arange(0, 2**32, 9973, dtype=np.uint64).astype(np.uint32).view(np.float32)
    got = lanes.run(name, given)[: len(given)].astype(np.float64)
    with np.errstate(all="ignore"):
        exact = NUMPY.get(name, getattr(np, name, None))(given.astype(np.float64))
        wanted = exact.astype(np.float32)
        error = np.abs(got - exact) / np.maximum(np.spacing(np.abs(wanted)), np.float32(SINGLE.denormal))
    finite = np.isfinite(wanted)
    np.testing.assert_array_equal(got[~finite], wanted[~finite])
    np.testing.assert_array_equal(np.signbit(got[finite]), np.signbit(exact[finite]))
    assert error[finite].max() <= BOUNDS[name], given[finite][error[finite].argmax()]
