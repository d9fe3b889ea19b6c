"""The gradient of a norm is 0 at a difference that is nothing but rounding, in all code that is generated.

What is right: 0, by the definition of the gradient at the kink (docs/conventions.md). It is asked at random
poses, where x^-1 x is not the identity in doubles.
"""

import numpy as np
import pytest

import liegen
from compiler_tools import needs_compiler
from liegen import (
    R3,
    R6,
    S2,
    SE2,
    SE3,
    SE23,
    SO2,
    SO3,
    Gal3,
    NavState,
    Product,
    Sim2,
    Sim3,
    factor,
    norm,
)  # fmt: skip
from liegen.define import Function
from liegen.emit.precision import SINGLE
from liegen.samples import Draw
from liegen.verify.backends import backends, compiled_backends, workspace

W = np.diag([100.0, 200.0, 3.0])


class State(Product):
    pose: SE3
    v: R3
    n: S2


def distance(group, **options):
    """norm(x.local(y)) on a manifold."""

    def formula(x: group, y: group):
        return norm(x.local(y))

    formula.__name__ = f"distance_{group.__name__.lower()}"
    return factor(**options)(formula)


@factor
def logarithm(x: SE3, y: SE3):
    return norm(x.between(y).log())


@factor
def angle(x: SE3, y: SE3):
    return norm(x.local(y)[:3])


@factor
def absolute(x: SO2, y: SO2):
    return abs(x.local(y))


@factor
def weighted(x: SE3, y: SE3, w: R6):
    return norm(w * x.local(y))


@factor
def by_matrix(x: SO3, y: SO3):
    return norm(W @ x.local(y)) * 2


@factor
def lever_arm(x: SE3, y: SE3, e: SE3):
    return norm((x @ e).local(y @ e))


@factor
def moved(x: SE3, y: SE3, p: R3):
    return norm(x @ p - y @ p)


@factor
def position(x: SE3, y: SE3):
    return norm(x.between(y).translation)


@factor
def loop(x: SE3, y: SE3, *, z: SE3):
    return norm(z.local(x.between(y)))


MANIFOLDS = (SO2, SE2, SO3, SE3, SE23, NavState, Gal3, Sim2, Sim3, S2, State)
FACTORS: tuple[Function, ...] = (
    *map(distance, MANIFOLDS),
    *(logarithm, angle, absolute, weighted, by_matrix, lever_arm, moved, position, loop),
)
COMPILED = (FACTORS[3], FACTORS[9], absolute, lever_arm, loop)


def coincident(function: Function, count: int = 40, *, spread: float = 100.0) -> dict[str, np.ndarray]:
    """Random arguments with y = x, half of them as -q; z = x^-1 y."""
    draw = Draw(np.random.default_rng(3))
    drawn = {
        p.name: np.array([p.manifold.form.draw(draw, spread) for _ in range(count)])
        for p in function.graph.parameters
    }
    drawn["y"] = drawn["x"].copy()
    for start in function.graph.parameters[0].manifold.form.quaternions:
        drawn["y"][::2, start : start + 4] *= -1
    if "z" in drawn:
        x, y = (SE3.from_storage(drawn[name]) for name in "xy")
        drawn["z"] = np.asarray(x.between(y))
    return drawn


def slopes(results):
    return {name: np.abs(a).max() for name, a in results.items() if "_D_" in name}


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_gradient_is_zero_at_coincidence(function):
    arguments = coincident(function)
    program = function.kernel.jacobians
    results = program.evaluate({name: tuple(a.T) for name, a in arguments.items()})
    found = {n: np.abs(np.stack(np.broadcast_arrays(*a))).max() for n, a in results.items() if "_D_" in n}
    assert found
    assert set(found.values()) == {0.0}


@needs_compiler
def test_gradient_is_zero_in_all_generated_code():
    with workspace([f.kernel for f in COMPILED]) as place:
        for function in COMPILED:
            arguments = coincident(function)
            for backend in backends(function.kernel, place):
                found = slopes(backend.evaluate(arguments)) if backend.jacobians else {}
                assert set(found.values()) <= {0.0}, (function.name, backend.name)
            single = {name: a.astype(np.float32).astype(float) for name, a in arguments.items()}
            for backend in compiled_backends(function.kernel, place, SINGLE):
                found = slopes(backend.evaluate(single)) if backend.jacobians else {}
                assert set(found.values()) <= {0.0}, (function.name, backend.name, "float")


@needs_compiler
def test_gradient_is_zero_with_contraction_to_fma():
    function = FACTORS[3]
    arguments = coincident(function)
    found = liegen.compile(function).jacobians(arguments["x"], arguments["y"])
    assert np.abs(found.res_D_x).max() == np.abs(found.res_D_y).max() == 0


@pytest.mark.parametrize("chart", ["g2o", "ceres", "symforce", "gtsam-4.2"])
@pytest.mark.parametrize("layout", ["xyzw", "4x4"])
def test_gradient_is_zero_in_charts_and_layouts(chart, layout):
    function = distance(SE3, chart=chart, layout=layout)
    arguments = {p.name: [] for p in function.graph.parameters}
    draw = Draw(np.random.default_rng(5))
    for _ in range(20):
        x = SE3.from_storage(np.array(SE3.form.draw(draw, 10.0)))
        for p in function.graph.parameters:
            arguments[p.name].append(p.storage.write(x.coords))
    columns = {name: tuple(np.array(rows, dtype=float).T) for name, rows in arguments.items()}
    results = function.kernel.jacobians.evaluate(columns)
    assert all(np.abs(x).max() == 0 for n, a in results.items() if "_D_" in n for x in a)


def test_gauss_newton_terms_are_zero():
    function = FACTORS[3]
    arguments = coincident(function, 5)
    terms = function.gauss_newton(arguments["x"], arguments["y"])
    assert all(np.abs(a).max() == 0 for n, a in terms.items() if n[0] in "gH")


@pytest.mark.parametrize("group", [SO3, SE3, S2], ids=lambda g: g.__name__)
def test_gradient_is_a_unit_vector_just_away_from_it(group):
    """Above the rounding nothing changes: 1e-13 rad is a distance whose gradient has length 1."""
    function = distance(group)
    d = np.zeros(group.form.dim)
    d[0] = 1e-13
    x = group.from_storage(np.array(group.form.draw(Draw(np.random.default_rng(1)), 1.0)))
    found = function.jacobians(x, x.retract(d))
    by_y = np.asarray(found["res_D_y"])
    assert np.linalg.norm(by_y) == pytest.approx(1, abs=1e-9)


def test_differences_of_stored_numbers_are_exact():
    """Points that are 1e-300 m apart at 1 km have a direction: what is subtracted is known exactly."""

    @factor
    def points(a: R3, b: R3):
        return norm(a - b)

    a = R3(1000.0, 0, 0)
    found = points.jacobians(a, R3(1000.0, 0, 1e-300))
    assert np.allclose(np.asarray(found["res_D_b"]), [[0, 0, 1]])


def test_leaf_logarithms_keep_their_direction():
    """The logarithm of what is stored is exact: a turn by 1e-20 rad has an axis."""

    @factor
    def turn(x: SO3):
        return norm(x.log())

    found = turn.jacobians(SO3.from_storage([0, 5e-21, 0, 1]))
    assert np.allclose(np.asarray(found["res_D_x"]), [[0, 1, 0]])
