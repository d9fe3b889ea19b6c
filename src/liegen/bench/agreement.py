"""Whether a variant is right: its outputs against the 50-digit reference of ``liegen verify``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement

import numpy as np

from liegen.names import block_name, gradient_name
from liegen.verify.draws import Sample
from liegen.verify.expected import Block, expect

from .build import Array, Loaded
from .draws import rows
from .variant import Task


@dataclass(frozen=True, eq=False)
class Errors:
    """Inputs and what the reference says of them, in the order of the variants' outputs."""

    inputs: Array
    blocks: tuple[Block, ...]

    @classmethod
    def of(cls, task: Task, samples: Sequence[Sample]) -> Errors:
        """Evaluate the reference at some samples."""
        blocks = {block.name: block for block in expect(task.function, samples, conditioned=False).blocks}
        known = _terms(task, blocks) if task.terms else blocks
        return cls(rows(tuple(samples)), tuple(known[port.name] for port in task.outputs))


def _terms(task: Task, blocks: Mapping[str, Block]) -> dict[str, Block]:
    """Cost, g and H of the reference's residual and Jacobians."""
    ((output, _),) = task.function.graph.outputs
    residual = blocks[output]
    r = residual.expected
    J = {
        p.name: blocks[f"{output}_D_{p.name}"].expected.reshape(*r.shape, -1)
        for p in task.function.graph.variables
    }
    found = {"cost": 0.5 * (r * r).sum(axis=2, keepdims=True)}
    found |= {gradient_name(name): np.einsum("bsij,bsi->bsj", block, r) for name, block in J.items()}
    found |= {
        block_name(a, b): np.einsum("bsij,bsik->bsjk", J[a], J[b]).reshape(*r.shape[:2], -1)
        for a, b in combinations_with_replacement(J, 2)
    }
    return {name: replace(residual, name=name, expected=value) for name, value in found.items()}


def errors(loaded: Loaded, reference: Errors) -> float:
    """Largest error of an entry, relative to the largest entry of its output (at least 1).

    NaN counts as infinite. Quaternions of either sign are right.
    """
    found = loaded.results(reference.inputs)
    worst, start = 0.0, 0
    for block in reference.blocks:
        size = block.expected.shape[2]
        worst = max(worst, _error(block, found[:, start : start + size]))
        start += size
    return worst


def _error(block: Block, found: Array) -> float:
    gaps = np.abs(found - block.expected)
    for start in block.quaternions:
        q = slice(start, start + 4)
        gaps[..., q] = np.minimum(gaps[..., q].max(-1), np.abs(found[:, q] + block.expected[..., q]).max(-1))[
            ..., None
        ]
    scale = np.maximum(1.0, np.abs(block.expected).max(axis=(0, 2)))
    worst = float((gaps.max(axis=2).min(axis=0) / scale)[block.kept].max(initial=0.0))
    return worst if np.isfinite(worst) else float("inf")
