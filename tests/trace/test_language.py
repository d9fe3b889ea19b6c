"""The language of a residual: what a NumPy user expects of typed vectors, on numbers and in a factor."""

import numpy as np
import pytest

import liegen
from liegen import R1, R2, R3, SE2, SE3, SO3, factor, function, norm, outputs, require, stack
from liegen.errors import DefinitionError
from liegen.trace import formula

A, B = R3(1.0, -2.0, 0.5), R3(0.25, 4.0, -3.0)
a, b = np.asarray(A), np.asarray(B)
M = np.array([[1.0, 0.0, 2.0], [0.5, -1.0, 0.0]])

EXPRESSIONS = {
    "add": (lambda x, y: x + y, a + b),
    "sub": (lambda x, y: x - y, a - b),
    "mul": (lambda x, y: x * y, a * b),
    "div": (lambda x, y: x / y, a / b),
    "neg": (lambda x, y: -x, -a),
    "scalar": (lambda x, y: 2 * x + y * 0.5 - 1 + 3 / y, 2 * a + b * 0.5 - 1 + 3 / b),
    "component": (lambda x, y: x[1] * y, a[1] * b),
    "negative index": (lambda x, y: x[-1] + y, a[-1] + b),
    "slice": (lambda x, y: x[:2] / y[2], a[:2] / b[2]),
    "step": (lambda x, y: x[::2] - y[::-2], a[::2] - b[::-2]),
    "matrix": (lambda x, y: M @ x, M @ a),
    "array on the left": (lambda x, y: np.array([1.0, 2.0, 3.0]) * x - b, np.array([1.0, 2.0, 3.0]) * a - b),
    "power": (lambda x, y: x**3 + y**1 + x**0, a**3 + b + 1),
    "stack": (lambda x, y: stack(x[:2], 1, y), np.hstack([a[:2], 1, b])),
    "dot": (lambda x, y: liegen.dot(x, y), a @ b),
    "cross": (lambda x, y: liegen.cross(x, y), np.cross(a, b)),
    "norm": (lambda x, y: norm(x - y), np.linalg.norm(a - b)),
    "abs": (lambda x, y: liegen.abs(x) + abs(y), np.abs(a) + np.abs(b)),
    "minimum": (lambda x, y: liegen.minimum(x, y), np.minimum(a, b)),
    "maximum": (lambda x, y: liegen.maximum(x, 0.0), np.maximum(a, 0)),
    "where": (lambda x, y: liegen.where(x[0] > y[0], x, y), a),
    "where scalar": (lambda x, y: liegen.where((x[0] < y[0]) | ~(y[1] >= 3.0), x, 7.0), np.full(3, 7.0)),
    "functions": (
        lambda x, y: liegen.sin(x) * liegen.cos(y) + liegen.tan(x) - liegen.exp(y) + liegen.sqrt(abs(x)),
        np.sin(a) * np.cos(b) + np.tan(a) - np.exp(b) + np.sqrt(np.abs(a)),
    ),
    "inverse functions": (
        lambda x, y: liegen.asin(x / 3) + liegen.acos(y / 5) + liegen.log(abs(y)),
        np.arcsin(a / 3) + np.arccos(b / 5) + np.log(np.abs(b)),
    ),
    "atan2": (lambda x, y: liegen.atan2(x[1], y[2]), np.arctan2(a[1], b[2])),
}


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_vectors_compute_as_numpy_does(name):
    build, expected = EXPRESSIONS[name]
    np.testing.assert_allclose(np.ravel(build(A, B)), np.ravel(expected), rtol=4e-16, atol=1e-15)


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_traced_and_derived_they_give_the_same_and_the_right_slope(name):
    build, expected = EXPRESSIONS[name]

    @factor
    def f(x: R3, y: R3):
        return stack(build(x, y), 0.0 * (x + y))

    out = f.jacobians(A, B)
    n = np.size(expected)
    np.testing.assert_allclose(out["res"][:n], np.ravel(expected), rtol=4e-15, atol=1e-15)
    for key, at in (("res_D_x", 0), ("res_D_y", 1)):
        for k in range(3):
            h = np.eye(3)[k] * 1e-6
            low, high = ([A + s * h if at == 0 else A, B + s * h if at == 1 else B] for s in (-1, 1))
            slope = (np.ravel(build(*high)) - np.ravel(build(*low))) / 2e-6
            np.testing.assert_allclose(out[key][:n, k], slope, rtol=1e-7, atol=1e-8)


def test_gradients_at_kinks_are_the_documented_ones():
    @factor
    def kinks(x: R2, y: R2):
        return stack(norm(x - y), abs(x[0] - y[0]), liegen.minimum(x[0], y[0]), liegen.maximum(x[1], y[1]))

    out = kinks.jacobians([1.0, 2.0], [1.0, 2.0])
    np.testing.assert_array_equal(out["res"], [0.0, 0.0, 1.0, 2.0])
    np.testing.assert_array_equal(out["res_D_x"], [[0, 0], [0, 0], [0.5, 0], [0, 0.5]])
    np.testing.assert_array_equal(out["res_D_y"], [[0, 0], [0, 0], [0.5, 0], [0, 0.5]])


