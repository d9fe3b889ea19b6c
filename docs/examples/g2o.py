"""Read and write a 2D or 3D pose graph, with landmarks and priors, in liegen's storage and tangent order.

`g2o_lines.py` has the lines of the format. An edge's information matrix (the inverse covariance) is an upper
triangle, row by row, in the order (translation, rotation). It is taken as that of the tangent vector
(x, y, angle) or (translation, rotation vector), and may be zero in directions that were not measured.
`FIX` holds vertices where they start; without it, and without a prior, the first pose is held.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import liegen_groups
import numpy as np
from g2o_lines import EDGES, FIX, OFFSET, POSE, POSE3, VERTEX, EdgeKind, Floats, G2oError, Kind, Record, parse
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Indices = NDArray[np.int64]
#: Eigenvalues of an information matrix so far below 0, on its own scale, are left by the digits of the file.
ROUNDING = 1e-5


@dataclass(frozen=True)
class Vertices:
    """N poses or points of one manifold."""

    ids: Indices  # (N,) in the file
    values: Floats  # (N, n) in liegen's storage
    held: NDArray[np.bool_]  # (N,) which stay where they are
    lines: Indices  # (N,) in the file


@dataclass(frozen=True)
class Edges:
    """E measurements with one tag; `ends[:, k]` counts in the vertices of the k-th end's manifold."""

    ends: Indices  # (E, 1) or (E, 2)
    measurements: Floats  # (E, n) in liegen's storage
    information: Floats  # (E, m, m) in liegen's tangent order


@dataclass(frozen=True)
class Graph:
    """A file's vertices by manifold, and edges by tag."""

    vertices: Mapping[str, Vertices]  # "SE2" and "R2", or "SE3" and "R3"
    edges: Mapping[str, Edges]
    lines: Sequence[str]  # the file

    @property
    def group(self) -> str:
        """That of the poses."""
        return next(name for name in self.vertices if name.startswith("SE"))


def read_g2o(path: Path) -> Graph:
    """Read a pose graph; raise `G2oError` with the line number where the file is wrong."""
    # Some editors begin a file with a byte order mark.
    return read_lines(path.name, path.read_text(encoding="utf-8-sig", errors="surrogateescape").split("\n"))


def read_lines(name: str, lines: Sequence[str]) -> Graph:
    """The graph of a file with this name and these lines."""
    records = parse(name, lines)
    vertices = [r for r in records if r.tag in VERTEX]
    edges = [r for r in records if r.tag in EDGES]
    require_parts(name, vertices, edges)
    places = places_of_ids(name, vertices, records)
    held = {v for r in records if r.tag == FIX for v in r.ids}
    anchors = {r.ids[0] for r in edges if len(r.ids) == 1}
    if not held | anchors:
        held = {next(r.ids[0] for r in vertices if r.tag in POSE)}
    require_connected(name, vertices, edges, held | anchors)
    if held >= places.keys():
        last = max(r.line for r in records if r.tag == FIX)
        raise G2oError(f"{name}:{last}: every vertex is fixed, so there is nothing to solve. Remove a FIX.")
    offsets = offsets_of_ids(name, records)
    by_tag: defaultdict[str, list[Record]] = defaultdict(list)
    for record in (*vertices, *edges):
        by_tag[record.tag].append(record)
    return Graph(
        {VERTEX[t].manifold: vertices_of(VERTEX[t], r, held) for t, r in by_tag.items() if t in VERTEX},
        {t: edges_of(name, EDGES[t], r, places, offsets) for t, r in by_tag.items() if t in EDGES},
        lines,
    )


def written(graph: Graph, values: Mapping[str, Floats]) -> str:
    """The graph's file with these values of its vertices; all other lines stay as they are."""
    lines = list(graph.lines)
    for tag, kind in VERTEX.items():
        if kind.manifold not in graph.vertices:
            continue
        rows, own = kind.to_file(values[kind.manifold]), graph.vertices[kind.manifold]
        for number, line, row in zip(own.ids, own.lines, rows, strict=True):
            lines[line - 1] = " ".join([tag, str(number), *(f"{float(v)!r}" for v in row)])
    return "\n".join(lines)


