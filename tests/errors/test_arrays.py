"""Arrays where typed values are wanted: batches by their shape, and errors that name the argument."""

import warnings
from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from liegen import (
    R1,
    R2,
    R3,
    R6,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Product,
    R,
    Sim3,
    cross,
    dot,
    factor,
    function,
    norm,
    stack,
)  # fmt: skip
from liegen.errors import DefinitionError
from liegen.manifolds.given import LARGEST

RNG = np.random.default_rng(5)
TURN, SHIFT = RNG.normal(size=(5, 3)), RNG.normal(size=(5, 3))
POINTS = RNG.normal(size=(5, 3))
Q = Rotation.from_rotvec(TURN)
POSES = SE3.from_storage(np.hstack([Q.as_quat(), SHIFT]))


class State(Product):
    pose: SE3
    v: R3
    b: R6


@factor
def scaled(x: R3, *, z: R3, k: R1):
    return k[0] * x - z


def close(value, expected):
    np.testing.assert_allclose(np.asarray(value), expected, atol=1e-14)


def test_batches_enter_every_operation():
    close(SO3.exp(TURN), Q.as_quat() * np.sign(Q.as_quat()[:, 3:]))
    close(POSES @ POINTS, Q.apply(POINTS) + SHIFT)
    close(POSES.transform_to(POINTS), Q.inv().apply(POINTS - SHIFT))
    close(
        POSES.retract(np.hstack([np.zeros((5, 3)), POINTS])),
        np.hstack([Q.as_quat(), Q.apply(POINTS) + SHIFT]),
    )
    close(norm(POINTS), np.linalg.norm(POINTS, axis=1)[:, None])
    close(dot(POINTS, TURN), np.sum(POINTS * TURN, axis=1)[:, None])
    close(cross(POINTS, [1.0, 2, 3]), np.cross(POINTS, [1, 2, 3]))
    close(R3(1, 2, 3) + POINTS, POINTS + np.array([1, 2, 3]))
    close(S2.direction(POINTS), POINTS / np.linalg.norm(POINTS, axis=1)[:, None])
    close(SE3.exp(np.zeros((5, 6))), np.tile([0, 0, 0, 1, 0, 0, 0], (5, 1)))
    assert SE3.exp([[0.0] * 6] * 4).matrix().shape == (4, 4, 4)


@pytest.mark.parametrize("name", ["compose", "between", "local"])
def test_stored_numbers_are_elements(name):
    stored = np.asarray(POSES)
    x = SE3.exp([0.1, 0.2, 0.3, 1, 2, 3])
    close(getattr(x, name)(stored), np.asarray(getattr(x, name)(POSES)))
    close(x @ stored, np.asarray(x @ POSES))


def test_vectors_of_any_dimension():
    assert R(12) is R(12)
    assert R(3) is R3
    assert R(12).form.dim == 12

    @factor
    def long(x: R(12), *, z: R(12)):
        return x - z

    close(long(np.arange(12.0), z=np.ones(12)), np.arange(12.0) - 1)


def test_products_by_position():
    pose, v, b = SE3.exp(np.arange(6) / 10), [1.0, 2, 3], np.arange(6.0)
    whole = State(pose=pose, v=v, b=b)
    for other in (State(pose, v, b), State(pose, v, b=b), State(np.asarray(pose), v, b)):
        close(other, np.asarray(whole))


@pytest.mark.parametrize("k", [0.5, np.float64(0.5), np.array(0.5), [0.5], R1(0.5), Fraction(1, 2)])
def test_scalars_fit_r1(k):
    close(scaled([1, 2, 3], z=[0, 0, 1], k=k), [0.5, 1, 0.5])
    close(scaled.jacobians([1, 2, 3], z=[0, 0, 1], k=k)["res_D_x"], 0.5 * np.eye(3))


