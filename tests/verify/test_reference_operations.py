"""Every operation of the language: the reference against the closed forms on doubles."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from liegen.decorate import function
from liegen.library import between_r3
from liegen.manifolds import (
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SE23,
    SO3,
    Cal3_S2,
    Cal3Bundler,
    Cal3DS2,
    Gal3,
    Product,
    Sim3,
)  # fmt: skip
from liegen.manifolds.functions import (
    abs as vabs,
)
from liegen.manifolds.functions import (
    acos,
    asin,
    atan2,
    cos,
    cross,
    dot,
    exp,
    log,
    maximum,
    minimum,
    sin,
    sqrt,
    tan,
    where,
)
from liegen.manifolds.vector import norm, stack
from liegen.modules import group_functions
from liegen.noise import weighting
from liegen.noise.extend import cost_graph
from liegen.trace import outputs
from liegen.verify import reference

M = np.array([[1.0, 0.5, 0.0], [0.0, -2.0, 0.25]])
POSE = SE3.from_storage([0.5, -0.5, 0.5, 0.5, 1.0, 2.0, 3.0])


@function
def groups_language(T: SE3, P: SE2, *, n: S2, d: R3) -> Any:
    U = SE3(T.rotation @ SO3.exp(d), T.translation + d).compose(POSE)
    V = T.inverse().between(U).retract(stack(d, 0.1, 0.2, 0.3))
    Q = SE2(P.rotation.inverse(), P.translation).retract(stack(d[:2], 0.2))
    m = n.retract(d[1:])
    return outputs(
        V=V,
        Q=Q,
        m=m,
        R=T.rotation.between(V.rotation),
        c=Q.bearing(P),
        b=V.bearing(d),
        log=V.log(),
        Pose=SE3.exp(stack(d, d)),
        Plane=SE2.exp(d),
        angle=P.local(Q),
        s2=n.local(m),
        u=m.vector + T.rotation.unrotate(d),
        from_=V @ d,
        to=V.transform_to(d),
        range=V.range(T),
        dir=S2.direction(d),
        so2=P.rotation @ d[:2],
        vectors=R3.exp(d).compose(d).between(d.inverse()).log() + d.local(m.vector) + d.retract(d),
    )


@function
def vectors_language(v: R3, *, w: R3) -> Any:
    small = v / 10
    c = (v[0] < w[0]) | ~(v[1] <= w[1]) & (v[2] >= 0)
    return outputs(
        sums=v + w * 2 - 3 / v + (-v) * w,
        mean=vabs(v) + abs(w),
        waves=sin(v) + cos(w) * tan(small),
        inverse=asin(small) + acos(small),
        roots=sqrt(vabs(v)) + exp(small) + log(vabs(w)),
        angle=atan2(v[1], w[0]),
        low=minimum(v, w),
        high=maximum(v, 0.1),
        chosen=where(c, v, w),
        dot=dot(v, w),
        cross=cross(v, w),
        norm=norm(v),
        take=v[::-1],
        matrix=M @ v,
        power=v**3,
    )


@function
def cameras_language(K: Cal3_S2, D: Cal3DS2, B: Cal3Bundler, *, p: R2) -> Any:
    return outputs(
        a=K.uncalibrate(p),
        b=D.uncalibrate(p),
        c=B.uncalibrate(p),
        d=B.local(B.retract([1.0, 2.0, 3.0])),
        K=K.retract([1.0] * 5),
    )


class Placed(Product):
    pose: SE3
    point: R3


@function
def extended_language(x: SE23, g: Gal3, u: Sim3, *, d: R3) -> Any:
    s = Placed(pose=x.pose, point=x.velocity)
    return outputs(
        x=SE23(x.rotation, x.position + d, x.velocity),
        g=Gal3(g.rotation, g.position + g.velocity, d, g.time),
        s=s.retract(stack(d, d, d)),
        u=Sim3(u.rotation, u @ u.translation, u.scale),
        seen=u.transform_to(d),
        moved=s.pose @ s.point,
    )


WHITENED = between_r3.whitened("full")
COST = SimpleNamespace(name="cost", graph=cost_graph(between_r3.plain, weighting("full", "cauchy", None, "")))


def in_doubles(graph: Any, sample: Any) -> dict[str, Any]:
    """The outputs by the operations' own closed forms on floats."""
    values = {id(p.node): tuple(map(np.float64, sample[p.name])) for p in graph.parameters}
    for node in graph.nodes():
        if id(node) not in values:
            leaf = getattr(node.operation, "coords", None)
            values[id(node)] = leaf or node.operation.value(*(values[id(n)] for n in node.operands))
    return {name: tuple(float(x) for x in values[id(node)]) for name, node in graph.outputs}


MATRICES = [f for group in (SE2, SE3) for f in group_functions(group) if not f.kernel.variables]
LANGUAGES = [
    groups_language, vectors_language, cameras_language, extended_language, WHITENED, COST, *MATRICES,
]  # fmt: skip


@pytest.mark.parametrize("language", LANGUAGES, ids=lambda f: f.name)
def test_every_operation_agrees_with_the_closed_forms_on_doubles(language: Any) -> None:
    g = np.random.default_rng(11)
    size = {"SE3": 4, "SE2": 2, "S2": 3, "SE23": 4, "Gal3": 4, "Sim3": 4}
    for _ in range(5):
        sample: dict[str, Any] = {}
        for p in language.graph.parameters:
            x, k = g.normal(size=p.manifold.form.size), size.get(p.manifold.form.name, 0)
            x[:k] /= np.linalg.norm(x[:k]) if k else 1
            x[-1] = abs(x[-1]) if p.manifold.form.name == "Sim3" else x[-1]
            sample[p.name] = x
        expected, found = in_doubles(language.graph, sample), reference.outputs(language.graph, sample)
        for name, node in language.graph.outputs:
            stored = reference.to_coords(node.manifold, found[name], expected[name])
            assert stored == pytest.approx(expected[name], rel=1e-11, abs=1e-12), name


def test_the_languages_above_cover_every_operation() -> None:
    used = {n.operation.name for f in LANGUAGES for n in f.graph.nodes()}
    from liegen.verify.reference.interpreter import OPERATIONS

    assert set(OPERATIONS) - used == set()
    assert used - set(OPERATIONS) == {"parameter", "constant"}
