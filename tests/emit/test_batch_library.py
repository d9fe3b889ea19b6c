"""Batches of library and groups: the same bits on every width, and those of one factor without libm in it."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from batch_tools import built, call_batch
from emit_tools import call_c

from liegen import library
from liegen.modules import every_function
from liegen.samples import CASES, Draw, default_sampler, negated

GROUPS = every_function()
FUNCTIONS = {
    f.name: f
    for f in (
        library.between_se3, library.between_se2, library.bearing_se3, library.sfm_cal3_s2, library.range_r2,
        GROUPS["se3_retract"], GROUPS["so3_local"], GROUPS["se2_compose"],
    )
}  # fmt: skip
CALLS = {"sin", "cos", "atan2"}
N = 29
NAMES = pytest.mark.parametrize("name", FUNCTIONS)


@pytest.fixture(scope="module")
def widths(tmp_path_factory: pytest.TempPathFactory) -> list[ctypes.CDLL]:
    kernels = [f.kernel for f in FUNCTIONS.values()]
    flags = ["-DLANES=1"], ["-DLANES=8"], ["-march=native", "-ffp-contract=off"]
    return [built(kernels, tmp_path_factory.mktemp("library"), chosen) for chosen in flags]


def drawn(name: str) -> dict[str, np.ndarray]:
    """Samples of every case, some with the other quaternion of a rotation; cameras see some of the points."""
    function = FUNCTIONS[name]
    sampler = default_sampler({p.name: p.manifold for p in function.graph.parameters})
    draw = Draw(np.random.default_rng(5))
    cases = [CASES[k % len(CASES)] for k in range(N)]
    rows = [negated(sampler(draw, case), draw, always=case.negate) for case in cases]
    return {
        a.name: np.array([row[a.name] for row in rows], float).reshape(N, -1)
        for a in function.kernel.arguments
    }


@NAMES
def test_every_width_gives_the_same_bits(widths: list[ctypes.CDLL], name: str) -> None:
    kernel, values = FUNCTIONS[name].kernel, drawn(name)
    first, *others = [call_batch(library, kernel, values, N) for library in widths]
    for code, got, status in others:
        assert code == first[0]
        np.testing.assert_array_equal(status, first[2])
        for output, array in first[1].items():
            np.testing.assert_array_equal(got[output], array)


@NAMES
def test_a_batch_gives_the_bits_of_one_factor(widths: list[ctypes.CDLL], name: str) -> None:
    kernel, values = FUNCTIONS[name].kernel, drawn(name)
    _, got, status = call_batch(widths[-1], kernel, values, N)
    libm = bool(CALLS & kernel.jacobians.op_counts().keys())
    for k in range(N):
        one = {a: v[k] for a, v in values.items()}
        code, wanted = call_c(getattr(widths[-1], f"demo_{name}"), kernel.jacobians, one)
        assert code == status[k]
        for output, array in wanted.items():
            scale = max(1.0, float(np.abs(array).max())) if np.isfinite(array).all() else 0.0
            np.testing.assert_allclose(got[output][k], array.ravel(), rtol=0, atol=4e-15 * scale * libm)


def test_some_of_the_points_are_behind_the_camera(widths: list[ctypes.CDLL]) -> None:
    kernel, values = library.sfm_cal3_s2.kernel, drawn("sfm_cal3_s2")
    _, got, status = call_batch(widths[1], kernel, values, N)
    assert 0 < np.count_nonzero(status) < N
    for array in got.values():
        np.testing.assert_array_equal(np.isnan(array).all(axis=1), status != 0)


def test_group_operations_write_over_their_argument(widths: list[ctypes.CDLL]) -> None:
    """``retract(x, d, x)`` on arrays of one layout."""
    from liegen.verify.batches import In, Out, batch_function

    kernel, values = GROUPS["se3_retract"].kernel, drawn("se3_retract")
    names = [a.name for a in kernel.arguments]
    for shared in widths:
        _, wanted, _ = call_batch(shared, kernel, values, N, wanted=["out"])
        x, d = (np.ascontiguousarray(values[n]) for n in names)
        function = batch_function(shared, "demo", kernel)
        ins = [In(a.ctypes.data, a.shape[1], 1, None) for a in (x, d)]
        unwanted = [Out(None, 0, 0)] * (len(kernel.jacobians.outputs) - 1)
        function(N, *ins, Out(x.ctypes.data, 7, 1), *unwanted, None)
        np.testing.assert_array_equal(x, wanted["out"])
