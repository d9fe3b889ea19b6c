"""Layouts against the libraries whose names they bear, where these are installed."""

import numpy as np
import pytest

from liegen import SE2, SE3, SO3
from liegen.layouts import LAYOUTS, storage
from liegen.library import between_se3, prior_so3
from liegen.samples import Draw


def poses(manifold, count=3):
    draw = Draw(np.random.default_rng(3))
    return [draw.element(manifold) for _ in range(count)]


def test_gtsam():
    gtsam = pytest.importorskip("gtsam")
    x, y, z = poses(SE3)
    X, Y, Z = (gtsam.Pose3(p.matrix()) for p in (x, y, z))
    f = between_se3.in_layout("gtsam")
    found = f.jacobians(X.matrix(), Y.matrix(), z=Z.matrix())
    np.testing.assert_allclose(found["res"], gtsam.Pose3.Logmap(Z.between(X.between(Y))), atol=1e-12)
    p = poses(SE2)[0]
    matrix = gtsam.Pose2(float(p.coords[2]), float(p.coords[3]), float(p.rotation.log().coords[0])).matrix()
    numbers = storage(SE2.form, LAYOUTS["gtsam"]).write(p.coords)
    np.testing.assert_allclose(np.array(numbers).reshape(3, 3), matrix, atol=1e-15)


def test_scipy():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    a, b = rotation.random(2, random_state=5)
    expected = (b.inv() * a).as_rotvec()
    for layout, numbers in (("xyzw", rotation.as_quat), ("matrix", rotation.as_matrix)):
        found = prior_so3.in_layout(layout)(numbers(a), z=numbers(b))
        np.testing.assert_allclose(np.asarray(found), expected, atol=1e-14)


def test_symforce():
    sf = pytest.importorskip("symforce.symbolic")
    x = poses(SE3)[0]
    numbers = storage(SE3.form, LAYOUTS["symforce"]).write(x.coords)
    pose = sf.Pose3.from_storage([float(c) for c in numbers])
    shown = np.array(pose.to_homogenous_matrix().to_numpy(), dtype=float)
    np.testing.assert_allclose(shown, x.matrix(), atol=1e-14)


def test_storage_of_a_rotation_alone():
    (x,) = poses(SO3, 1)
    assert storage(SO3.form, LAYOUTS["ceres"]).names == ("qw", "qx", "qy", "qz")
    np.testing.assert_array_equal(
        np.array(storage(SO3.form, LAYOUTS["4x4"]).write(x.coords)).reshape(3, 3), x.matrix()
    )