@pytest.mark.parametrize("size", [1e-320, 1e-300, 1e-170, 1e-150, 1.0, 1e150, 1e170, 1e300])
def test_norm_neither_under_nor_overflows(size):
    @factor
    def length(x: R3):
        return norm(x)

    out = length.jacobians(np.array([3.0, 4.0, 12.0]) * size)
    assert out["res"][0] / size == pytest.approx(13.0, rel=4e-16 if size > 1e-300 else 1e-3)
    np.testing.assert_allclose(
        out["res_D_x"][0], np.array([3.0, 4.0, 12.0]) / 13, rtol=4e-16 if size > 1e-300 else 1e-3
    )


def test_minimum_lets_nan_through():
    assert np.isnan(float(liegen.minimum(R1(np.nan), 1.0)))
    assert np.isnan(float(liegen.maximum(1.0, R1(np.nan))))


LEVER = SE3(SO3.exp([0.1, 0.2, 0.3]), [1.0, 0.0, -0.5])


@factor
def mounted(T_WB: SE3, *, z: SE3):
    """A concrete group element of the module is a constant."""
    return z.local(T_WB @ LEVER)


@factor
def chain(x: SE2, y: SE2, *, z: SE2):
    """Python loops unroll."""
    for _ in range(3):
        x = x @ y
    return z.local(x)


def test_constants_of_the_module_and_loops():
    x, z = SE3.exp([0.3, 0.1, -0.2, 1, 2, 3]), SE3.exp([0.1, 0, 0, 1, 1, 1])
    np.testing.assert_allclose(np.asarray(mounted(x, z=z)), np.asarray(z.local(x @ LEVER)), atol=1e-15)
    p, q, r = (SE2.exp(d) for d in ([1.0, 2.0, 0.3], [0.5, 0.0, 0.1], [0.0, 0.0, 0.2]))
    np.testing.assert_allclose(np.asarray(chain(p, q, z=r)), np.asarray(r.local(p @ q @ q @ q)), atol=1e-14)
    assert formula(chain.graph) == ("res = z.local(x.compose(y).compose(y).compose(y))",)


@function
def split(T: SE3, v: R3):
    """Outputs on several manifolds, each in its own chart."""
    return outputs(R=T.rotation, p=T @ v)


@factor
def uses_split(T: SE3, v: R3, *, z: R3):
    """A function called on traced values inlines."""
    return split(T, v).p - z


def test_functions_name_their_outputs_and_inline():
    T, v = SE3.exp([0.3, 0.1, -0.2, 1, 2, 3]), R3(1, 2, 3)
    out = split.jacobians(T, v)
    assert {k: x.shape for k, x in out.items()} == {
        "R": (4,), "p": (3,), "R_D_T": (3, 6), "R_D_v": (3, 3), "p_D_T": (3, 6), "p_D_v": (3, 3)
    }  # fmt: skip
    np.testing.assert_array_equal(out["R_D_T"], np.eye(3, 6))
    np.testing.assert_array_equal(out["R_D_v"], np.zeros((3, 3)))
    np.testing.assert_allclose(np.asarray(uses_split(T, v, z=[0, 0, 0])), np.asarray(T @ v))
    np.testing.assert_allclose(np.asarray(split(T, v).p), out["p"])


def test_vary_fix_bind():
    from liegen.library import projection_cal3_s2, sfm_cal3_s2

    x, p, K, z = SE3.identity(), R3(0.1, 0.2, 2.0), [400.0, 410, 0, 320, 240], [300.0, 200]
    assert [s.name for s in sfm_cal3_s2.declared if s.variable] == ["x", "p", "K"]
    np.testing.assert_array_equal(
        np.asarray(sfm_cal3_s2(x, p, K, z=z)), np.asarray(projection_cal3_s2(x, p, K=K, z=z))
    )
    bound = projection_cal3_s2.fix("p", name="located").bind(K=K, z=z)
    assert list(bound.jacobians(x, p=p)) == ["res", "res_D_x"]
    np.testing.assert_array_equal(np.asarray(bound(x, p=p)), np.asarray(projection_cal3_s2(x, p, K=K, z=z)))
    with pytest.raises(DefinitionError, match="no free argument 'Q'"):
        bound.vary("Q")


def test_outside_the_domain_the_result_is_nan():
    @factor
    def depth(p: R3, *, z: R1):
        require(p[2] > 0, "point behind the camera")
        return p[0] / p[2] - z

    assert np.isfinite(float(depth([1.0, 0, 2], z=[0.0])))
    assert np.isnan(float(depth([1.0, 0, -2], z=[0.0])))
    assert np.isnan(depth.jacobians([1.0, 0, np.nan], z=[0.0])["res_D_p"]).all()


def test_batches_broadcast():
    rng = np.random.default_rng(0)
    x = SE3.exp(rng.normal(size=6))
    points = R3.from_storage(rng.normal(size=(7, 3)))
    moved = np.asarray(x @ points)
    assert moved.shape == (7, 3)
    np.testing.assert_allclose(moved[4], np.asarray(x @ np.asarray(points)[4]), atol=1e-15)
