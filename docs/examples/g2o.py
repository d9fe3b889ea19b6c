"""Read a 2D or 3D pose graph from a `.g2o` file, in liegen's storage and tangent order.

The format (one record a line, `#` starts a comment):

    VERTEX_SE2 id  x y theta                    EDGE_SE2 i j  dx dy dtheta  I11 I12 I13 I22 I23 I33
    VERTEX_SE3:QUAT id  x y z qx qy qz qw       EDGE_SE3:QUAT i j  x y z qx qy qz qw  I11 I12 ... I66
    FIX id ...

Metres and radians. An edge measures pose j in the frame of pose i. Its information matrix (the inverse
covariance) is an upper triangle, row by row, in the order (translation, rotation). It is taken as that of the
tangent vector (x, y, angle) or (translation, rotation vector). `FIX` holds poses where they start.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class G2oError(ValueError):
    """A file that is no usable pose graph; the message has the file, the line and the cure."""


@dataclass(frozen=True)
class Graph:
    """N poses and E measurements of relative poses, every field one array."""

    group: str  # "SE2" or "SE3"
    poses: Floats  # (N, 4) cos, sin, x, y   or   (N, 7) qx, qy, qz, qw, x, y, z
    i: Indices  # (E,) the pose in whose frame the edge was measured
    j: Indices  # (E,) the measured pose
    measurements: Floats  # (E, 4) or (E, 7), stored like the poses
    information: Floats  # (E, k, k) in liegen's tangent order
    held: Indices  # the poses of FIX lines, else the first
    ids: Indices  # (N,) the ids in the file
    left_out: dict[str, int] = field(default_factory=dict)  # unknown tags and how many lines had them


@dataclass(frozen=True)
class Format:
    """How one group is written in a file."""

    group: str
    values: str  # the numbers of a pose
    width: int  # how many
    to_storage: Callable[[Floats], Floats]  # (..., width) in the file's order -> liegen's storage
    tangent: tuple[int, ...]  # liegen's tangent order in terms of the file's


def se2_storage(values: Floats) -> Floats:
    x, y, theta = np.moveaxis(values, -1, 0)
    return np.stack([np.cos(theta), np.sin(theta), x, y], axis=-1)


def se3_storage(values: Floats) -> Floats:
    """Files print few digits, so quaternions are made unit again."""
    translation, quaternion = values[..., :3], values[..., 3:]
    norm = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return np.concatenate([quaternion / norm, translation], axis=-1)


SE2 = Format("SE2", "x y theta", 3, se2_storage, (0, 1, 2))
SE3 = Format("SE3", "x y z qx qy qz qw", 7, se3_storage, (3, 4, 5, 0, 1, 2))
VERTEX = {"VERTEX_SE2": SE2, "VERTEX_SE3:QUAT": SE3}
EDGE = {"EDGE_SE2": SE2, "EDGE_SE3:QUAT": SE3}


@dataclass(frozen=True)
class Record:
    line: int
    tag: str
    ids: list[int]
    values: list[float]


def read_g2o(path: Path) -> Graph:
    """Read a pose graph; raise `G2oError` with the line number where the file is wrong."""
    records: list[Record] = []
    left_out: Counter[str] = Counter()
    with path.open(encoding="utf-8", errors="replace") as lines:
        for number, text in enumerate(lines, start=1):
            tag, *words = text.partition("#")[0].split() or [""]
            if tag in VERTEX or tag in EDGE or tag == "FIX":
                records.append(parse_record(path, number, tag, words))
            elif tag:
                left_out[tag] += 1
    return build_graph(path, records, dict(left_out))


def parse_record(path: Path, line: int, tag: str, words: Sequence[str]) -> Record:
    where = f"{path.name}:{line}"
    n_ids, n_values, layout = expected_layout(tag, len(words))
    if len(words) != n_ids + n_values:
        raise G2oError(
            f"{where}: {tag} needs {n_ids + n_values} numbers ({layout}) but has {len(words)}. "
            "Is the line cut short, or are two lines joined?"
        )
    try:
        record = Record(line, tag, [int(w) for w in words[:n_ids]], [float(w) for w in words[n_ids:]])
    except ValueError as error:
        raise G2oError(f"{where}: {tag} needs numbers ({layout}), ids whole: {error}.") from None
    if not np.all(np.isfinite(record.values)):
        raise G2oError(f"{where}: {tag} has a number that is not finite. Remove or correct the line.")
    if tag.endswith(":QUAT") and abs(np.linalg.norm(record.values[3:7]) - 1) > 0.01:
        raise G2oError(
            f"{where}: the quaternion of {tag} has length {np.linalg.norm(record.values[3:7]):.4g}, not 1. "
            "The order is x y z qx qy qz qw."
        )
    return record


def expected_layout(tag: str, found: int) -> tuple[int, int, str]:
    """Ids, values, and their names on a line with this tag."""
    if tag == "FIX":
        return max(found, 1), 0, "id ..."
    if tag in VERTEX:
        return 1, VERTEX[tag].width, f"id {VERTEX[tag].values}"
    k = len(EDGE[tag].tangent)
    return 2, EDGE[tag].width + k * (k + 1) // 2, f"i j {EDGE[tag].values} and I11 I12 ... I{k}{k}"


def build_graph(path: Path, records: Sequence[Record], left_out: dict[str, int]) -> Graph:
    vertices = [r for r in records if r.tag in VERTEX]
    edges = [r for r in records if r.tag in EDGE]
    form = common_format(path, vertices, edges, left_out)
    index = index_of_ids(path, vertices, records)
    held = [index[v] for r in records if r.tag == "FIX" for v in r.ids]
    values = np.array([e.values for e in edges])
    graph = Graph(
        group=form.group,
        poses=form.to_storage(np.array([v.values for v in vertices])),
        i=np.array([index[e.ids[0]] for e in edges]),
        j=np.array([index[e.ids[1]] for e in edges]),
        measurements=form.to_storage(values[:, : form.width]),
        information=full_matrices(values[:, form.width :], form.tangent),
        held=np.unique(held or [0]),
        ids=np.array(list(index)),
        left_out=left_out,
    )
    for row in np.flatnonzero(np.linalg.eigvalsh(graph.information)[:, 0] <= 0)[:1]:
        raise G2oError(
            f"{path.name}:{edges[row].line}: the information matrix is not positive definite. It is the "
            "inverse of a covariance; the line has the rows of its upper triangle."
        )
    require_connected(path, graph)
    return graph


def common_format(
    path: Path, vertices: Sequence[Record], edges: Sequence[Record], left_out: dict[str, int]
) -> Format:
    formats = {r.tag: (VERTEX | EDGE)[r.tag] for r in (*vertices, *edges)}
    if not vertices or not edges:
        unknown = f" Unknown tags: {', '.join(left_out)}." if left_out else ""
        raise G2oError(
            f"{path.name}: has {len(vertices)} poses and {len(edges)} edges; a pose graph needs both, "
            f"{' or '.join(VERTEX)} lines and {' or '.join(EDGE)} lines.{unknown}"
        )
    if len({f.group for f in formats.values()}) > 1:
        raise G2oError(f"{path.name}: mixes 2D and 3D ({', '.join(formats)}). Split the file.")
    return VERTEX[vertices[0].tag]


def index_of_ids(path: Path, vertices: Sequence[Record], records: Sequence[Record]) -> dict[int, int]:
    """Ids need not be contiguous; poses keep the order of the file."""
    index: dict[int, int] = {}
    for number, vertex in enumerate(vertices):
        if index.setdefault(vertex.ids[0], number) != number:
            raise G2oError(f"{path.name}:{vertex.line}: pose {vertex.ids[0]} is there twice. Remove one.")
    for record in records:
        where = f"{path.name}:{record.line}: {record.tag}"
        for missing in (v for v in record.ids if v not in index):
            raise G2oError(f"{where} names pose {missing}, which has no vertex line. Add its initial pose.")
        if record.tag in EDGE and record.ids[0] == record.ids[1]:
            raise G2oError(f"{where} joins pose {record.ids[0]} to itself. Remove the line.")
    return index


def require_connected(path: Path, graph: Graph) -> None:
    """Each pose needs a chain of edges to a held pose, or nothing determines it."""
    n = len(graph.poses)
    links = coo_array((np.ones(len(graph.i)), (graph.i, graph.j)), shape=(n, n))
    _, part = connected_components(links, directed=False)
    loose = graph.ids[~np.isin(part, part[graph.held])]
    if loose.size:
        raise G2oError(
            f"{path.name}: {loose.size} poses, the first with id {loose[0]}, are joined by no chain of edges "
            f"to a held pose. Remove them, or add edges, or `FIX {graph.ids[graph.held[0]]} {loose[0]}`."
        )


def full_matrices(upper: Floats, order: Sequence[int]) -> Floats:
    """Symmetric (E, k, k) matrices from upper triangles (E, k (k+1)/2), rows and columns put into `order`."""
    k = len(order)
    rows, columns = np.triu_indices(k)
    full = np.empty((len(upper), k, k))
    full[:, rows, columns] = upper
    full[:, columns, rows] = upper
    return full[:, order][:, :, order]
