"""Batches against the functions of one factor: every layout, any n, tails, NULL, index, status."""

from __future__ import annotations

import numpy as np
import pytest
from batch_tools import LAYOUTS, PACKED, Layout, call_batch
from emit_kernels import examples
from emit_tools import call_c, library, samples

from liegen.kernel import Kernel

N = 19


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> object:
    return library(examples(), tmp_path_factory.mktemp("batch"))


def one_by_one(demo: object, kernel: Kernel, values: dict[str, np.ndarray], n: int):
    """Status (n) and outputs (n, size) by the function of one factor."""
    function = getattr(demo, f"demo_{kernel.name}")
    rows = [call_c(function, kernel.jacobians, {k: v[i] for k, v in values.items()}) for i in range(n)]
    stacked = {
        p.name: np.array([outputs[p.name].ravel() for _, outputs in rows]).reshape(n, p.size)
        for p in kernel.jacobians.outputs
    }
    return np.array([code for code, _ in rows], dtype=int), stacked


def same_bits(got: np.ndarray, wanted: np.ndarray) -> None:
    """Equal to the last bit; NaN equals NaN."""
    np.testing.assert_array_equal(got, wanted)
    numbers = ~np.isnan(wanted)
    np.testing.assert_array_equal(np.signbit(got[numbers]), np.signbit(wanted[numbers]))


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
@pytest.mark.parametrize("n", range(18))
def test_any_n(demo: object, kernel: Kernel, n: int) -> None:
    values = samples(kernel, n, (max(n, 1),))
    status, wanted = one_by_one(demo, kernel, values, n)
    code, got, bits = call_batch(getattr(demo, f"demo_{kernel.name}_batch"), kernel, values, n)
    assert code == int(np.bitwise_or.reduce(status, initial=0))
    np.testing.assert_array_equal(bits, status)
    for name, array in wanted.items():
        same_bits(got[name], array)


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
@pytest.mark.parametrize("into", LAYOUTS, ids=lambda layout: layout.name)
@pytest.mark.parametrize("outof", LAYOUTS, ids=lambda layout: layout.name)
def test_any_layout(demo: object, kernel: Kernel, into: Layout, outof: Layout) -> None:
    values = samples(kernel, 1, (N,))
    _, wanted = one_by_one(demo, kernel, values, N)
    _, got, _ = call_batch(
        getattr(demo, f"demo_{kernel.name}_batch"), kernel, values, N, into=into, outof=outof
    )
    for name, array in wanted.items():
        same_bits(got[name], array)


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
def test_any_output_may_be_null(demo: object, kernel: Kernel) -> None:
    values = samples(kernel, 2, (N,))
    function = getattr(demo, f"demo_{kernel.name}_batch")
    names = [p.name for p in kernel.jacobians.outputs]
    _, everything, bits = call_batch(function, kernel, values, N)
    for wanted in ([], *([name] for name in names), names[1:]):
        _, got, status = call_batch(function, kernel, values, N, wanted=wanted)
        assert list(got) == wanted
        np.testing.assert_array_equal(status, bits)
        for name in wanted:
            same_bits(got[name], everything[name])


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
@pytest.mark.parametrize("outof", [PACKED, LAYOUTS[3]], ids=lambda layout: layout.name)
def test_index_and_broadcast(demo: object, kernel: Kernel, outof: Layout) -> None:
    rng = np.random.default_rng(3)
    values = samples(kernel, 3, (5,))
    first, *others = [a.name for a in kernel.arguments]
    index = {name: rng.integers(0, 5, N) for name in others}
    gathered = {first: np.repeat(values[first][:1], N, axis=0)} | {k: values[k][i] for k, i in index.items()}
    _, wanted = one_by_one(demo, kernel, gathered, N)
    function = getattr(demo, f"demo_{kernel.name}_batch")
    _, got, _ = call_batch(function, kernel, values, N, outof=outof, index=index, broadcast=[first])
    for name, array in wanted.items():
        same_bits(got[name], array)


def test_status_may_be_null(demo: object) -> None:
    kernel = next(k for k in examples() if k.value.requirements)
    values = samples(kernel, 4, (N,))
    function = getattr(demo, f"demo_{kernel.name}_batch")
    code, _, status = call_batch(function, kernel, values, N)
    assert code != 0
    assert 0 < np.count_nonzero(status) < N
    assert call_batch(function, kernel, values, N, with_status=False)[0] == code
