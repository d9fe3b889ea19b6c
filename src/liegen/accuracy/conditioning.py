"""Where the stored numbers themselves limit what any method can compute: by how much at a sample."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from liegen.manifolds import Node
from liegen.trace import Graph
from liegen.verify.draws import Values
from liegen.verify.sphere_slack import slack_of

#: Directions with a smaller sine of their angle count as opposite.
ANTIPODE = 1e-12
#: w^2 = 1 - |v|^2 that is lost in the rounding of v.
LOST = 1e-12


def amplification(graph: Graph, values: Values, block: str) -> float:
    """How much a unit in the last place of the inputs grows; infinite where nothing is left.

    1/sine of the angle between directions beyond a quarter turn. For ``retract`` by the vector part v of a
    quaternion 1/w, w = sqrt(1 - |v|^2), and 1/w^2 for its Jacobian by the coordinates.
    """
    sphere = slack_of(graph, values)
    grown = [1.0, np.inf if sphere * ANTIPODE >= 1 else sphere]
    for name, square in _vector_parts(graph, values):
        if square < LOST:
            return np.inf
        grown.append(1 / square if block.endswith(f"_D_{name}") else square**-0.5)
    return max(grown)


def takes_vector_part(node: Node) -> bool:
    """Whether it is ``retract`` in space by the vector part of a quaternion."""
    presets: Any = getattr(node.operation, "parameters", ())
    return (
        node.operation.name == "retract"
        and node.operands[0].manifold.form.name in ("SO3", "SE3")
        and any(p.space.rotation == "quaternion-vector" for p in presets)
    )


def _vector_parts(graph: Graph, values: Values) -> Iterator[tuple[str, float]]:
    """The names of coordinates of such a ``retract``, and w^2; what is not a parameter is left out."""
    names = {p.node: p.name for p in graph.parameters}
    for node in filter(takes_vector_part, graph.nodes()):
        d = names.get(node.operands[1])
        if d:
            (preset,) = node.operation.parameters  # type: ignore[attr-defined]
            turn = (
                values[d] if len(values[d]) == 3 or preset.space.order == "rotation-first" else values[d][3:]
            )
            v = np.array(turn[:3]) * preset.space.scale / 2
            yield d, 1.0 - float(v @ v)
