"""Compiled factors: values, shapes, strides, dtypes, errors, on C and on NumPy code."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from runtime_factors import (
    FACTORS,
    arguments,
    between,
    rotated,
    scrambled,
    step,
    swapped,
)
from runtime_tools import close, results
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

# --- values -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(), (1,), (2, 3), (19,)])
@pytest.mark.parametrize("factor", FACTORS, ids=lambda f: f.name)
def test_same_values_as_the_formula(compiled, factor, shape):
    k = compiled(factor)
    variables, given = arguments(factor, shape)
    kernel = factor.kernel
    named = dict(zip([a.name for a in kernel.positional], variables, strict=True)) | given
    flat = {a.name: np.moveaxis(named[a.name].reshape(*shape, -1), -1, 0) for a in kernel.arguments}
    programs = [("value", kernel.value)] + ([("jacobians", kernel.jacobians)] if kernel.variables else [])
    for method, program in programs:
        expected = program.evaluate({name: tuple(a) for name, a in flat.items()})
        made = results(k.calls[method](*variables, **given))
        assert len(made) == len(program.outputs)
        for port, array in zip(program.outputs, made, strict=True):
            stacked = np.stack(
                np.broadcast_arrays(*expected[port.name], flat[kernel.arguments[0].name][0])[:-1], -1
            )
            assert array.shape == (*shape, *port.shape)
            np.testing.assert_allclose(array, stacked.reshape(*shape, *port.shape), rtol=1e-11, atol=1e-12)


def matrix(pose):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_quat(pose[:4]).as_matrix(), pose[4:]
    return T


def test_between_by_its_definition(compiled):
    (x, y), given = arguments(between, (5,))
    r = compiled(between)(x, y, **given)
    for k in range(5):
        w, v = r[k, :3], r[k, 3:]
        hat = np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0] * 4])
        relative = np.linalg.solve(matrix(x[k]), matrix(y[k]))
        np.testing.assert_allclose(matrix(given["z"][k]) @ expm(hat), relative, atol=1e-12)


def test_arguments_are_called_in_the_order_of_the_call(compiled):
    k = compiled(swapped)
    assert str(inspect.signature(k)) == "(b, c, *, a, out=None)"
    np.testing.assert_allclose(k([1.0, 2], [5.0, 0, 0], a=[3.0]), [3, 6, 5, 10])
    np.testing.assert_allclose(compiled(scrambled)([3.0], [1.0, 2], c=[5.0, 0, 0]), [3, 6, 5, 10])


def test_jacobians_are_a_named_tuple(compiled):
    variables, given = arguments(between, (4,))
    made = compiled(between).jacobians(*variables, **given)
    assert type(made).__name__ == "BetweenSe3Jacobians"
    assert made._fields == ("res", "res_D_x", "res_D_y")
    assert made.res_D_y.shape == (4, 6, 6)
    outputs = compiled(step)(*arguments(step)[0], **arguments(step)[1])
    assert outputs._fields == ("R_new", "p_new")


def test_without_variables_there_are_no_jacobians(compiled):
    k = compiled(next(f for f in FACTORS if f.name == "so3_Jr"))
    assert k(np.zeros(3)).tolist() == np.eye(3).tolist()
    with pytest.raises(AttributeError, match="so3_Jr has no jacobians"):
        k.jacobians  # noqa: B018


# --- shapes, strides, types -------------------------------------------------------------------------------


def test_broadcasting(compiled):
    k = compiled(between)
    (x, y), given = arguments(between, (3, 4))
    z = given["z"]
    made = k.jacobians(x[:, :1], y[0], z=z[0, 0])
    for i in range(3):
        for j in range(4):
            close([a[i, j] for a in made], k.jacobians(x[i, 0], y[0, j], z=z[0, 0]))


@pytest.mark.parametrize("shape", [(0,), (3, 0), (0, 2)])
def test_empty_arrays(compiled, shape):
    variables, given = arguments(between, shape)
    k = compiled(between)
    made = k.jacobians(*variables, **given)
    assert [a.shape for a in made] == [(*shape, 6), (*shape, 6, 6), (*shape, 6, 6)]
    assert k.status(*variables, **given).shape == shape


def structured(a):
    """A field of a record: steps that are no multiple of the item's size, and not aligned."""
    made = np.zeros(len(a), dtype=[("tag", "u1"), ("pose", "f8", 7)])
    made["pose"] = a
    return made["pose"]