def vertices_of(kind: Kind, records: Sequence[Record], held: set[int]) -> Vertices:
    return Vertices(
        np.array([r.ids[0] for r in records]),
        kind.to_storage(np.array([r.values for r in records])),
        np.array([r.ids[0] in held for r in records]),
        np.array([r.line for r in records]),
    )


def edges_of(
    name: str,
    kind: EdgeKind,
    records: Sequence[Record],
    places: Mapping[int, int],
    offsets: Mapping[int, Floats],
) -> Edges:
    values = np.array([r.values for r in records])
    measured, upper = values[:, : kind.measured.width], values[:, kind.measured.width :]
    information = full_matrices(upper, kind.measured.tangent)
    for row in np.flatnonzero(~semidefinite(information))[:1]:
        raise G2oError(
            f"{name}:{records[row].line}: the information matrix is not positive semidefinite. It is the "
            "inverse of a covariance; the line has the rows of its upper triangle."
        )
    z = kind.measured.to_storage(measured)
    if kind.offset and len(kind.measured.tangent) == 6:
        z, information = of_body(z, information, offsets_of(name, records, offsets))
    elif kind.offset and len(kind.ends) == 2:
        z, information = point_of_body(z, information, offsets_of(name, records, offsets))
    elif kind.offset:
        offsets_of(name, records, offsets)  # the format asks for it, the measurement is of the body itself
    return Edges(np.array([[places[v] for v in r.ids] for r in records]), z, information)


def full_matrices(upper: Floats, order: Sequence[int]) -> Floats:
    """Symmetric (E, k, k) matrices from upper triangles (E, k (k+1)/2), rows and columns put into `order`."""
    k = len(order)
    rows, columns = np.triu_indices(k)
    full = np.empty((len(upper), k, k))
    full[:, rows, columns] = upper
    full[:, columns, rows] = upper
    return full[:, order][:, :, order]


# --- information matrices: units differ (1/m^2, 1/rad^2), so each is judged on its own scale ---------------


def scales(information: Floats) -> tuple[Floats, Floats]:
    """The square root s (E, k) of the diagonal, and I / (s s^T) (E, k, k), with 1 (or 0) on its diagonal."""
    s = np.sqrt(np.maximum(np.diagonal(information, axis1=1, axis2=2), 0))
    inverse = np.divide(1, s, out=np.zeros_like(s), where=s > 0)
    return s, inverse[:, :, None] * information * inverse[:, None, :]


def semidefinite(information: Floats) -> NDArray[np.bool_]:
    """Which matrices (E, k, k) are, up to the digits that files print."""
    s, scaled = scales(information)
    restored = s[:, :, None] * scaled * s[:, None, :]
    # Where a diagonal entry is 0 the whole row is, or the matrix is indefinite.
    whole = np.all(np.isclose(restored, information, rtol=1e-9, atol=0), axis=(1, 2))
    return whole & (np.linalg.eigvalsh(scaled)[:, 0] >= -ROUNDING)


def roots(information: Floats) -> Floats:
    """Upper triangular S (E, k, k) with S^T S = information, which may be singular."""
    s, scaled = scales(information)
    values, vectors = np.linalg.eigh(scaled)
    factor = np.sqrt(np.maximum(values, 0))[:, :, None] * vectors.transpose(0, 2, 1) * s[:, None, :]
    return np.linalg.qr(factor, mode="r")


# --- a sensor beside the body's origin: the measurement as one of the body ----------------------------------


def of_body(z: Floats, information: Floats, offset: Floats) -> tuple[Floats, Floats]:
    """Log(z^-1 x o) = Ad(o^-1) Log((z o^-1)^-1 x): a prior of the pose x o as one of x."""
    inverse = liegen_groups.se3_inverse(offset)
    return liegen_groups.se3_compose(z, inverse), turned(information, liegen_groups.se3_adjoint(inverse))


def point_of_body(z: Floats, information: Floats, offset: Floats) -> tuple[Floats, Floats]:
    """(x o)^-1 p - z = R_o^T (x^-1 p - o z)."""
    rotation = liegen_groups.se3_adjoint(offset)[:, :3, :3]
    return liegen_groups.se3_act(offset, z), turned(information, rotation.transpose(0, 2, 1))


