"""What the reference says at one sample, on both logarithms where a half turn leaves the choice open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.trace import Graph

from . import reference
from .draws import Sample, Values, generator_for

Array = NDArray[np.float64]
#: Flat entries of outputs and Jacobians by name.
Entries = Mapping[str, Array]
EPS = float(np.finfo(np.float64).eps)


def both_branches(graph: Graph, sample: Sample) -> tuple[Entries, Entries]:
    """Flat entries of all outputs and Jacobians; the second time with the other logarithm at a half turn.

    Both are the same unless the last digits of the inputs decide which logarithm it is.
    """
    principal = _entries(graph, sample.values, flip=False)
    other = _outputs(graph, sample.values, flip=True)
    same = all(np.array_equal(principal[name], x, equal_nan=True) for name, x in other.items())
    if same or not _undecided(graph, sample, principal, other):
        return principal, principal
    return principal, _entries(graph, sample.values, flip=True)


def _undecided(graph: Graph, sample: Sample, principal: Entries, other: Entries) -> bool:
    """Whether the principal logarithm of some nearby inputs is nearer to ``other``."""
    for near in _nearby(graph, sample):
        for name, x in _outputs(graph, near, flip=False).items():
            apart = [float(np.abs(x - side[name]).max()) for side in (principal, other)]
            if apart[1] < apart[0]:
                return True
    return False


def _nearby(graph: Graph, sample: Sample) -> Iterator[Values]:
    """The inputs with every number moved by 16 units in the last place (zeros of those of 1), up or down."""
    generator = generator_for(graph.name, sample.case, "nearby")
    for _ in range(16):
        yield {
            name: tuple(
                x + (abs(x) or 1.0) * 16 * EPS * s
                for x, s in zip(v, generator.choice([-1.0, 1.0], len(v)), strict=True)
            )
            for name, v in sample.values.items()
        }


def _outputs(graph: Graph, values: Values, *, flip: bool) -> dict[str, Array]:
    elements = reference.outputs(graph, values, flip=flip)
    return {
        name: np.array(reference.to_coords(node.manifold, elements[name]), dtype=np.float64)
        for name, node in graph.outputs
    }


def _entries(graph: Graph, values: Values, *, flip: bool) -> dict[str, Array]:
    entries = _outputs(graph, values, flip=flip)
    jacobians: Any = reference.jacobians(graph, values, flip=flip)
    for name, _ in graph.outputs:
        for p in graph.parameters:
            if p.variable:
                rows = jacobians[name, p.name]
                entries[f"{name}_D_{p.name}"] = np.array([float(x) for row in rows for x in row])
    return entries
