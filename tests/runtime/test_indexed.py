"""Index arrays: an edge list gathers its poses from the array of all poses."""

from __future__ import annotations

import gc
import pickle

import numpy as np
import pytest
from runtime_factors import arguments, between, pixel, robust, rotated

import liegen
from compiler_tools import needs_compiler
from liegen.runtime import compiled as module

N, EDGES = 12, 31


@pytest.fixture
def edges():
    rng = np.random.default_rng(7)
    return rng.integers(0, N, EDGES), rng.integers(0, N, EDGES)


def poses(seed=3):
    return arguments(between, (N,), seed)[0][0]


def close(a, b):
    for u, v in zip(a, b, strict=True):
        np.testing.assert_allclose(u, v, rtol=1e-11, atol=1e-12)


def test_same_as_gathering(compiled, edges):
    i, j = edges
    k, x = compiled(between), poses()
    z = arguments(between, (EDGES,))[1]["z"]
    e = k.indexed(x=i, y=j)
    close([e(x, x, z=z)], [k(x[i], x[j], z=z)])
    made = e.jacobians(x, x, z=z)
    assert made._fields == ("res", "res_D_x", "res_D_y")
    close(made, k.jacobians(x[i], x[j], z=z))
    close(e.jacobians(x, x, z=z[0]), k.jacobians(x[i], x[j], z=z[0]))
    close(e.jacobians(x, x, z=z[:1]), k.jacobians(x[i], x[j], z=z[0]))
    only = k.indexed(z=j)
    y = arguments(between, (EDGES,), 5)[0]
    close(only.jacobians(*y, z=x), k.jacobians(*y, z=x[j]))


def test_matrices_and_single_numbers(compiled, edges):
    i, j = edges
    k, x = compiled(robust), poses()
    given = arguments(robust, (EDGES,))[1]
    close(k.indexed(x=i, y=j).jacobians(x, x, **given), k.jacobians(x[i], x[j], **given))
    given["sqrt_info"] = given["sqrt_info"][:5]
    which = np.arange(EDGES) % 5
    gathered = k.indexed(x=i, y=j, sqrt_info=which).jacobians(x, x, **given)
    close(gathered, k.jacobians(x[i], x[j], **{**given, "sqrt_info": given["sqrt_info"][which]}))
    turned = np.swapaxes(np.swapaxes(given["sqrt_info"], 1, 2).copy(), 1, 2)  # column-major
    close(k.indexed(x=i, y=j, sqrt_info=which).jacobians(x, x, **{**given, "sqrt_info": turned}), gathered)


@needs_compiler
def test_usual_arrays_take_the_short_way(monkeypatch, edges):
    def unusual(*_):
        def evaluate(*_, out=None):
            raise AssertionError("the long way")

        return evaluate

    i, j = edges
    k, x = liegen.compile(robust), poses()
    given = arguments(robust, (EDGES,))[1]
    expected = k.jacobians(x[i], x[j], **given)
    monkeypatch.setattr(module, "batch_evaluator", unusual)
    e = k.indexed(x=i, y=j)
    gc.collect()  # what NumPy points to lives on
    close(e.jacobians(x, x, **given), expected)
    close([e(x, x, **given)], expected[:1])
    close(k.indexed(x=i).jacobians(x, x[j], **given), expected)
    blocks, res = np.empty((EDGES, 2, 6, 6)), np.empty((EDGES, 8))[:, 1:7]
    made = e.jacobians(x, x, **given, out=(res, blocks[:, 0], blocks[:, 1]))
    assert made.res is res
    close([res, blocks[:, 0], blocks[:, 1]], expected)
    for wrong in (x[:, ::-1], x.astype(np.float32), x[: i.max()], x[None]):
        with pytest.raises(AssertionError, match="the long way"):
            e(wrong, x, **given)
    for wrong in (np.empty((EDGES, 6), np.float32), np.empty((EDGES + 1, 6)), [None]):
        with pytest.raises(AssertionError, match="the long way"):
            e(x, x, **given, out=wrong)


@pytest.mark.parametrize("change", [
    np.asfortranarray, lambda a: np.repeat(a, 2, axis=1)[:, ::2], lambda a: a[::-1].copy()[::-1],
    lambda a: a.astype(">f8"), lambda a: a.tolist(),
])  # fmt: skip
def test_any_layout(compiled, edges, change):
    i, j = edges
    k, x = compiled(between), poses()
    z = arguments(between, (EDGES,))[1]["z"]
    e = k.indexed(x=i.astype(np.uint8), y=j.tolist())
    close(e.jacobians(change(x), change(x), z=change(z)), k.jacobians(x[i], x[j], z=z))


