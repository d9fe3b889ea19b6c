"""The choice of the order of elimination, fused operations, and how the work grows."""

from __future__ import annotations

import numpy as np
import pytest

from liegen import R1, R3, SE3, SO3, factor, function, sin, stack
from liegen.bench import formulas
from liegen.choice import Way, entries, ranked
from liegen.derive import derive, lowered
from liegen.differentiate import STRATEGIES, expressions, fused, jacobians, linearised
from liegen.library import bearing_se3_gtsam, between_se3, between_so3, projection_cal3_ds2
from liegen.manifolds import R2, SE2
from liegen.manifolds.functions import dot
from liegen.program.kinds import kinds
from liegen.program.passes import cse, dead, fold, optimise, signs
from liegen.verify.backends import program_evaluator
from liegen.verify.draws import batch, draw_samples

FUNCTIONS = [projection_cal3_ds2, bearing_se3_gtsam, formulas.rolling_shutter, formulas.imu_step]


def settled(program):
    """Operations without changes of sign."""
    return program.operations - kinds(program)["sign"]


@factor
def chain(x0: SE3, x1: SE3, x2: SE3, x3: SE3, x4: SE3, x5: SE3, x6: SE3, x7: SE3, *, z: SE3):
    return z.local(x0 @ x1 @ x2 @ x3 @ x4 @ x5 @ x6 @ x7)


@factor
def half_chain(x0: SE3, x1: SE3, x2: SE3, x3: SE3, *, z: SE3):
    return z.local(x0 @ x1 @ x2 @ x3)


def ranking(graph, values, local):
    way = Way(graph, values, local)
    return ranked([way], lowered(graph, values, {}, beside=entries(way.blocks)))


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.name)
def test_counting_foretells_what_an_order_takes(function):
    graph = function.plain
    values = expressions(graph)
    local = linearised(graph, values)[0]
    order = ranking(graph, values, local)
    assert [count for count, _, _ in order] == sorted(count for count, _, _ in order)
    for count, _, name in order[:3]:
        program = dead(signs(fold(cse(lowered(graph, values, local.jacobians(STRATEGIES[name]))))))
        # folding knows a few identities more than counting does
        assert settled(program) <= count <= 1.04 * settled(program) + 2


@pytest.mark.parametrize("function", [*FUNCTIONS, between_se3, chain], ids=lambda f: f.name)
def test_the_best_order_is_no_worse_than_any(function):
    graph = function.plain
    values = expressions(graph)
    local = linearised(graph, values)[0]
    best = ranking(graph, values, local)[0][0]
    for strategy in STRATEGIES.values():
        assert best <= 1.04 * settled(signs(cse(lowered(graph, values, local.jacobians(strategy))))) + 2


def test_a_chain_of_eight_poses():
    assert derive(chain.plain).jacobians.operations <= 1700
    assert derive(half_chain.plain).jacobians.operations <= 850


@function
def radial(q: R3, K: R3):
    """A pinhole with radial distortion."""
    m = q[:2] / q[2]
    r2 = dot(m, m)
    return K[0] * (1 + r2 * (K[1] + K[2] * r2)) * m


def test_a_function_of_one_number_has_one_slope():
    """That of the distortion by r^2, for both rows of the Jacobian: 43 operations, 46 in reverse."""
    kernel = derive(radial.plain)
    assert kernel.passes[0].name == "lower, scalars first order"
    reverse = jacobians(radial.plain, values := expressions(radial.plain), STRATEGIES["reverse"])
    other, _ = optimise(lowered(radial.plain, values, reverse))
    assert kernel.jacobians.operations < other.operations
    assert kernel.jacobians.operations <= 43


@function
def sheared(q: R3, a: R2):
    m = q[:2] / q[2]
    return stack(a[0] * m[0] + a[1] * m[1], a[1] * m[0] - a[0] * m[1])


def test_a_quotient_shares_what_is_in_front_of_it():
    """(M / z) and (M / z) times -m, and not m / z too: the rows by q of a linear function of q.xy / q.z."""
    kernel = derive(sheared.plain)
    assert kernel.jacobians.op_counts()["div"] == 1
    assert kernel.jacobians.operations <= 19


