"""What the reference says at every sample, as arrays, and how far from it a computed result may be.

Error bound: 2e-14 max(1, s), with s the largest absolute entry of the reference's Jacobian or matrix, of the
inputs for a residual, and of both for any other output. Beyond a quarter turn on S2 it is divided by the sine
of the angle: rounding of the stored unit vectors does that to any method. Samples that are ill-conditioned by
their nature, and factors of users, which may be so anywhere, are moreover allowed the error that rounding
makes in their program.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liegen.layouts import storage

from .branches import both_branches
from .draws import AnyFunction, Sample, batch
from .rounding import rounding
from .sphere_slack import slack_of
from .weighed import defined_slopes

Array = NDArray[np.float64]

BOUND = 2e-14
#: The output of a factor.
RESIDUAL = "res"
#: Nearer to the antipode than this a direction on S2 has no useful tangent [rad].
ANTIPODE = 0.99e-6


@dataclass(frozen=True, eq=False)
class Block:
    """An output or a Jacobian at all samples, entries flat, for both branches of logarithms at a half turn.

    ``bound`` is absolute; ``lost`` is its part for the formula's own rounding, relative to the rest.
    ``kept`` is false where the reference is not finite. ``quaternions``: where each begins; q equals -q.
    """

    name: str
    is_value: bool
    expected: Array  # (2, samples, entries)
    bound: Array  # (2, samples)
    lost: Array  # (samples,)
    kept: NDArray[np.bool_]  # (samples,)
    quaternions: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Expected:
    """All blocks of a factor at its samples, and the reasons for samples that were left out."""

    samples: tuple[Sample, ...]
    blocks: tuple[Block, ...]
    slack: Array
    skipped: tuple[str, ...]

    def scale(self, block: Block) -> Array:
        """max(1, s) and the slack of S2, by sample."""
        return block.bound[0] / BOUND


def expect(function: AnyFunction, samples: Sequence[Sample], *, conditioned: bool) -> Expected:
    """Evaluate the reference. ``conditioned`` allows for the rounding in the program too.

    So do Jacobians of factors with a loss, which are those that the loss defines.
    """
    graph = function.graph
    slack = np.array([slack_of(graph, s.values) for s in samples])
    slack[slack * ANTIPODE >= 1] = np.inf
    robust = function.weighting is not None and function.weighting.loss is not None
    slopes = defined_slopes(function) if robust else None
    branches = [both_branches(graph, s, slopes) for s in samples]
    rough = np.array([conditioned or s.conditioned for s in samples])
    allowed = rounding(function.kernel.jacobians, batch(tuple(samples))) if rough.any() or robust else {}
    # the shape of a loss may be infinite
    inputs = np.array([max(abs(x) for v in s.values.values() for x in v if np.isfinite(x)) for s in samples])
    blocks: list[Block] = []
    for name in branches[0][0] if branches else ():
        is_value = name in dict(graph.outputs)
        stacked = np.array([[pair[b][name] for pair in branches] for b in range(2)], dtype=np.float64)
        is_matrix = is_value and len(dict(graph.outputs)[name].manifold.form.shape) > 1
        size = np.abs(stacked).max(axis=2)
        if is_value and not is_matrix:
            size = inputs if name == RESIDUAL else np.maximum(inputs, size)
        extra = np.where(rough | (robust and not is_value), allowed.get(name, 0.0), 0.0)
        plain = BOUND * np.maximum(1.0, size)
        bound = np.broadcast_to((plain + extra) * slack, (2, len(samples)))
        lost = extra / np.broadcast_to(plain, bound.shape).min(axis=0)
        kept = np.isfinite(stacked).all(axis=(0, 2)) & np.isfinite(slack)
        form = dict(graph.outputs)[name].manifold.form if is_value else None
        quaternions = storage(form, graph.layout).quaternions if form else ()
        blocks.append(Block(name, is_value, stacked, bound, lost, kept, quaternions))
    skipped = _reasons(samples, slack, blocks)
    return Expected(tuple(samples), tuple(blocks), slack, skipped)


def _reasons(samples: Sequence[Sample], slack: Array, blocks: Sequence[Block]) -> tuple[str, ...]:
    reasons: list[str] = []
    for k, sample in enumerate(samples):
        if not np.isfinite(slack[k]):
            reasons.append(f"{sample.case}: antipode on S2")
        elif not all(block.kept[k] for block in blocks):
            names = [block.name for block in blocks if not block.kept[k]]
            reasons.append(f"{sample.case}: reference not finite in {', '.join(names)}")
    return tuple(reasons)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Error of a block over its bound at every sample; NaN results count as infinitely wrong."""

    block: Block
    ratio: Array  # (samples,), 0 where nothing is compared
    branch: NDArray[np.int_]


def compare(expected: Expected, results: Mapping[str, Array]) -> tuple[Comparison, ...]:
    """Compare computed arrays with the reference, on the branch of the logarithms that the code took."""
    ratios = {b.name: _ratio(b, results[b.name]) for b in expected.blocks if b.name in results}
    values = [ratios[b.name] for b in expected.blocks if b.is_value]
    branch = np.argmin(np.max(values, axis=0), axis=0) if values else np.zeros(0, dtype=np.int_)
    samples = np.arange(len(expected.samples))
    return tuple(
        Comparison(b, np.where(b.kept, ratios[b.name][branch, samples], 0.0), branch)
        for b in expected.blocks
        if b.name in ratios
    )


def _ratio(block: Block, computed: Array) -> Array:
    """(2, samples)"""
    flat = computed.reshape(1, computed.shape[0], -1)
    with np.errstate(all="ignore"):
        error = np.abs(flat - block.expected)
        for start in block.quaternions:
            q = slice(start, start + 4)
            swapped = np.abs(-flat[..., q] - block.expected[..., q])
            nearer = (swapped.max(axis=-1) < error[..., q].max(axis=-1))[..., None]
            error[..., q] = np.where(nearer, swapped, error[..., q])
        ratio = error.max(axis=-1) / block.bound
    return np.where(np.isfinite(ratio), ratio, np.inf)
