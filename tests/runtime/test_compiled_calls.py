"""Compiled factors: names of arguments, typed values, domains, threads."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from runtime_factors import (
    arguments,
    between,
    drift,
    pixel,
    quotient,
    rotated,
)
from runtime_tools import close

import liegen
from compiler_tools import needs_compiler
from liegen import R3, SE3, SO3, DefinitionError

# --- the call ---------------------------------------------------------------------------------------------


def test_names_of_arguments(compiled):
    k = compiled(between)
    (x, y), given = arguments(between)
    z = given["z"]
    close(k(x=x, y=y, z=z), k(x, y, z=z))
    close(k(x, z=z, y=y), k(x, y, z=z))
    usage = r"call it as between_se3\(x, y, z=\)"
    for positional, named, problem in (
        ((x, y), {}, "missing z"),
        ((x,), {"z": z}, "missing y"),
        ((x, y, z), {}, "missing z"),
        ((x, y), {"w": z}, "missing z; unknown w"),
        ((x, y), {"z": z, "w": z}, "unknown w"),
        ((x, y), {"z": z, "x": x}, "given twice x"),
        ((x, y, z), {"z": z}, "3 positional arguments"),
    ):
        with pytest.raises(TypeError, match=f"between_se3: {problem}; {usage}"):
            k(*positional, **named)


def test_typed_values(compiled):
    (x, y), given = arguments(between)
    k = compiled(between)
    typed = [SE3.from_storage(a) for a in (x, y, given["z"])]
    close(k.jacobians(*typed[:2], z=typed[2]), k.jacobians(x, y, **given))
    close(k(typed[0], y, z=given["z"]), k(x, y, **given))
    with pytest.raises(DefinitionError, match="between_se3: argument 'y' must be SE3, got SO3"):
        k(typed[0], SO3.from_storage(y[:4]), z=typed[2])
    body = np.concatenate([x, [1.0, 2, 3]])
    close(compiled(drift)(drift.declared[0].manifold.from_storage(body), b=body), np.zeros(9))


def test_text(compiled):
    k = compiled(between)
    assert repr(k).startswith("<compiled between_se3(x, y, *, z, out=None) (7),(7),(7)->(6), ")
    assert "x: (..., 7) SE3" in k.__doc__
    assert "res_D_x: (..., 6, 6)" in k.jacobians.__doc__
    assert "res_D_x" not in k.__doc__
    assert k.backend in ("c", "numpy")
    with pytest.raises(DefinitionError, match="needs a @factor or @function, got function"):
        liegen.compile(lambda x: x)
    with pytest.raises(DefinitionError, match="backend is 'c' or 'numpy', got 'rust'"):
        liegen.compile(between, backend="rust")


def test_outside_of_the_domain(compiled):
    k = compiled(pixel)
    x = np.array([0.0, 0, 0, 1, 0, 0, 0])
    p = np.array([[0.0, 0, 2], [0, 0, -1], [0, 0, 60], [0, 0, 5]])
    with np.errstate(all="raise"):
        made = k.jacobians(x, p, z=np.zeros(2))
    assert np.isnan(made.res).all(axis=-1).tolist() == [False, True, True, False]
    assert np.isnan(made.res_D_p).all(axis=(-1, -2)).tolist() == [False, True, True, False]
    assert not np.isnan(made.res_D_x[[0, 3]]).any()
    assert k.status(x, p, z=np.zeros(2)).tolist() == [0, 1, 2, 0]
    assert k.status(x, p[1], z=np.zeros(2)) == 1
    assert np.isnan(k.jacobians(x, p[1], z=np.zeros(2)).res_D_x).all()
    assert k.requirements == ("point behind the camera", "point too far away")


def test_no_warnings_of_floating_point(compiled):
    k = compiled(quotient)
    with np.errstate(all="raise"):
        for shape in ((), (3,)):
            b = np.broadcast_to([0.0, 2.0], (*shape, 2))
            made = k.jacobians(np.ones((*shape, 2)), b=b)
            assert np.isinf(made.res[..., 0]).all()
            assert (made.res[..., 1] == 0.5).all()


def test_values_that_python_refuses_are_those_of_arrays(compiled):
    k = compiled(quotient)
    assert k([1.0, -1.0], b=[0.0, 0.0]).tolist() == [np.inf, -np.inf]
    assert np.isnan(k([0.0, 1.0], b=[0.0, 1.0])[0])


# --- threads ----------------------------------------------------------------------------------------------


@needs_compiler
def test_the_lock_is_released():
    k = liegen.compile(between, backend="c")
    n = 400_000
    x = np.broadcast_to(0.5, (n, 7))  # one number for all: the slowest way in
    out = np.ones((n, 6))
    span: list[float] = []

    def run():
        span.append(time.perf_counter())
        k(x, x, z=x, out=out)
        span.append(time.perf_counter())

    thread = threading.Thread(target=run)
    thread.start()
    beats: list[float] = []
    while len(span) < 2:
        time.sleep(1e-4)
        beats.append(time.perf_counter())
    thread.join()
    # Were the lock held, this thread would stand still from the start of the call to its end.
    assert sum(span[0] < beat < span[1] for beat in beats) >= 5


def test_several_threads_at_once(compiled):
    k = compiled(rotated)
    (R, p), _ = arguments(rotated, (50,))
    expected, made = k(R, p), [None] * 4

    def run(i):
        for _ in range(20):
            made[i] = k(SO3.from_storage(R), R3.from_storage(p))

    threads = [threading.Thread(target=run, args=(i,)) for i in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    for m in made:
        close(m, expected)