def test_local_of_between_is_one_operation():
    names = [n.operation.name for n in fused(between_se3.plain).nodes()]
    assert names.count("local_between") == 1
    assert "between" not in names
    assert fused(projection_cal3_ds2.plain) is projection_cal3_ds2.plain


def test_in_another_chart_nothing_is_fused():
    graph = between_se3.in_chart("sophus").plain
    assert fused(graph) is graph or all(n.operation.name != "local" for n in fused(graph).nodes())
    turned = between_so3.in_chart("ceres").plain
    assert fused(turned) is turned


@factor
def relative_of_moved(x: SO3, y: SO3, v: R3, *, z: SO3):
    return (z @ SO3.exp(v)).local(x.between(y @ SO3.exp(2 * v)))


@function
def way_so3(x: SO3, y: SO3, a: R1):
    return x @ SO3.exp(a * x.local(y))


@function
def way_se3(x: SE3, y: SE3, a: R1):
    return x.retract(x.local(y) * a)


@function
def way_se2(x: SE2, y: SE2, *, a: R1):
    return x.retract(a * x.local(y))


@function
def no_way(x: SO3, y: SO3, *, a: R1):
    """From x towards y, but not from x on."""
    return y @ SO3.exp(a * x.local(y))


FUSED = [between_so3, between_se3, relative_of_moved, way_so3, way_se3, way_se2]


def test_an_interpolation_is_one_operation():
    for f in (way_so3, way_se3, way_se2):
        assert [n.operation.name for n in fused(f.plain).nodes()][-1] == "interpolate"
    assert fused(no_way.plain) is no_way.plain
    turned = way_so3.in_chart("ceres").plain
    assert [n.operation.name for n in fused(turned).nodes()] == [n.operation.name for n in turned.nodes()]


@pytest.mark.parametrize("function", FUSED, ids=lambda f: f.name)
def test_fused_operations_have_the_same_values_and_jacobians(function):
    """At every special case: around 0, around pi, -q for q."""
    graph = function.plain
    samples = [s for s in draw_samples(function, 150, 4).inside if not s.case.startswith("thousands")]
    both = []
    for g in (graph, fused(graph)):
        values = expressions(g)
        blocks = jacobians(g, values, STRATEGIES["reverse"])
        both.append(program_evaluator(lowered(g, values, blocks))(batch(tuple(samples))))
    assert fused(graph) is not graph
    for name, plain in both[0].items():
        flat, other = (a.reshape(len(samples), -1) for a in (plain, both[1][name]))
        scale = np.maximum(1.0, np.abs(flat).max(axis=1))
        worst = np.abs(flat - other).max(axis=1) / scale
        assert worst.max() <= 4e-14, (name, samples[int(worst.argmax())].case)


def long_stack(n):
    def long(x: SE2, p: R3, *, a: R1):
        terms = [sin(p[k % 3] * (k + 1.0)) * a + x.translation[k % 2] for k in range(n)]
        return stack(p, *terms, 2.0 * p)

    return factor(long)


def test_a_long_stack_has_the_same_jacobian_in_parts():
    function = long_stack(40)
    graph = function.plain
    values = expressions(graph)
    whole = linearised(graph, values, through_storage=True)[0]
    assert [shape[0] for _, shape in whole.wanted["res", "x"]] == [12, 12, 12, 10]
    J = function.jacobians(x=[1, 0, 2, 3], p=[0.1, 0.2, 0.3], a=[2.0])
    k = np.arange(40)
    expected = np.zeros((46, 3))
    expected[:3], expected[43:] = np.eye(3), 2 * np.eye(3)
    p = np.array([0.1, 0.2, 0.3])[k % 3]
    expected[3 + k, k % 3] = 2.0 * (k + 1) * np.cos(p * (k + 1))
    np.testing.assert_allclose(J["res_D_p"], expected, rtol=0, atol=1e-13)
    by_x = np.zeros((46, 3))
    by_x[3 + k, k % 2] = 1
    np.testing.assert_allclose(J["res_D_x"], by_x, rtol=0, atol=1e-15)
