"""How ill-conditioned directions on S2 are at a sample: beyond a quarter turn by the sine of their angle."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.manifolds import ManifoldForm
from liegen.trace import Graph

from . import reference
from .draws import Values

Array = NDArray[np.float64]


def slack_of(graph: Graph, values: Values) -> float:
    """1/sine of the largest angle beyond a quarter turn between directions; infinite at the antipode.

    Directions that are parts of products count too.
    """
    logs = [
        n for n in graph.nodes() if n.operation.name == "local" and has_sphere(n.operands[0].manifold.form)
    ]
    if not logs:
        return 1.0
    evaluation = reference.evaluate(graph, values)
    pairs = [
        pair
        for node in logs
        for pair in _directions(node.operands[0].manifold.form, *(evaluation[n] for n in node.operands))
    ]
    return max(_slack(*(np.array(v, dtype=np.float64) for v in pair)) for pair in pairs)


def _slack(x: Array, y: Array) -> float:
    sine = float(np.linalg.norm(np.cross(x, y)))
    if float(x @ y) >= 0:
        return 1.0
    return 1 / sine if sine else float("inf")


def has_sphere(form: ManifoldForm) -> bool:
    """Whether it is S2 or a product with it."""
    return form.name == "S2" or any(map(has_sphere, form.parts))


def _directions(form: ManifoldForm, x: Any, y: Any) -> Iterator[tuple[Any, Any]]:
    """The pairs of directions in two elements."""
    if form.name == "S2":
        yield x, y
    for part, a, b in zip(form.parts, x, y, strict=True) if form.parts else ():
        yield from _directions(part, a, b)
