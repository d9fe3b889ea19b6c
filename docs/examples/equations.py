"""A pose graph as normal equations: its factors, where its unknowns are, how a step is applied."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import liegen_groups
import numpy as np
from g2o import Floats, Graph, Indices, roots
from g2o_lines import EDGES, VERTEX

import liegen
from liegen import R2, R3, SE2, SE3, factor, library
from liegen.runtime.normal_equations import Terms

# --- the factors: those that the library has not are one line each ----------------------------------------


@factor
def point_se2(x: SE2, y: R2, *, z: R2):
    """z measures the point y in the frame of x [m]."""
    return x.transform_to(y) - z


@factor
def point_se3(x: SE3, y: R3, *, z: R3):
    """z measures the point y in the frame of x [m]."""
    return x.transform_to(y) - z


@factor
def position_se2(x: SE2, *, z: R2):
    """z measures the position of x in the world [m]."""
    return x.translation - z


@factor
def position_se3(x: SE3, *, z: R3):
    """z measures the position of x in the world [m]."""
    return x.translation - z


FACTORS: dict[str, liegen.Function] = {
    "EDGE_SE2": library.between_se2,
    "EDGE_SE3:QUAT": library.between_se3,
    "EDGE_SE2_XY": point_se2,
    "EDGE_SE3_TRACKXYZ": point_se3,
    "EDGE_BEARING_SE2_XY": library.bearing_se2_r2,
    "EDGE_POINTXY": library.between_r2,
    "EDGE_POINTXYZ": library.between_r3,
    "EDGE_PRIOR_SE2": library.prior_se2,
    "EDGE_SE3_PRIOR": library.prior_se3,
    "EDGE_PRIOR_SE2_XY": position_se2,
    "EDGE_SE3_XYZ_PRIOR": position_se3,
    "EDGE_PRIOR_XY": library.prior_r2,
    "EDGE_POINTXYZ_PRIOR": library.prior_r3,
}


# --- the unknowns: arrays of vertices by manifold, and a step d of all that are free ----------------------

Values = Mapping[str, Floats]
DIM = {"SE2": 3, "SE3": 6, "R2": 2, "R3": 3}
RETRACT: dict[str, Callable[[Floats, Floats], Floats]] = {
    "SE2": liegen_groups.se2_retract,
    "SE3": liegen_groups.se3_retract,
    "R2": np.add,
    "R3": np.add,
}


def start(graph: Graph) -> Values:
    return {name: own.values for name, own in graph.vertices.items()}


def retracted(graph: Graph, values: Values, d: Floats) -> Values:
    """The values after a step (n,): first all poses, then all points, those that are held left out."""
    found: dict[str, Floats] = {}
    for name, own in graph.vertices.items():
        free = ~own.held
        mine, d = np.split(d, [DIM[name] * np.count_nonzero(free)])
        found[name] = values[name].copy()
        found[name][free] = RETRACT[name](values[name][free], mine.reshape(-1, DIM[name]))
    return found


def block_numbers(graph: Graph) -> dict[str, Indices]:
    """Where each vertex is in a step; -1 for one that is held."""
    numbers: dict[str, Indices] = {}
    used = 0
    for name, own in graph.vertices.items():
        free = ~own.held
        numbers[name] = np.where(free, used + np.cumsum(free) - 1, -1)
        used += np.count_nonzero(free)
    return numbers


# --- the equations ----------------------------------------------------------------------------------------


def system_of(graph: Graph) -> Callable[[Values], Terms]:
    """The function values -> (cost, g, H) of all edges. What never changes is prepared once."""
    numbers = block_numbers(graph)
    factors, blocks, given = [], [], []
    for tag, edges in graph.edges.items():
        manifolds = [VERTEX[end].manifold for end in EDGES[tag].ends]
        ends = dict(zip("xy", edges.ends.T, strict=False))
        kernel = liegen.compile(FACTORS[tag].whitened(noise="full"))
        factors.append(kernel.indexed(**ends))
        blocks.append({v: numbers[m][ends[v]] for v, m in zip(ends, manifolds, strict=True)})
        measured = {"z": edges.measurements, "sqrt_info": roots(edges.information)}
        given.append((dict(zip(ends, manifolds, strict=True)), measured))
    equations = liegen.NormalEquations(factors, blocks)

    def at(values: Values) -> Terms:
        return equations(*({v: values[m] for v, m in ends.items()} | z for ends, z in given))

    return at
