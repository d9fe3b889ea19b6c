"""Layouts as maps: matrices and quaternions, there and back, at half turns too."""

import mpmath
import numpy as np
import pytest

from liegen import R3, SE2, SE3, SE23, SO2, SO3, Gal3, Layout, NavState, Product
from liegen.errors import DefinitionError
from liegen.layouts import LAYOUTS, OWN, storage, stored
from liegen.layouts.rotations import quaternion_of
from liegen.samples import Draw


class State(Product):
    pose: SE3
    velocity: R3
    heading: SO2


KINDS = (SO2, SE2, SO3, SE3, SE23, NavState, Gal3, State)


def drawn(manifold, count=20, seed=0):
    draw = Draw(np.random.default_rng(seed))
    return [draw.element(manifold) for _ in range(count)]


@pytest.mark.parametrize("name", LAYOUTS)
@pytest.mark.parametrize("manifold", KINDS, ids=lambda m: m.__name__)
def test_there_and_back(manifold, name):
    s = storage(manifold.form, LAYOUTS[name])
    assert len(set(s.names)) == s.size == int(np.prod(s.shape))
    for x in drawn(manifold):
        numbers = s.write(x.coords)
        assert len(numbers) == s.size
        back = np.array(s.read(numbers), dtype=float)
        for start in manifold.form.quaternions:  # q and -q are one rotation
            q = slice(start, start + 4)
            back[q] *= np.sign(back[q] @ np.asarray(x)[q])
        np.testing.assert_allclose(back, np.asarray(x), atol=5e-16, rtol=0)


@pytest.mark.parametrize("manifold", [SO2, SE2, SO3, SE3], ids=lambda m: m.__name__)
def test_matrices_are_those_of_the_group(manifold):
    n = 2 if manifold in (SO2, SE2) else 3
    for x in drawn(manifold):
        whole = x.matrix()
        upper = whole[:n]
        shown = {
            "4x4": whole.ravel(),
            "4x4-col": whole.ravel(order="F"),
            "3x4": upper.ravel(),
            "3x4-col": upper.ravel(order="F"),
            "matrix": np.concatenate([whole[:n, :n].ravel(), whole[:n, n:].ravel()]),
            "matrix-col": np.concatenate([whole[:n, :n].ravel(order="F"), whole[:n, n:].ravel()]),
        }
        for name, expected in shown.items():
            s = storage(manifold.form, LAYOUTS[name])
            np.testing.assert_array_equal(np.array(s.write(x.coords), dtype=float), expected, err_msg=name)


def test_the_order_of_numbers_is_that_of_the_libraries():
    q, t = [0.1, -0.7, 0.1, 0.7], [1.0, 2.0, 3.0]
    x, (qx, qy, qz, qw) = SE3.from_storage(q + t), q
    shown = {
        "symforce": [*q, *t],
        "sophus": [*q, *t],
        "manif": [*t, *q],
        "ceres": [qw, qx, qy, qz, *t],
        "g2o": [*t, *q],
        "ros": [*t, *q],
    }
    for name, expected in shown.items():
        assert list(storage(SE3.form, LAYOUTS[name]).write(x.coords)) == expected
    y = SE2.from_storage([np.cos(0.3), np.sin(0.3), 4.0, 5.0])
    for name in ("ceres", "g2o", "ros"):
        np.testing.assert_allclose(storage(SE2.form, LAYOUTS[name]).write(y.coords), [4, 5, 0.3], atol=1e-16)
    assert list(storage(SE2.form, LAYOUTS["manif"]).write(y.coords)) == [4, 5, *y.coords[:2]]


def exact_matrix(q):
    """The matrix of a quaternion at 50 digits, rounded to doubles."""
    with mpmath.workdps(50):
        x, y, z, w = (mpmath.mpf(float(c)) for c in q)
        n = x * x + y * y + z * z + w * w
        k = 2 / n
        rows = (
            (1 - k * (y * y + z * z), k * (x * y - w * z), k * (x * z + w * y)),
            (k * (x * y + w * z), 1 - k * (x * x + z * z), k * (y * z - w * x)),
            (k * (x * z - w * y), k * (y * z + w * x), 1 - k * (x * x + y * y)),
        )
        return tuple(tuple(float(e) for e in row) for row in rows)


def quaternions():
    rng = np.random.default_rng(7)
    axes = [*np.eye(3), *(-np.eye(3)), *rng.normal(size=(40, 3))]
    axes += [[1, 1, 0], [0, -1, 1], [1, 1, 1], [1e-9, 1, 0]]
    for axis in axes:
        u = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
        for angle in (0, 1e-300, 1e-12, 1e-3, 1, 2 * np.pi / 3, np.pi - 1e-3, np.pi - 1e-8, np.pi):
            w = 0.0 if angle == np.pi else np.cos(angle / 2)
            yield np.array([*(np.sin(angle / 2) * u), w])


def test_reading_a_matrix_is_accurate_everywhere():
    for q in quaternions():
        found = np.array(quaternion_of(exact_matrix(q)), dtype=float)
        assert np.isfinite(found).all()
        exact = q / np.linalg.norm(q)
        assert min(np.abs(found - exact).max(), np.abs(found + exact).max()) <= 6e-16, q


def test_the_identity_and_tiny_rotations_keep_their_digits():
    R = ((1.0, 0.0, 1e-200), (0.0, 1.0, 0.0), (-1e-200, 0.0, 1.0))
    np.testing.assert_allclose(quaternion_of(R), [0, 5e-201, 0, 1], rtol=1e-15, atol=0)


def test_own_storage_is_left_alone():
    for manifold in KINDS:
        s = storage(manifold.form, OWN)
        assert s.own
        assert s.names == manifold.form.storage


def test_what_does_not_exist_is_refused():
    with pytest.raises(DefinitionError, match=r"rotation='euler'\): rotation is one of 'xyzw', 'wxyz'"):
        Layout(rotation="euler")
    with pytest.raises(DefinitionError, match="f: unknown layout 'drake'; one of xyzw, wxyz, matrix"):
        stored("drake", "f")


def test_where_the_rotation_of_a_matrix_by_columns_stands():
    (places,) = storage(SE3.form, LAYOUTS["3x4-col"]).lengths
    assert sorted(places) == list(range(9))
    (places,) = storage(SE3.form, LAYOUTS["3x4"]).lengths
    assert sorted(places) == [0, 1, 2, 4, 5, 6, 8, 9, 10]


def test_an_angle_needs_no_unit_length():
    angle = storage(SE2.form, LAYOUTS["g2o"])
    assert (angle.units, angle.lengths) == ((), ())
