"""Products that act on vectors: the factors act one after the other where that takes fewer operations."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

import pytest

import liegen.derive
from liegen import R1, R2, R3, SE2, SE3, SO3, Sim2, Sim3, factor, function, outputs, require
from liegen.differentiate import nested
from liegen.trace import Graph
from liegen.verify import verify


def made(group: Any, formula: str, name: str = "acting") -> Any:
    """The factor of x, of S and p that are given, with this formula."""
    names: dict[str, Any] = {}
    exec(f"def {name}(x, *, S, p): return {formula}", names)
    f = names[name]
    f.__annotations__ = {"x": group, "S": group, "p": R2 if group in (SE2, Sim2) else R3}
    return factor(f)


def as_it_is(graph: Graph) -> Graph:
    return graph


#: Operations of value, and of value and Jacobians: products first, and as it is derived.
TABLE = [
    (SE3, "(x @ S).transform_to(p)", (102, 188), (82, 111)),
    (SE3, "(x @ S).transform_from(p)", (102, 278), (82, 109)),
    (SE3, "(x @ S).inverse().transform_to(p)", (132, 185), (82, 109)),
    (SE3, "(x @ S).inverse().transform_from(p)", (132, 311), (82, 111)),
    (SE3, "x.between(S).transform_to(p)", (102, 165), (82, 154)),
    (SE3, "x.between(S).transform_from(p)", (102, 105), (82, 85)),
    (SE3, "(x @ S @ S).transform_to(p)", (163, 336), (100, 160)),
    (SE3, "S.between(x @ S).transform_to(p)", (163, 249), (100, 129)),
    (SE2, "(x @ S).transform_to(p)", (22, 32), (16, 24)),
    (SE2, "S.between(x @ S).transform_from(p)", (36, 51), (24, 37)),
    (Sim3, "(x @ S).transform_to(p)", (118, 233), (90, 143)),
    (Sim3, "x.between(S).transform_from(p)", (118, 323), (89, 92)),
    (Sim2, "(x @ S).transform_from(p)", (27, 56), (20, 30)),
    (SO3, "(x @ S) @ p", (66, 161), (66, 103)),
    (SO3, "(x @ S @ S).unrotate(p)", (94, 177), (91, 151)),
]


@pytest.mark.parametrize(("group", "formula", "before", "after"), TABLE)
def test_operations(
    group: Any, formula: str, before: Any, after: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    kernel = made(group, formula).kernel
    assert (kernel.value.operations, kernel.jacobians.operations) == after
    monkeypatch.setattr(liegen.derive, "nested", as_it_is)
    kernel = made(group, formula).kernel
    assert (kernel.value.operations, kernel.jacobians.operations) == before


@pytest.mark.parametrize(
    ("formula", "by_hand"),
    [
        ("(x @ S).transform_to(p)", "S.transform_to(x.transform_to(p))"),
        ("(x @ S).transform_from(p)", "x.transform_from(S.transform_from(p))"),
        ("x.between(S).transform_from(p)", "x.transform_to(S.transform_from(p))"),
        ("x.between(S).transform_to(p)", "S.transform_to(x.transform_from(p))"),
        ("x.inverse().transform_to(p)", "x.transform_from(p)"),
        ("S.between(x @ S).inverse().transform_from(p)",
         "S.transform_to(x.transform_to(S.transform_from(p)))"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("group", [SE2, SE3])
def test_as_cheap_as_written_by_hand(group: Any, formula: str, by_hand: str) -> None:
    one, other = made(group, formula), made(group, by_hand)
    for of in map(attrgetter, ("kernel.value", "kernel.jacobians", "gauss_newton_kernel.value")):
        assert of(one).operations <= of(other).operations


def test_the_results_are_right() -> None:
    cases = [
        (SE3, "S.between(x @ S).transform_from(p)"),
        (SE2, "x.inverse().between(S @ x).transform_to(p)"),
        (SO3, "(x @ S.inverse() @ x).unrotate(p)"),
    ]
    factors = [made(g, f, f"case{k}") for k, (g, f) in enumerate(cases)]
    assert all(nested(f.plain) is not f.plain for f in factors)
    report = verify(factors, samples=4, workers=1)
    assert report.passed, report
    assert verify(factors[1:2], samples=4, gauss_newton=True, workers=1).passed


def test_a_product_that_is_needed_too_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    def both(x: SE3, *, S: SE3) -> Any:
        c = x @ S
        return outputs(c=c, q=c.transform_to([1, 2, 3]), s=c.transform_to([3, 1, 2]))

    found = function(both).kernel.jacobians.operations
    monkeypatch.setattr(liegen.derive, "nested", as_it_is)
    assert found <= function(both).kernel.jacobians.operations


def test_requirements_are_nested_too() -> None:
    @factor
    def seen(x: SE3, *, S: SE3, p: R3) -> Any:
        q = (x @ S).transform_to(p)
        require(q[2] > 0, "in front")
        return q[:2]

    @factor
    def bare(x: SE3, *, z: R1) -> Any:
        return x.transform_to([1, 2, 3])[0] - z

    assert "compose" not in {n.operation.name for n in nested(seen.plain).nodes()}
    assert nested(bare.plain) is bare.plain
