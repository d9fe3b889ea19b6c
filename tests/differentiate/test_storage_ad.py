"""Two ways to the same Jacobian: rules in tangent spaces, and CasADi through the stored numbers."""

from __future__ import annotations

import numpy as np
import pytest

from liegen import (
    R1,
    R2,
    R3,
    SE2,
    SE3,
    SO3,
    atan2,
    cross,
    dot,
    factor,
    function,
    maximum,
    norm,
    outputs,
    stack,
)
from liegen.derive import lowered
from liegen.differentiate import STRATEGIES, expressions, jacobians
from liegen.verify.backends import program_evaluator
from liegen.verify.draws import batch, draw_samples
from liegen.verify.run import library


@factor
def all_of_se3(x: SE3, y: SE3, v: R3, *, a: R1):
    w = SE3.exp(stack(v, v * a))
    u = x.compose(w).inverse().between(y.retract(stack(a * v, v)))
    return stack(u.log(), u.rotation @ v, u.rotation.unrotate(v), (w @ u).translation, norm(cross(v, w @ v)))


@factor
def all_of_se2(x: SE2, y: SE2, p: R2):
    q = x.transform_from(y.transform_to(p))
    turned = SE2(x.rotation @ y.rotation, q)
    return stack(turned.inverse().local(y), atan2(p[0], p[1]), dot(p, q), maximum(p, q))


@function
def two_outputs(R: SO3, w: R3, *, t: R3):
    return outputs(S=R @ SO3.exp(w), T=SE3(R.inverse(), R @ t + w))


FACTORS = [*library().values(), all_of_se3, all_of_se2, two_outputs]


@pytest.mark.parametrize("function", FACTORS, ids=lambda f: f.name)
def test_rules_agree_with_differentiation_through_the_storage(function):
    graph = function.graph
    values = expressions(graph)
    results = []
    samples = [
        s
        for s in draw_samples(function, 40, 8).inside
        if s.case.startswith(("random", "negated", "angle 1.0"))
    ]
    samples += [s for s in draw_samples(function, 40, 9).inside if s.case.startswith(("random", "tens"))]
    for through_storage in (False, True):
        blocks = jacobians(graph, values, STRATEGIES["forward"], through_storage=through_storage)
        results.append(program_evaluator(lowered(graph, values, blocks))(batch(tuple(samples))))
    by_rules, by_storage = results
    compared = 0
    for name in by_rules:
        scale = np.maximum(1.0, np.abs(by_rules[name]).max())
        assert np.isfinite(by_rules[name]).all()
        assert np.abs(by_rules[name] - by_storage[name]).max() <= 1e-11 * scale, name
        compared += "_D_" in name
    assert compared == len(graph.outputs) * sum(p.variable for p in graph.parameters)


@pytest.mark.parametrize("order", list(STRATEGIES))
def test_every_order_of_elimination_gives_the_same_jacobian(order):
    graph = all_of_se3.graph
    values, samples = expressions(graph), batch(draw_samples(all_of_se3, 10, 8).inside[:1])
    first, other = (
        program_evaluator(lowered(graph, values, jacobians(graph, values, STRATEGIES[o])))(samples)
        for o in ("forward", order)
    )
    for name in first:
        np.testing.assert_allclose(
            first[name], other[name], rtol=0, atol=1e-12 * max(1, np.abs(first[name]).max())
        )