LAYOUTS = {
    "columns first": np.asfortranarray,
    "every other": lambda a: np.repeat(a, 2, axis=0)[::2],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "numbers backwards": lambda a: a[:, ::-1].copy()[:, ::-1],
    "wide rows": lambda a: np.hstack([a, a])[:, :7],
    "strided numbers": lambda a: np.repeat(a, 3, axis=1)[:, ::3],
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "unaligned": structured,
    "read-only": lambda a: np.frombuffer(a.tobytes()).reshape(a.shape),
    "list": lambda a: a.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_of_inputs(compiled, layout):
    k = compiled(between)
    (x, y), given = arguments(between, (11,))
    arranged = [LAYOUTS[layout](a) for a in (x, y, given["z"])]
    close(k.jacobians(*arranged[:2], z=arranged[2]), k.jacobians(x, y, z=given["z"]))


def test_inputs_whose_numbers_are_one_number(compiled):
    k = compiled(between)
    (x, _), given = arguments(between, (5,))
    same = np.broadcast_to(0.5, (5, 7))
    close(k.jacobians(x, same, z=given["z"]), k.jacobians(x, same.copy(), z=given["z"]))


@pytest.mark.parametrize(
    "layout", ["packed", "columns first", "transposed blocks", "backwards", "wide", "record"]
)
def test_any_layout_of_outputs(compiled, layout):
    k = compiled(between)
    variables, given = arguments(between, (5,))
    shapes = [(5, 6), (5, 6, 6), (5, 6, 6)]
    record = np.zeros(5, [("tag", "u1"), ("a", "f8", 6), ("b", "f8", (6, 6)), ("c", "f8", (6, 6))])
    out = {
        "packed": tuple(map(np.empty, shapes)),
        "columns first": tuple(np.empty(s, order="F") for s in shapes),
        "transposed blocks": tuple(np.swapaxes(np.empty(s), 1, -1) for s in shapes),
        "backwards": tuple(np.empty(s)[::-1] for s in shapes),
        "wide": tuple(np.empty((*s[:-1], 12))[..., ::2] for s in shapes),
        "record": (record["a"], record["b"], record["c"]),
    }[layout]
    made = k.jacobians(*variables, **given, out=out)
    assert all(a is b for a, b in zip(made, out, strict=True))
    close(out, k.jacobians(*variables, **given))


def test_an_output_may_be_an_input(compiled):
    (R, p), _ = arguments(rotated, (30,))
    k = compiled(rotated)
    expected = k(R, p)
    assert k(R, p, out=p) is p
    close(p, expected)


def test_one_output_of_several_may_be_given(compiled):
    k = compiled(between)
    variables, given = arguments(between, (3,))
    D = np.empty((3, 6, 6))
    made = k.jacobians(*variables, **given, out=(None, D, None))
    assert made.res_D_x is D
    close(made, k.jacobians(*variables, **given))


def test_numbers_of_other_types(compiled):
    k = compiled(rotated)
    R, p = [0, 0, 0, 1], [1, 2, 3]
    for made in (k(R, p), k(np.array(R, dtype=np.int64), p), k(np.array(R) != 0, p)):
        assert made.dtype == np.float64
        assert made.tolist() == [1, 2, 3]
    with pytest.raises(TypeError, match=r"argument R: .* of real numbers, got complex numbers"):
        k(np.array(R) * 1j, p)
    with pytest.raises(TypeError, match=r"argument R: .* of real numbers, got text"):
        k(["a", "b", "c", "d"], p)


def test_single_precision(compiled):
    k = compiled(between)
    (x, y), given = arguments(between, (9,))
    single = [a.astype(np.float32) for a in (x, y, given["z"])]
    double = [a.astype(np.float64) for a in single]
    for size in (slice(None), 0):  # a batch, one element
        made = k.jacobians(*(a[size] for a in single[:2]), z=single[2][size])
        exact = k.jacobians(*(a[size] for a in double[:2]), z=double[2][size])
        largest = max(1.0, *(float(np.abs(array[size]).max()) for array in double))
        for a, b in zip(made, exact, strict=True):
            assert a.dtype == np.float32
            scale = max(largest, float(np.abs(b).max()))
            np.testing.assert_allclose(a, b, rtol=0, atol=16 * np.finfo(np.float32).eps * scale)
        rounded = all(np.array_equal(a, b.astype(np.float32)) for a, b in zip(made, exact, strict=True))
        assert rounded == (k.backend == "numpy")  # there in double, rounded once
    assert k(x, single[1], z=single[2]).dtype == np.float64
    out = np.empty((9, 6), dtype=np.float32)
    close(k(*single[:2], z=single[2], out=out), k(*single[:2], z=single[2]))
    e = k.indexed(x=[4, 2], z=[0, 1])
    made = e(single[0], single[1][:2], z=single[2])
    assert made.dtype == np.float32
    np.testing.assert_array_equal(made, k(single[0][[4, 2]], single[1][:2], z=single[2][:2]))


def test_wrong_shapes_name_function_and_argument(compiled):
    k = compiled(between)
    good = np.zeros((4, 7))
    with pytest.raises(
        ValueError, match=r"between_se3_jacobians: argument y: expected shape \(\.\.\., 7\), got \(4, 6\)"
    ):
        k.jacobians(good, np.zeros((4, 6)), z=good)
    with pytest.raises(ValueError, match=r"do not broadcast: x \(4,\), y \(3,\), z \(4,\)"):
        k(good, np.zeros((3, 7)), z=good)
    with pytest.raises(ValueError, match=r"between_se3: argument y: expected shape .*, got \(\)"):
        k(good, 1.0, z=good)
    with pytest.raises(ValueError, match=r"between_se3: argument z: .* a list whose rows differ in length"):
        k(good, good, z=[[1, 2], [3]])
    with pytest.raises(ValueError, match=r"[Oo]utput|broadcast"):
        k(good, good, z=good, out=np.empty((4, 5)))
    with pytest.raises((ValueError, TypeError), match="out"):
        k.jacobians(good, good, z=good, out=(np.empty((4, 6)),))
