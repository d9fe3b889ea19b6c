"""``R.matrix()`` in a formula multiplies as the matrix of numbers does."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from liegen import R2, R3, SO2, SO3, factor
from liegen.errors import DefinitionError

rng = np.random.default_rng(3)
A, B = Rotation.random(random_state=1), Rotation.random(random_state=2)
V = rng.normal(size=3)


@factor
def products(a: SO3, b: SO3, v: R3):
    R, S = a.matrix(), b.matrix()
    return R @ v + (R.T @ S) @ v + v @ S + S.transpose() @ (R @ v)


def expected(R, S, v):
    return R @ v + R.T @ S @ v + v @ S + S.T @ R @ v


def test_values_and_jacobians():
    a, b = SO3.from_storage(A.as_quat()), SO3.from_storage(B.as_quat())
    R, S = A.as_matrix(), B.as_matrix()
    found = products.jacobians(a, b, V)
    np.testing.assert_allclose(found["res"], expected(R, S, V), rtol=0, atol=1e-14)
    step = 1e-6
    for k, e in enumerate(np.eye(3) * step):
        turn = Rotation.from_rotvec(e).as_matrix()
        differences = {
            "a": expected(R @ turn, S, V) - expected(R @ turn.T, S, V),
            "b": expected(R, S @ turn, V) - expected(R, S @ turn.T, V),
            "v": expected(R, S, V + e) - expected(R, S, V - e),
        }
        for name, difference in differences.items():
            np.testing.assert_allclose(
                found[f"res_D_{name}"][:, k], difference / (2 * step), rtol=0, atol=1e-9
            )


def test_it_costs_what_rotating_costs():
    @factor
    def with_matrix(a: SO3, v: R3, *, z: R3):
        return a.matrix().T @ v - z

    @factor
    def without(a: SO3, v: R3, *, z: R3):
        return a.unrotate(v) - z

    assert with_matrix.kernel.jacobians.operations == without.kernel.jacobians.operations


def test_in_the_plane():
    @factor
    def turned(a: SO2, v: R2):
        return a.matrix() @ v

    np.testing.assert_allclose(
        np.asarray(turned(SO2.exp(0.3), [1.0, 0.0])), [np.cos(0.3), np.sin(0.3)], rtol=0, atol=1e-15
    )


@pytest.mark.parametrize("body", ["np.asarray(a.matrix())", "np.linalg.inv(a.matrix()) @ v"])
def test_its_numbers_cannot_be_read(body):
    space = {"np": np, "SO3": SO3, "R3": R3}
    exec(f"def f(a: SO3, v: R3):\n    return {body}", space)
    with pytest.raises(DefinitionError, match=r"<string>:2: f: cannot turn the matrix of a \(SO3\)"):
        factor(space["f"])


def test_numbers_have_an_array():
    matrix = SO3.from_storage(A.as_quat()).matrix()
    assert isinstance(matrix, np.ndarray)
    np.testing.assert_allclose(matrix, A.as_matrix(), rtol=0, atol=1e-15)
