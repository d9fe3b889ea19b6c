"""What the reference says at one sample, on both logarithms where a half turn leaves the choice open."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
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


#: Flat entries of the Jacobians at stored values; the flag takes the other logarithm at a half turn.
Slopes = Callable[[Values, bool], Entries]


def both_branches(graph: Graph, sample: Sample, slopes: Slopes | None = None) -> tuple[Entries, Entries]:
    """Flat entries of all outputs and Jacobians; the second time with the other logarithm at a half turn.

    Both are the same unless the last digits of the inputs decide which logarithm it is. ``slopes`` are the
    Jacobians, by default the derivatives of the outputs.
    """
    jacobians = slopes or partial(_derivatives, graph)
    own, other = (_outputs(graph, sample.values, flip=flip) for flip in (False, True))
    principal = {**own, **jacobians(sample.values, False)}
    same = all(np.array_equal(own[name], x, equal_nan=True) for name, x in other.items())
    if same or not _undecided(graph, sample, own, other):
        return principal, principal
    return principal, {**other, **jacobians(sample.values, True)}


def _undecided(graph: Graph, sample: Sample, principal: Entries, other: Entries) -> bool:
    """Whether the principal logarithm of some nearby inputs is nearer to ``other``."""
    for near in nearby(graph, sample):
        for name, x in _outputs(graph, near, flip=False).items():
            apart = [float(np.abs(x - side[name]).max()) for side in (principal, other)]
            if apart[1] < apart[0]:
                return True
    return False


def nearby(graph: Graph, sample: Sample) -> Iterator[Values]:
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
        name: np.array(
            reference.to_coords(node.manifold, elements[name], layout=graph.layout), dtype=np.float64
        )
        for name, node in graph.outputs
    }


def _derivatives(graph: Graph, values: Values, flip: bool) -> Entries:
    jacobians: Any = reference.jacobians(graph, values, flip=flip)
    return {f"{name}_D_{variable}": np.array(flat(rows)) for (name, variable), rows in jacobians.items()}


def flat(rows: Iterable[Iterable[Any]]) -> list[float]:
    """The entries of a matrix, row by row, as doubles."""
    return [float(x) for row in rows for x in row]
