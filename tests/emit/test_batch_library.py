"""Batches of library and groups: the same bits on every width, and those of one factor without libm in it."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from batch_tools import VARIANTS, Variant, built, call_batch
from emit_tools import call_c

from liegen import library
from liegen.modules import every_function
from liegen.samples import CASES, Draw, default_sampler, negated
from liegen.verify.draws import stored

GROUPS = every_function()
FUNCTIONS = {
    f.name: f
    for f in (
        library.between_se3, library.between_se2, library.bearing_se3, library.sfm_cal3_s2, library.range_r2,
        GROUPS["se3_retract"], GROUPS["so3_local"], GROUPS["se2_compose"],
    )
}  # fmt: skip
#: With matrices among their values: one that is a matrix, one that stands for a rotation.
MATRICES = {
    f.name: f
    for f in (
        library.between_so3, library.sfm_cal3_s2, GROUPS["so3_Jr"],
        replace(GROUPS["so3_inverse"], layout="matrix"),
    )
}  # fmt: skip
CALLS = {"sin", "cos", "atan2"}
N = 29
PRECISIONS = {"double": "columns", "single": "single, columns"}
VARIANT = pytest.mark.parametrize("variant", [VARIANTS[name] for name in PRECISIONS], ids=PRECISIONS)
NAMES = pytest.mark.parametrize("name", FUNCTIONS)


@pytest.fixture(scope="module")
def widths(tmp_path_factory: pytest.TempPathFactory) -> list[ctypes.CDLL]:
    kernels = [f.kernel for f in FUNCTIONS.values()]
    flags = ["-DLANES=1"], ["-DLANES=8", "-O1"], ["-march=native", "-ffp-contract=off"]
    return [built(kernels, tmp_path_factory.mktemp("library"), chosen, "row") for chosen in flags]


@pytest.fixture(scope="module")
def matrices(tmp_path_factory: pytest.TempPathFactory) -> list[ctypes.CDLL]:
    kernels = [f.kernel for f in MATRICES.values()]
    flags = ["-DLANES=1"], ["-march=native", "-O1"]
    return [built(kernels, tmp_path_factory.mktemp("matrices"), chosen) for chosen in flags]


def drawn(name: str) -> dict[str, np.ndarray]:
    """Samples of every case, some with the other quaternion of a rotation; cameras see some of the points."""
    function = (FUNCTIONS | MATRICES)[name]
    sampler = default_sampler({p.name: p.manifold for p in function.graph.parameters})
    draw = Draw(np.random.default_rng(5))
    cases = [CASES[k % len(CASES)] for k in range(N)]
    rows = [stored(function, negated(sampler(draw, case), draw, always=case.negate)) for case in cases]
    return {
        a.name: np.array([row[a.name] for row in rows], float).reshape(N, -1)
        for a in function.kernel.arguments
    }


@NAMES
@VARIANT
def test_every_width_gives_the_same_bits(widths: list[ctypes.CDLL], name: str, variant: Variant) -> None:
    kernel, values = FUNCTIONS[name].kernel, drawn(name)
    first, *others = [call_batch(library, kernel, values, N, variant=variant) for library in widths]
    for code, got, status in others:
        assert code == first[0]
        np.testing.assert_array_equal(status, first[2])
        for output, array in first[1].items():
            np.testing.assert_array_equal(got[output], array)


@NAMES
@VARIANT
def test_a_batch_gives_the_bits_of_one_factor(widths: list[ctypes.CDLL], name: str, variant: Variant) -> None:
    kernel, values = FUNCTIONS[name].kernel, drawn(name)
    _, got, status = call_batch(widths[-1], kernel, values, N, variant=variant)
    libm = bool(CALLS & kernel.jacobians.op_counts().keys())
    function = getattr(widths[-1], f"demo_{name}{variant.one}")
    few = 18 * float(np.finfo(variant.dtype).eps)
    for k in range(N):
        one = {a: v[k] for a, v in values.items()}
        code, wanted = call_c(function, kernel.jacobians, one, dtype=variant.dtype)
        assert code == status[k]
        for output, array in wanted.items():
            scale = max(1.0, float(np.abs(array).max())) if np.isfinite(array).all() else 0.0
            np.testing.assert_allclose(got[output][k], array.ravel(), rtol=0, atol=few * scale * libm)


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize("precision", PRECISIONS)
def test_columns_are_the_rows_transposed(matrices: list[ctypes.CDLL], name: str, precision: str) -> None:
    """What stands for an element of a group keeps the order of its layout."""
    rows, columns = VARIANTS[precision], VARIANTS[PRECISIONS[precision]]
    kernel, values = MATRICES[name].kernel, drawn(name)
    kept = {o.name for o in kernel.outputs if o.laid_out}
    names = [p.name for p in kernel.jacobians.outputs]
    for shared in matrices:
        for wanted in (names, [], *([name] for name in names)):
            _, by_rows, bits = call_batch(shared, kernel, values, N, variant=rows, wanted=wanted)
            _, by_columns, status = call_batch(shared, kernel, values, N, variant=columns, wanted=wanted)
            np.testing.assert_array_equal(bits, status)
            assert list(by_columns) == wanted
            for port in (p for p in kernel.jacobians.outputs if p.name in wanted):
                matrix = by_rows[port.name].reshape(N, *port.shape)
                if len(port.shape) == 2 and port.name not in kept:
                    matrix = matrix.transpose(0, 2, 1)
                np.testing.assert_array_equal(by_columns[port.name], matrix.reshape(N, -1))


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
