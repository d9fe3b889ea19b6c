"""The functions of angles of single calls against mpmath; the same cases as those of batches."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import mpmath
import numpy as np
import pytest
from emit_kernels import between_r2
from emit_tools import C99, FLAGS, compiler
from test_emit_lanes import BOUNDS, DOUBLE, Functions, agree, arguments, spread

from liegen.emit import render

mp = mpmath.mp.clone()
mp.prec = 160

DRIVER = """
#include "demo_math.h"
#include <stddef.h>
void run_atan2(ptrdiff_t n, const double *y, const double *x, double *to)
{
    for (ptrdiff_t k = 0; k < n; ++k) to[k] = demo_atan2(y[k], x[k]);
}
void run_sincos(ptrdiff_t n, const double *x, double *s, double *c)
{
    for (ptrdiff_t k = 0; k < n; ++k) demo_sincos(x[k], s + k, c + k);
}
"""
VARIANTS = ([], ["-O3", "-march=native", "-ffp-contract=fast"], ["-O2", "-ffast-math"])


@pytest.fixture(scope="module", params=VARIANTS, ids=["plain", "contracted", "fast math"])
def library(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder: Path = tmp_path_factory.mktemp("math")
    for path, text in render([between_r2()], ["c"], package="demo", regenerate="").items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    (folder / "driver.c").write_text(DRIVER, encoding="utf-8")
    compiled = [compiler(), *C99, *FLAGS, *request.param, "-fPIC", "-c", "driver.c", "-o", "driver.o"]
    subprocess.run(compiled, check=True, cwd=folder)
    # Linked without -ffast-math, which would make the whole process flush denormal numbers to zero.
    linked = [compiler(), "-shared", "driver.o", "-o", "driver.so", "-lm"]
    subprocess.run(linked, check=True, cwd=folder)
    return ctypes.CDLL(str(folder / "driver.so"))


@pytest.fixture
def strict(request: pytest.FixtureRequest, library: ctypes.CDLL) -> ctypes.CDLL:
    """The library, where its flags promise infinities, NaN and signs of zeros."""
    if "fast math" in request.node.name:
        pytest.skip("-ffast-math gives up special values")
    return library


SPECIAL = np.array(DOUBLE.special)


ulps = Functions(DOUBLE, ctypes.CDLL(None)).ulps


def call(function: ctypes._CFuncPtr, *arrays: np.ndarray) -> None:
    function.argtypes = [ctypes.c_ssize_t, *[ctypes.c_void_p] * len(arrays)]
    function(len(arrays[0]), *(a.ctypes.data for a in arrays))


def angle(library: ctypes.CDLL, y: np.ndarray, x: np.ndarray) -> np.ndarray:
    to = np.empty(len(y))
    call(library.run_atan2, np.ascontiguousarray(y), np.ascontiguousarray(x), to)
    return to


def sine_cosine(library: ctypes.CDLL, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    s, c = np.empty(len(x)), np.empty(len(x))
    call(library.run_sincos, np.ascontiguousarray(x), s, c)
    return s, c


def test_the_angle_of_a_point_is_within_its_bound(library: ctypes.CDLL) -> None:
    rng = np.random.default_rng(8)
    y, x = rng.normal(size=(2, 2000))
    pairs = [
        (y, x), (y, y * rng.uniform(0.999, 1.001, 2000)), (y, 2 * y * rng.uniform(0.9, 1.1, 2000)),
        (spread(rng, 1e-300, 1.7e308, 400), spread(rng, 1e-300, 1.7e308, 400)),
        (spread(rng, 1e299, 1.7e308, 100), spread(rng, 1e299, 1.7e308, 100)),
    ]  # fmt: skip
    for a, b in pairs:
        got = angle(library, a, b)
        found = [(ulps(g, mp.atan2(mp.mpf(p), mp.mpf(q))), p, q) for g, p, q in zip(got, a, b, strict=True)]
        assert max(found)[0] <= BOUNDS["atan2"], max(found)


def test_sine_and_cosine_are_within_their_bounds(
    library: ctypes.CDLL, request: pytest.FixtureRequest
) -> None:
    bound = 1.5 if "fast math" in request.node.name else BOUNDS["sin"]
    rng = np.random.default_rng(9)
    quarter = np.pi / 4 * (1 + rng.uniform(-1e-12, 1e-12, 100))
    x = np.concatenate([arguments("sin", DOUBLE), rng.uniform(-0.8, 0.8, 2000), quarter])
    for got, name in zip(sine_cosine(library, x), ("sin", "cos"), strict=True):
        found = [(ulps(g, getattr(mp, name)(mp.mpf(v))), v) for g, v in zip(got, x, strict=True)]
        assert max(found)[0] <= bound, (name, max(found))


def test_special_values_are_those_of_the_standard(strict: ctypes.CDLL) -> None:
    both = np.concatenate([SPECIAL, -SPECIAL])
    y, x = (a.ravel() for a in np.meshgrid(both, both))
    agree(angle(strict, y, x), np.arctan2(y, x), BOUNDS["atan2"] + 1, "atan2")
    with np.errstate(invalid="ignore"):
        wanted = np.sin(both), np.cos(both)
    for got, values, name in zip(sine_cosine(strict, both), wanted, ("sin", "cos"), strict=True):
        agree(got, values, BOUNDS[name] + 1, name)


def test_denormal_points_have_an_angle(strict: ctypes.CDLL) -> None:
    y, x = np.random.default_rng(10).integers(1, 40, (2, 50)) * DOUBLE.denormal
    got = angle(strict, y, x)
    found = [(ulps(g, mp.atan2(mp.mpf(p), mp.mpf(q))), p, q) for g, p, q in zip(got, y, x, strict=True)]
    assert max(found)[0] <= BOUNDS["atan2"], max(found)