def test_outputs(compiled, edges):
    i, j = edges
    k, x = compiled(between), poses()
    z = arguments(between, (EDGES,))[1]["z"]
    e = k.indexed(x=i, y=j)
    expected = e.jacobians(x, x, z=z)
    for order in "CF":
        out = tuple(np.empty(a.shape, order=order) for a in expected)
        made = e.jacobians(x, x, z=z, out=out)
        assert all(a is b for a, b in zip(made, out, strict=True))
        close(out, expected)
    blocks = np.empty(
        (EDGES, 2, 6, 6)
    )  # the blocks of an edge beside each other, as a block matrix stores them
    e.jacobians(x, x, z=z, out=(None, blocks[:, 0], blocks[:, 1]))
    close([blocks[:, 0], blocks[:, 1]], expected[1:])
    with pytest.raises(ValueError, match="out must hold 3 arrays, one for each result, got 1"):
        e.jacobians(x, x, z=z, out=blocks)
    with pytest.raises(ValueError, match="broadcast"):
        e(x, x, z=z, out=np.empty((EDGES, 5)))
    turned = k.indexed(x=np.arange(N)) if k.name == "rotated" else compiled(rotated).indexed(R=[0] * N)
    p = arguments(rotated, (N,))[0][1]
    expected = compiled(rotated)(x[0, :4], p)
    turned(x[:, :4], p, out=p)  # an output may be an input
    close([p], [expected])


def test_no_factors(compiled):
    k, x = compiled(between), poses()
    e = k.indexed(x=[], y=[])
    assert [a.shape for a in e.jacobians(x, x, z=x[0])] == [(0, 6), (0, 6, 6), (0, 6, 6)]
    assert e(x[:0], x[:0], z=np.empty((0, 7))).shape == (0, 6)


def test_status_and_domain(compiled):
    k = compiled(pixel)
    x = np.array([[0.0, 0, 0, 1, 0, 0, 0], [0.0, 0, 0, 1, 0, 0, 10]])
    p = np.array([[0.0, 0, 5], [0, 0, 55]])
    e = k.indexed(x=[0, 1, 0, 1], p=[0, 0, 1, 1])
    assert e.status(x, p, z=[0.0, 0]).tolist() == [0, 1, 2, 0]
    assert np.isnan(e.jacobians(x, p, z=[0.0, 0]).res_D_x).all(axis=(1, 2)).tolist() == [
        False,
        True,
        True,
        False,
    ]


def test_a_wrong_index_is_an_error(compiled):
    k, x = compiled(between), poses()
    z = np.zeros((2, 7))
    with pytest.raises(IndexError, match="between_se3: the index of y holds -1"):
        k.indexed(x=[0, 1], y=[0, -1])
    with pytest.raises(IndexError, match="index of x holds 4294967296"):
        k.indexed(x=[0, 2**32])
    e = k.indexed(x=[0, 1], y=[0, N])
    for call in (e, e.jacobians):
        with pytest.raises(IndexError, match=f"between_se3.*: the index of y holds {N}, but y has {N} el"):
            call(x, x, z=z)
    with pytest.raises(TypeError, match="index of x must hold integers, got float64"):
        k.indexed(x=[0.5, 1])
    with pytest.raises(TypeError, match="index of x must hold integers, got bool"):
        k.indexed(x=[True, False])
    with pytest.raises(ValueError, match=r"one length: x 2, y 3"):
        k.indexed(x=[0, 1], y=[0, 1, 2])
    with pytest.raises(ValueError, match=r"index of x must have one dimension, its shape is \(1, 2\)"):
        k.indexed(x=[[0, 1]])
    with pytest.raises(TypeError, match="no argument 'w'; it has x, y, z"):
        k.indexed(w=[0])
    with pytest.raises(TypeError, match="give an index array"):
        k.indexed()


def test_wrong_shapes_and_types(compiled):
    k, x = compiled(between), poses()
    e = k.indexed(x=[0, 1], y=[0, 2])
    good = np.zeros((2, 7))
    with pytest.raises(ValueError, match=r"argument x is indexed: expected shape \(N, 7\), got \(7,\)"):
        e(x[0], x, z=good)
    with pytest.raises(ValueError, match=r"argument x is indexed: expected shape \(N, 7\), got \(12, 6\)"):
        e(x[:, :6], x, z=good)
    for wrong in (np.zeros((3, 7)), np.zeros((2, 6)), np.zeros(()), np.zeros((1, 2, 7))):
        with pytest.raises(ValueError, match=r"argument z: expected shape \(2, 7\) or \(7\), got"):
            e(x, x, z=wrong)
    with pytest.raises(TypeError):
        e(x * 1j, x, z=good)
    with pytest.raises(TypeError, match="missing z; call it as between_se3"):
        e(x, x)


def test_later_changes_of_the_index_change_nothing(compiled):
    i = np.array([0, 1])
    k, x = compiled(between), poses()
    e = k.indexed(x=i, y=[1, 2])
    before = e(x, x, z=x[0])
    i[:] = 10**6
    close([e(x, x, z=x[0])], [before])
    assert repr(e) == "<between_se3, 2 factors by the index of x, y>"
    again = pickle.loads(pickle.dumps(e.jacobians))
    close(again(x, x, z=x[0]), e.jacobians(x, x, z=x[0]))