def turned(information: Floats, matrix: Floats) -> Floats:
    """Information of v, given that of `matrix` v."""
    found = matrix.transpose(0, 2, 1) @ information @ matrix
    return (found + found.transpose(0, 2, 1)) / 2


# --- what a file must have --------------------------------------------------------------------------------


def require_parts(name: str, vertices: Sequence[Record], edges: Sequence[Record]) -> None:
    poses = [r for r in vertices if r.tag in POSE]
    if not poses or not edges:
        raise G2oError(
            f"{name}: has {len(poses)} poses and {len(edges)} edges; a pose graph needs both, "
            f"{' or '.join(POSE)} lines and lines such as {' or '.join(list(EDGES)[:2])}."
        )
    spaces = [VERTEX[r.tag].space if r.tag in VERTEX else EDGES[r.tag].measured.space for r in poses + edges]
    spaces += [VERTEX[r.tag].space for r in vertices]
    for record, space in zip((*poses, *edges, *vertices), spaces, strict=True):
        if space != spaces[0]:
            raise G2oError(
                f"{name}:{record.line}: mixes 2D and 3D: {record.tag} in a file with {poses[0].tag}. "
                "Split the file."
            )


def places_of_ids(name: str, vertices: Sequence[Record], records: Sequence[Record]) -> dict[int, int]:
    """Where each id is among the vertices with its tag; ids need not be contiguous."""
    tags: dict[int, str] = {}
    places: dict[int, int] = {}
    counts: defaultdict[str, int] = defaultdict(int)
    for vertex in vertices:
        key = vertex.ids[0]
        if key in tags:
            raise G2oError(f"{name}:{vertex.line}: vertex {key} is there twice. Remove one.")
        tags[key], places[key] = vertex.tag, counts[vertex.tag]
        counts[vertex.tag] += 1
    for record in records:
        where = f"{name}:{record.line}: {record.tag}"
        ids = record.ids if record.tag in EDGES or record.tag == FIX else ()
        for missing in (v for v in ids if v not in tags):
            raise G2oError(f"{where} names vertex {missing}, which has no line. Add its initial value.")
        for key, tag in zip(ids, EDGES[record.tag].ends if record.tag in EDGES else (), strict=False):
            if tags[key] != tag:
                raise G2oError(f"{where} names vertex {key}, a {tags[key]}, where it needs a {tag}.")
        if record.tag in EDGES and len(set(ids)) < len(ids):
            raise G2oError(f"{where} joins vertex {ids[0]} to itself. Remove the line.")
    return places


def offsets_of_ids(name: str, records: Sequence[Record]) -> dict[int, Floats]:
    found: dict[int, Floats] = {}
    for record in (r for r in records if r.tag == OFFSET):
        if record.ids[0] in found:
            raise G2oError(f"{name}:{record.line}: {OFFSET} {record.ids[0]} is there twice. Remove one.")
        found[record.ids[0]] = POSE3.to_storage(np.array(record.values))
    return found


def offsets_of(name: str, records: Sequence[Record], offsets: Mapping[int, Floats]) -> Floats:
    for record in records:
        if record.offset not in offsets:
            raise G2oError(
                f"{name}:{record.line}: {record.tag} names offset {record.offset}, which has no line. "
                f"For a sensor at the origin of the body add `{OFFSET} {record.offset} 0 0 0 0 0 0 1`."
            )
    return np.array([offsets[r.offset] for r in records if r.offset is not None])


def require_connected(
    name: str, vertices: Sequence[Record], edges: Sequence[Record], anchors: set[int]
) -> None:
    """Each vertex needs a chain of edges to one that is held or has a prior, or nothing determines it."""
    number = {r.ids[0]: k for k, r in enumerate(vertices)}
    pairs = np.array([[number[v] for v in r.ids] for r in edges if len(r.ids) == 2]).reshape(-1, 2)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(number), len(number)))
    _, part = connected_components(links, directed=False)
    loose = np.flatnonzero(~np.isin(part, part[[number[v] for v in anchors]]))
    if loose.size:
        first = vertices[loose[0]]
        raise G2oError(
            f"{name}:{first.line}: {loose.size} vertices, the first with id {first.ids[0]}, are joined by no "
            f"chain of edges to a held one. Remove them, or add edges, or "
            f"`FIX {' '.join(str(v) for v in (min(anchors), first.ids[0]))}`."
        )
