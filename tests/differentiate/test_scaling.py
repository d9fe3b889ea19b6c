"""Longer formulas: what tracing and derivation do grows about as the formula does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import pytest

from call_counts import calls
from liegen import R1, R, factor, library, sin, stack
from liegen.algebra.linear import eye, selection
from liegen.choice import Ledger
from liegen.differentiate import expressions, ladder, linearised
from liegen.gauss_newton import BUDGET
from liegen.manifolds.vector_operations import join


def vectors(n: int) -> type[R]:
    return type(f"R{n}", (R,), {}, dim=n)


def neighbours(n: int) -> Any:
    """A sum of n terms, each of two entries of x."""

    def summed(x: Any, *, z: R1) -> Any:
        total = x[0] * x[0]
        for k in range(1, n):
            total = total + sin(x[k]) * x[k - 1]
        return total - z

    summed.__annotations__ = {"x": vectors(n), "z": R1}
    return summed


def stacked(n: int) -> Any:
    """All entries, stacked in the other order."""

    def turned(x: Any) -> Any:
        return stack(*[x[k] for k in reversed(range(n))])

    turned.__annotations__ = {"x": vectors(n)}
    return turned


@pytest.mark.parametrize("make", [neighbours, stacked])
def test_tracing_grows_as_the_terms(make: Callable[[int], Any]) -> None:
    factor(make(3))
    short, long = (calls(partial(factor, f)) for f in (make(50), make(400)))
    assert long < 9 * short


@pytest.mark.parametrize("rows", [[0], [3], range(2, 5), [4, 0, 4], [], range(5)])
def test_selected_rows_are_those_of_the_identity(rows: Sequence[int]) -> None:
    assert selection(5, rows) == tuple(eye(5)[k] for k in rows)
    assert all(type(x) is int for row in selection(5, rows) for x in row)


@pytest.mark.parametrize("sizes", [(2, 3, 1), (1, 4), (3,)])
def test_each_part_of_a_stack_is_at_its_own_rows(sizes: tuple[int, ...]) -> None:
    blocks: Any = join(vectors(sum(sizes)), sizes).blocks
    columns = [column for ((*rows,),) in blocks() for column in zip(*rows, strict=True)]
    assert tuple(columns) == eye(sum(sizes))


def test_gauss_newton_terms_grow_as_the_summands(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    taken = Ledger.taken

    def counted(ledger: Ledger, make: Any) -> bytes | None:
        before = len(ledger.operands)
        found = taken(ledger, make)
        made.append(len(ledger.operands) - before)
        return found

    monkeypatch.setattr(Ledger, "taken", counted)
    nodes: list[int] = []
    for n in (25, 100):
        f = factor(neighbours(n))
        f.kernel  # noqa: B018
        made.clear()
        assert f.gauss_newton_kernel.value.operations < n * (n + 1) / 2 + 8 * n
        assert len(made) < 2 * n
        nodes.append(sum(made))
    assert 0 < nodes[1] < 6 * nodes[0], nodes


def ladder_of(f: Any) -> Any:
    graph = f.plain
    return ladder(linearised(graph, expressions(graph))[0])


def test_all_frontiers_of_the_librarys_factors_are_tried():
    for f in (library.between_se3, library.between_se2, library.prior_se3):
        steps = ladder_of(f)
        assert len(steps.frontiers) >= 2
        assert steps.worth_trying(BUDGET) == steps.frontiers
        assert sum(map(steps.entries, steps.frontiers)) < BUDGET / 100


def test_of_long_ladders_the_last_frontiers_are_tried():
    steps = ladder_of(factor(neighbours(100)))
    tried = steps.worth_trying(BUDGET)
    assert 1 < len(tried) < len(steps.frontiers) / 2
    assert tried == steps.frontiers[-len(tried) :]
    others = sum(map(steps.entries, tried[:-1]))
    assert others <= BUDGET < others + steps.entries(steps.frontiers[-len(tried) - 1])
    assert steps.worth_trying(0) == steps.frontiers[-1:]
