"""What a Jacobian looks like in another convention, from the one that liegen derives.

A block J of the residual r by x is in liegen that of r(x Exp(d)) in the tangent order of the manifold. The
usual differences multiply it: an order permutes, a perturbation from the left, Exp(d) x, multiplies by
Ad(x^-1) from the right, half angles scale, and a block without Jr^-1(r) is Jr(r) J.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.charts import form_chart
from liegen.manifolds import Group, Node, Value, Vector
from liegen.manifolds.form import PoseForm, RotationForm
from liegen.trace import Graph

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Point:
    """A sample: arguments and residual."""

    values: Mapping[str, Value]
    residual: Array


#: A block in another convention from the block in liegen's.
Change = Callable[[Array, Point], Array]


@dataclass(frozen=True)
class Difference:
    """A way in which two conventions differ."""

    meaning: str
    change: Change


Choices = tuple[tuple[Difference, ...], ...]


def explanations(choices: Choices) -> Iterator[tuple[Difference, ...]]:
    """All combinations with at most one difference of each kind, those with fewer first."""
    picks = product(*[(None, *kind) for kind in choices])
    combined = [tuple(d for d in pick if d is not None) for pick in picks]
    yield from sorted(combined, key=len)


def of_jacobian(graph: Graph, variable: str) -> Choices:
    """The differences that a Jacobian by ``variable`` may have, in the order in which they apply."""
    manifold = next(p.manifold for p in graph.parameters if p.name == variable)
    form: Any = manifold.form
    kinds = [
        _missing_jr(graph),
        _side(manifold, variable),
        _half_angles(form),
        _order(form, variable, rows=False),
    ]
    return tuple(kind for kind in (*kinds, *of_residual(graph)) if kind)


def of_residual(graph: Graph) -> Choices:
    """The differences that the residual itself may have: they are those of the rows."""
    z = _measured(graph)
    sign = (Difference("the sign of the residual is opposite", lambda J, _: -J),)
    order = _order(z.manifold.form, "the residual", rows=True) if z else ()
    return tuple(kind for kind in (order, sign) if kind)


def _measured(graph: Graph) -> Node | None:
    """z where the residual is z.local(...)."""
    node = graph.outputs[0][1]
    return node.operands[0] if node.operation.name == "local" else None


def _missing_jr(graph: Graph) -> tuple[Difference, ...]:
    z = _measured(graph)
    group: Any = z.manifold if z else None
    if z is None or not issubclass(group, Group) or issubclass(group, Vector) or group.form.dim == 1:
        return ()
    chart = form_chart(group.form, graph.chart)
    if chart is None:
        return (
            Difference(
                "Jr^-1(res) is missing (right at zero residual only)",
                lambda J, p: np.asarray(group.Jr(p.residual)) @ J,
            ),
        )

    blocks: Any = chart.local_blocks()
    if blocks is None:
        return ()

    def change(J: Array, p: Point) -> Array:
        at: Any = p.values.get(z.operation.show, group.identity())
        r, x = tuple(p.residual), tuple(at.coords)
        chain: Any = blocks(r, x, chart.retract(x, r))[1]
        block: Array = reduce(np.matmul, [np.array(m, dtype=np.float64) for m in chain])
        return np.linalg.solve(block, J).astype(np.float64)

    return (Difference("the Jacobian of local at res is missing (right at zero residual only)", change),)


def _side(manifold: type[Value], variable: str) -> tuple[Difference, ...]:
    if not issubclass(manifold, Group) or issubclass(manifold, Vector):
        return ()

    def change(J: Array, p: Point) -> Array:
        x: Any = p.values[variable]
        return J @ x.inverse().adjoint()

    return (Difference(f"{variable} is perturbed from the left, Exp(d) {variable}", change),)


def _half_angles(form: Any) -> tuple[Difference, ...]:
    turns = _turns(form)
    if not turns.any():
        return ()

    def scaled(factor: float) -> Change:
        return lambda J, _: J * np.where(turns, factor, 1.0)

    return (
        Difference("rotations are given by half of the angle", scaled(2.0)),
        Difference("rotations are given by twice the angle", scaled(0.5)),
    )


def _order(form: Any, whose: str, *, rows: bool) -> tuple[Difference, ...]:
    if not isinstance(form, PoseForm):
        return ()
    turns = _turns(form)
    first, last = (~turns, turns) if form.rotation_first else (turns, ~turns)
    places = [*np.flatnonzero(first), *np.flatnonzero(last)]
    meaning = "translation before rotation" if form.rotation_first else "rotation before translation"
    change: Change = (lambda J, _: J[places]) if rows else (lambda J, _: J[:, places])
    return (Difference(f"the tangent of {whose} has the {meaning}", change),)


def _turns(form: Any) -> Any:
    """Which tangent coordinates are rotations."""
    if isinstance(form, RotationForm):
        return np.ones(form.dim, dtype=bool)
    if isinstance(form, PoseForm):
        parts = np.ones(form.rotation.dim, dtype=bool), np.zeros(form.rotation.space, dtype=bool)
        return np.concatenate(parts if form.rotation_first else parts[::-1])
    return np.zeros(form.dim, dtype=bool)
