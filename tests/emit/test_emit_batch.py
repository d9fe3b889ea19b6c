"""Batches against the functions of one factor: every layout, any n, NULL, index, status; every build."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from batch_tools import BUILDS, LAYOUTS, PACKED, VARIANTS, Variant, built, call_batch
from emit_kernels import bearing_range, examples
from emit_tools import call_c, samples

from liegen.emit.c_block import without_chosen_conditions
from liegen.kernel import Kernel
from liegen.program import Port, Program
from liegen.program.rewrite import Builder

N = 19
KERNELS = pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
#: Generated code has its own; the functions of one factor call libm.
OWN = {"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log"}
#: Every build of the plain batches, some of the others.
DEMOS = [(build, "double") for build in BUILDS] + [
    (build, variant)
    for build in ("1 lane", "2 lanes", "16 lanes", "widest, streams", "threads, streams")
    for variant in VARIANTS
    if variant != "double"
]


@dataclass(frozen=True)
class Demo:
    """A build, and which of its functions are meant."""

    library: ctypes.CDLL
    variant: Variant

    def batch(self, *given, **options):
        return call_batch(self.library, *given, **options, variant=self.variant)


@pytest.fixture(scope="module")
def builds(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], ctypes.CDLL]:
    return cache(lambda name: built(examples(), tmp_path_factory.mktemp("batch"), BUILDS[name]))


@pytest.fixture(params=DEMOS, ids=": ".join)
def demo(request: pytest.FixtureRequest, builds: Callable[[str], ctypes.CDLL]) -> Demo:
    build, variant = request.param
    return Demo(builds(build), VARIANTS[variant])


def one_by_one(demo: Demo, kernel: Kernel, values: dict[str, np.ndarray], n: int):
    """Status (n) and outputs (n, size) by the function of one factor."""
    function = demo.library[f"demo_{kernel.name}{demo.variant.one}"]
    dtype = demo.variant.dtype
    rows = [
        call_c(function, kernel.jacobians, {k: v[i] for k, v in values.items()}, dtype=dtype)
        for i in range(n)
    ]
    stacked = {
        p.name: np.array([outputs[p.name].ravel() for _, outputs in rows], dtype).reshape(n, p.size)
        for p in kernel.jacobians.outputs
    }
    return np.array([code for code, _ in rows], dtype=int), stacked


def same(kernel: Kernel, got: np.ndarray, wanted: np.ndarray) -> None:
    """Equal to the last bit, or to a few where an elementary function is the batch's own; NaN equals NaN."""
    if OWN & kernel.jacobians.op_counts().keys():
        few = 4.5 * float(np.finfo(wanted.dtype).eps)
        np.testing.assert_allclose(got, wanted, rtol=few, atol=few)
        return
    np.testing.assert_array_equal(got, wanted)
    numbers = ~np.isnan(wanted)
    np.testing.assert_array_equal(np.signbit(got[numbers]), np.signbit(wanted[numbers]))


@KERNELS
def test_any_n(demo: Demo, kernel: Kernel) -> None:
    for n in (*range(18), 64, 65):
        values = samples(kernel, n, (max(n, 1),))
        status, wanted = one_by_one(demo, kernel, values, n)
        code, got, bits = demo.batch(kernel, values, n)
        assert code == int(np.bitwise_or.reduce(status, initial=0))
        np.testing.assert_array_equal(bits, status)
        for name, array in wanted.items():
            same(kernel, got[name], array)


@KERNELS
def test_any_layout(demo: Demo, kernel: Kernel) -> None:
    values = samples(kernel, 1, (N,))
    _, wanted = one_by_one(demo, kernel, values, N)
    for into in LAYOUTS:
        for outof in LAYOUTS:
            _, got, _ = demo.batch(kernel, values, N, into=into, outof=outof)
            for name, array in wanted.items():
                same(kernel, got[name], array)


@KERNELS
def test_any_output_may_be_null(demo: Demo, kernel: Kernel) -> None:
    values = samples(kernel, 2, (N,))
    names = [p.name for p in kernel.jacobians.outputs]
    _, everything, bits = demo.batch(kernel, values, N)
    for wanted in ([], *([name] for name in names), names[1:]):
        _, got, status = demo.batch(kernel, values, N, wanted=wanted)
        assert list(got) == wanted
        np.testing.assert_array_equal(status, bits)
        for name in wanted:
            np.testing.assert_array_equal(got[name], everything[name])


@KERNELS
def test_index_and_broadcast(demo: Demo, kernel: Kernel) -> None:
    rng = np.random.default_rng(3)
    values = samples(kernel, 3, (5,))
    first, *others = [a.name for a in kernel.arguments]
    index = {name: rng.integers(0, 5, N) for name in others}
    gathered = {first: np.repeat(values[first][:1], N, axis=0)} | {k: values[k][i] for k, i in index.items()}
    _, wanted = one_by_one(demo, kernel, gathered, N)
    for outof in (PACKED, LAYOUTS[3]):
        _, got, _ = demo.batch(kernel, values, N, outof=outof, index=index, broadcast=[first])
        for name, array in wanted.items():
            same(kernel, got[name], array)


def test_arguments_may_be_named_as_variables_of_the_batch(tmp_path: Path) -> None:
    kernel = bearing_range()
    names = dict(zip((a.name for a in kernel.arguments), ("n", "stream", "held"), strict=True))

    def renamed(program: Program) -> Program:
        inputs = tuple(replace(port, name=names[port.name]) for port in program.inputs)
        return replace(program, inputs=inputs)

    arguments = tuple(replace(a, name=names[a.name]) for a in kernel.arguments)
    value, jacobians = renamed(kernel.value), renamed(kernel.jacobians)
    other = replace(kernel, arguments=arguments, value=value, jacobians=jacobians)
    values = samples(kernel, 6, (N,))
    _, wanted, _ = call_batch(built([kernel], tmp_path / "a", []), kernel, values, N)
    _, got, _ = call_batch(
        built([other], tmp_path / "b", []), other, {names[k]: v for k, v in values.items()}, N
    )
    for name, array in wanted.items():
        np.testing.assert_array_equal(got[name], array)


def test_status_may_be_null(demo: Demo) -> None:
    kernel = next(k for k in examples() if k.value.requirements)
    values = samples(kernel, 4, (N,))
    code, _, status = demo.batch(kernel, values, N)
    assert code != 0
    assert 0 < np.count_nonzero(status) < N
    assert demo.batch(kernel, values, N, with_status=False)[0] == code


@pytest.mark.parametrize("below", [False, True])
def test_a_choice_between_conditions_is_the_same_without_select(below):
    """Where lanes are chosen by lanes, the arms are numbers: and, or, not choose between conditions."""
    b = Builder()
    x, y, z = (b.emit("input", (), float(k)) for k in range(3))
    one, two, which = (b.emit("lt", pair) for pair in ((x, y), (y, z), (x, z) if below else (z, x)))
    chosen = b.emit("select", (which, one, two))
    results = ((b.emit("select", (chosen, x, z)),),)
    program = Program("chosen", (Port("p", (3,)),), (Port("r", (1,)),), tuple(b.code), results)
    changed = without_chosen_conditions(program.validate()).validate()
    assert [ins.op for ins in changed.code].count("select") == 1
    for p in itertools.permutations((1.0, 2.0, 3.0)):
        assert changed.evaluate({"p": p})["r"] == program.evaluate({"p": p})["r"]