X = SE3.identity()
#: What is done, and what the message must say.
REFUSED = {
    "tangent where elements are": (lambda: X.compose(np.zeros((5, 6))), ["compose", "(5, 6)", "SE3.exp"]),
    "tangent in local": (lambda: X.local(np.zeros(6)), ["local", "(6,)", "(..., 7)", "SE3.exp"]),
    "a number as an element": (lambda: X.between(3), ["between", "SE3", "shape ()"]),
    "None as an element": (lambda: X.local(None), ["local", "None"]),
    "transposed batch": (lambda: SE3.exp(np.zeros((6, 5))), ["SE3.exp", "(..., 6)", "(6, 5)"]),
    "no point": (lambda: X @ np.zeros((4, 4)), ["SE3.transform_from", "(..., 3)", "(4, 4)"]),
    "batches of two lengths": (lambda: POSES @ np.zeros((4, 3)), ["transform_from", "(5,) and (4,)"]),
    "text": (lambda: SE3.exp("abc"), ["SE3.exp", "got text"]),
    "text of numbers": (lambda: R3("1", "2", "3"), ["got text"]),
    "complex": (lambda: SE3.exp([1j] * 6), ["SE3.exp", "complex numbers"]),
    "rows of two lengths": (lambda: SE3.exp([[1.0], [1.0, 2.0]]), ["SE3.exp", "differ in length"]),
    "a part missing": (lambda: State(X, [1, 2, 3]), ["State(pose=..., v=..., b=...)", "State(pose, v, b)"]),
    "a part too many": (lambda: State(X, [1, 2, 3], np.zeros(6), 1), ["State(pose, v, b)"]),
    "a part twice": (lambda: State(X, [1, 2, 3], v=[1, 2, 3]), ["State(pose, v, b)"]),
    "a part of another shape": (lambda: State(np.zeros(6), [1, 2, 3], np.zeros(6)), ["pose=...", "(..., 7)"]),
    "batch of scalars": (lambda: scaled([1, 2, 3], z=[0, 0, 0], k=np.zeros(5)), ["'k'", "(5,)", "[:, None]"]),
    "argument of another shape": (lambda: scaled([1, 2], z=[0, 0, 0], k=1), ["scaled", "'x'", "(2,)"]),
    "argument is text": (lambda: scaled("a", z=[0, 0, 0], k=1), ["scaled", "'x'", "text"]),
    "argument is None": (lambda: scaled([1, 2, 3], z=None, k=1), ["scaled", "'z'", "None"]),
    "argument is a dict": (lambda: scaled([1, 2, 3], z={}, k=1), ["scaled", "'z'", "dict"]),
    "argument is complex": (lambda: scaled([1, 2, 3j], z=[0, 0, 0], k=1), ["scaled", "'x'", "complex"]),
    "argument of another manifold": (lambda: scaled(X, z=[0, 0, 0], k=1), ["scaled", "'x'", "R3", "SE3"]),
    "arguments of two batches": (
        lambda: scaled(np.zeros((4, 3)), z=np.zeros((5, 3)), k=1), ["scaled", "x (4,)", "z (5,)"]),
    "argument missing": (lambda: scaled([1, 2, 3]), ["scaled(x, z=, k=)", "missing z, k"]),
    "argument unknown": (lambda: scaled([1, 2, 3], z=1, k=1, w=1), ["scaled(x, z=, k=)", "unknown w"]),
    "argument twice": (lambda: scaled([1, 2, 3], x=1, z=1, k=1), ["scaled(x, z=, k=)", "given twice x"]),
    "bound to text": (lambda: scaled.bind(z="a"), ["scaled", "'z'", "text"]),
    "bound to None": (lambda: scaled.bind(k=None), ["scaled", "'k'", "None"]),
    "bound to a batch": (lambda: scaled.bind(z=np.zeros((4, 3))), ["scaled", "'z'", "batch", "(4,)"]),
    "bound to NaN": (lambda: scaled.bind(z=[np.nan, 0, 0]), ["scaled", "'z'", "not finite"]),
    "bound by an unknown name": (lambda: scaled.bind(w=1), ["scaled", "'w'", "x, z, k"]),
    "vary by a number": (lambda: scaled.vary(5), ["scaled", "argument 5", "x, z, k"]),
    "name that is no text": (lambda: scaled.vary("z", name=5), ["scaled", "name=", "got 5"]),
    "name that is no name": (lambda: scaled.vary("z", name="a b"), ["scaled", "name=", "'a b'"]),
    "docstring that is no text": (lambda: scaled.vary("z", doc=5), ["scaled", "doc=", "got 5"]),
    "sampler that is no function": (lambda: scaled.vary("z", sample=5), ["scaled", "sample="]),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_fit_is_named(name):
    act, says = REFUSED[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(DefinitionError) as caught:
            act()
    for words in ("test_arrays.py:", *says):
        assert words in str(caught.value)


@pytest.mark.parametrize(
    "dim", [1.5, "3", None, float("nan"), [3], True, 0, -1, 10**30, 10**6, LARGEST + 1, (2, 3), {}, 2j]
)
def test_a_dimension_is_a_whole_number_below_the_limit(dim):
    with pytest.raises(DefinitionError, match=f"Mine: dim is a whole number from 1 to {LARGEST}, got"):
        type("Mine", (R,), {}, dim=dim)
    with pytest.raises(DefinitionError, match=f"R: dim is a whole number from 1 to {LARGEST}, got"):
        R(dim)


def test_the_largest_dimension_works():
    assert type("Long", (R,), {}, dim=np.int64(LARGEST)).form.dim == LARGEST


def test_a_batch_is_no_constant_of_a_formula():
    with pytest.raises(DefinitionError, match=r"constant of a formula is one R3.*\(5, 3\)"):

        @factor
        def f(x: R3):
            return x - POINTS

    with pytest.raises(DefinitionError, match=r"argument 'z' is a batch of shape \(5,\)"):

        @factor
        def g(x: R3):
            return scaled(x, z=POINTS, k=1.0)


def test_points_and_elements_of_the_plane_are_told_apart_by_shape():
    x = SE2(SO2.exp([0.5]), [1.0, 2.0])
    points = RNG.normal(size=(4, 2))
    c, s = np.cos(0.5), np.sin(0.5)
    close(x @ points, points @ np.array([[c, s], [-s, c]]) + [1, 2])
    close(x @ np.asarray(x), np.asarray(x.compose(x)))
    y = Sim3(SO3.identity(), [1.0, 2, 3], 2.0)
    close(y @ np.zeros((2, 3)), [[1, 2, 3]] * 2)
    close(y @ np.asarray(y), np.asarray(y.compose(y)))


@function
def moved(x: SE3, p: R3, *, by: R3 = R3(0, 0, -1)):  # noqa: B008
    return x @ (p + by)


def test_functions_take_batches_and_stack_takes_numbers():
    close(moved(POSES, POINTS), Q.apply(POINTS - [0, 0, 1]) + SHIFT)
    close(stack(POINTS, 1.0), np.hstack([POINTS, np.ones((5, 1))]))
    with pytest.raises(DefinitionError, match="R2"):
        moved(POSES, R2(1, 2))
