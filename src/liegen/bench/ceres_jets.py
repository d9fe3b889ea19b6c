"""Ceres: hand-written C++ templates on its Jets, one Jet column for every column of the Jacobians.

Variables come with the derivative of their storage by a right perturbation already in the Jets: what
``AutoDiffCostFunction`` and a manifold's ``PlusJacobian`` compute in two steps, in one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from liegen.emit.templates import lay_out
from liegen.manifolds import ManifoldForm

from .programs import prototype
from .variant import AbsentError, Task, Variant, offsets

NAME = "Ceres"
SYMBOL = "ceres_call"
HEADERS = ("rotation.h", "pose.h", "sensors.h", "motion.h", "tangent.h")
#: Functions of tangent.h by manifold; vectors take their size.
SEEDS = {"SO3": "seed_rotation", "SE3": "seed_pose", "SE2": "seed_planar"}
#: Where the system keeps Ceres and its version.
VERSION_FILE = Path("/usr/include/ceres/version.h")
OPTIONS = ("-I/usr/include/eigen3", "-DNDEBUG")


@dataclass(frozen=True)
class Leaf:
    """A part of a value that is no product, and where it begins in storage and tangent."""

    form: ManifoldForm
    stored: int
    column: int


@dataclass(frozen=True)
class Variable:
    """An argument as Jets, and the C++ that seeds them."""

    name: str
    size: int
    seeds: tuple[str, ...]


@dataclass(frozen=True)
class Block:
    """A Jacobian: which columns of the Jets, and where it goes."""

    column: int
    columns: int
    start: int


def variants(task: Task) -> tuple[Variant, ...]:
    """Its Jets; nothing but the published functions, whose formulas are written by hand."""
    headers = {name: lay_out(f"bench/ceres/{name}", {}) for name in HEADERS}
    if not task.published or f" {task.name}(" not in "".join(headers.values()):
        return ()
    version = _version()
    text = _wrapper(task)
    return (
        Variant(
            NAME, version, "Jets", prototype(SYMBOL), (f"{SYMBOL}(a, b);",),
            {**headers, f"{SYMBOL}.cc": text}, options=OPTIONS,
        ),
    )  # fmt: skip


def _version() -> str:
    if not VERSION_FILE.is_file():
        raise AbsentError(f"there is no {VERSION_FILE}; it comes with the system's package (libceres-dev)")
    found = re.findall(r"define CERES_VERSION_(?:MAJOR|MINOR|REVISION) (\d+)", VERSION_FILE.read_text())
    return ".".join(found)


def _leaves(form: ManifoldForm, stored: int = 0, column: int = 0) -> Iterator[Leaf]:
    if not form.parts:
        yield Leaf(form, stored, column)
    for part in form.parts:
        yield from _leaves(part, stored, column)
        stored, column = stored + part.size, column + part.dim


def _wrapper(task: Task) -> str:
    graph = task.function.graph
    variables: list[Variable] = []
    blocks: list[Block] = []
    arguments: list[str] = []
    column, starts = 0, offsets(task.outputs)
    for p, start in zip(graph.parameters, offsets(task.inputs), strict=True):
        form = p.manifold.form
        arguments.append(f"{p.name}_" if p.variable else f"a + {start}")
        if p.variable:
            seeds = tuple(_seed(p.name, leaf, start, column) for leaf in _leaves(form))
            variables.append(Variable(p.name, form.size, seeds))
            blocks.append(Block(column, form.dim, starts[1 + len(blocks)]))
            column += form.dim
    ((_, node),) = graph.outputs
    result = node.manifold.form
    names = {
        "columns": column, "symbol": SYMBOL, "function": task.name, "variables": variables,
        "arguments": arguments, "size": result.size, "rows": result.dim, "blocks": blocks,
        "tangents": [_tangent(leaf) for leaf in _leaves(result)],
    }  # fmt: skip
    return lay_out("bench/ceres_call.cc.j2", names)


def _seed(name: str, leaf: Leaf, start: int, column: int) -> str:
    source, target = f"a + {start + leaf.stored}", f"{name}_ + {leaf.stored}"
    kind = SEEDS.get(leaf.form.name)
    if kind:
        return f"{kind}({source}, {column + leaf.column}, {target});"
    return f"seed_vector({source}, {leaf.form.size}, {column + leaf.column}, {target});"


def _tangent(leaf: Leaf) -> str:
    """Rows of the Jacobian from the Jets of an output's part."""
    if leaf.form.name == "SO3":
        return f"rotation_tangent(out + {leaf.stored}, rows + {leaf.column});"
    return f"for (int k = 0; k < {leaf.form.dim}; k++) rows[{leaf.column} + k] = out[{leaf.stored} + k];"
