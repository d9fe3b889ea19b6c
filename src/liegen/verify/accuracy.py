"""Accuracy against the mpmath reference, and agreement of the back ends among each other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .branches import EPS
from .expected import BOUND, Comparison, Expected, compare
from .report import Check

Array = NDArray[np.float64]
#: Arrays of one back end by output.
Results = Mapping[str, Array]

#: How far back ends may be apart, relative to max(1, s): libm and NumPy differ in the last place.
AGREEMENT = 16 * EPS
#: Rounding in the formula that is worth a word, as a multiple of the bound.
LOSS = 10.0
UNIT = "relative to max(1, s)"


def accuracy(
    expected: Expected,
    results: Mapping[str, Results],
    refused: Sequence[str],
    *,
    has_jacobians: bool = True,
) -> tuple[Check, ...]:
    """Outputs, then Jacobians if there are any, of all back ends against the reference.

    A check fails for an error beyond the bound, and when fewer than half of the samples could be compared.
    """
    found = [(name, c) for name, arrays in results.items() for c in compare(expected, arrays)]
    values = [(n, c) for n, c in found if c.block.is_value]
    jacobians = [(n, c) for n, c in found if not c.block.is_value]
    value = _check("value", expected, values, refused)
    return (value, _check("Jacobian", expected, jacobians, refused)) if has_jacobians else (value,)


def _check(
    name: str, expected: Expected, found: Sequence[tuple[str, Comparison]], refused: Sequence[str]
) -> Check:
    kept = min((int(c.block.kept.sum()) for _, c in found), default=0)
    skipped = (*expected.skipped, *refused)
    worst, where = _worst(expected, ((backend, c.block.name, c.ratio) for backend, c in found))
    enough = 2 * kept >= len(expected.samples) + len(refused) and kept > 0
    few = "" if enough else f"only {kept} of {len(expected.samples) + len(refused)} samples could be compared"
    note = "; ".join(filter(None, (few, _loss(expected, [c for _, c in found]))))
    return Check(name, enough and worst <= 1.0, worst * BOUND, BOUND, UNIT, where, kept, skipped, note)


def _loss(expected: Expected, found: Sequence[Comparison]) -> str:
    """Says where the formula itself loses more digits than the bound has."""
    lost, name, k = max(
        ((float(c.block.lost[k]), c.block.name, k) for c in found for k in range(len(c.block.lost))),
        default=(0.0, "", 0),
    )
    if lost <= LOSS:
        return ""
    return (
        f"rounding in the formula itself reaches {lost * BOUND:.0e} in {name} at {expected.samples[k].case}"
    )


def _worst(expected: Expected, ratios: Iterable[tuple[str, str, Array]]) -> tuple[float, str]:
    worst, where = 0.0, ""
    for backend, block, ratio in ratios:
        if len(ratio) and ratio.max() > worst:
            k = int(np.argmax(ratio))
            worst, where = float(ratio[k]), f"{block}, {backend}, {expected.samples[k].case}"
    return worst, where


def agreement(expected: Expected, results: Mapping[str, Results]) -> Check:
    """Every back end against the first of them, wherever the reference is finite.

    Where the last digits of the inputs decide which logarithm it is, each may take another one.
    """
    first, *others = results
    decided = np.all([np.equal(*b.expected).all(axis=1) for b in expected.blocks if b.kept.any()], axis=0)
    ratios: list[tuple[str, str, Array]] = []
    for other in others:
        for block in expected.blocks:
            if block.name in results[other]:
                ratio = _apart(results[first][block.name], results[other][block.name], expected.scale(block))
                ratios.append(
                    (f"{other} against {first}", block.name, np.where(block.kept & decided, ratio, 0.0))
                )
    worst, where = _worst(expected, ratios)
    kept = min((int(b.kept.sum()) for b in expected.blocks), default=0)
    return Check("agreement", worst <= 1.0, worst * AGREEMENT, AGREEMENT, UNIT, where, kept, expected.skipped)


def _apart(a: Array, b: Array, scale: Array) -> Array:
    with np.errstate(all="ignore"):
        difference = np.abs((a - b).reshape(len(a), -1)).max(axis=1) / (AGREEMENT * scale)
    return np.where(np.isfinite(difference), difference, np.inf)
