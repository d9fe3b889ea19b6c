"""Which entries of an array differ, and what they are instead: in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .tangents import Block

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: So many entries, rows or columns are listed one by one.
_LISTED = 3
#: Factors that have a name.
_FACTORS = ((180 / np.pi, "degrees for radians"), (np.pi / 180, "radians for degrees"))


def located(wrong: Mask, columns: Sequence[str], blocks: Sequence[Block]) -> str:
    """The smallest description of the entries of a Jacobian (m, n) or of a residual (m, 1) that differ.

    ``columns`` are the names of the columns, none for a residual.
    """
    m, n = wrong.shape
    rows = [int(i) for i in np.flatnonzero(wrong.any(axis=1))]
    if not columns:
        return "all entries" if len(rows) == m > 1 else f"only {_numbered('entry', 'entries', rows)}"
    used = [int(j) for j in np.flatnonzero(wrong.any(axis=0))]
    entries = [f"[{i}, {j}]" for i, j in np.argwhere(wrong)]
    if len(entries) == 1:
        return f"only entry {entries[0]} (row {rows[0]}, column {used[0]}, {columns[used[0]]})"
    if len(entries) <= _LISTED and len(rows) > 1 and len(used) > 1:
        return f"only the entries {' and '.join(entries)}"
    part = [] if len(used) == n else [_columns(used, columns, blocks)]
    part += [] if len(rows) == m else [_numbered("row", "rows", rows)]
    return f"only {' of '.join(reversed(part))}" if part else "entries in all rows and columns"


def _columns(used: Sequence[int], names: Sequence[str], blocks: Sequence[Block]) -> str:
    if len(used) == 1:
        return f"column {used[0]} ({names[used[0]]})"
    inside = [b for b in blocks if any(j in b.columns for j in used)]
    whole = [j for b in inside for j in b.columns]
    numbers = _numbered("column", "columns", used)
    if len(blocks) > 1 and len(whole) == len(used):
        return f"the {' and '.join(b.label for b in inside)} {numbers}"
    return numbers


def _numbered(one: str, many: str, numbers: Sequence[int]) -> str:
    if len(numbers) == 1:
        return f"{one} [{numbers[0]}]" if one == "entry" else f"{one} {numbers[0]}"
    if len(numbers) > _LISTED and list(numbers) == list(range(numbers[0], numbers[-1] + 1)):
        return f"{many} {numbers[0]} to {numbers[-1]}"
    return f"{many} {', '.join(map(str, numbers[:-1]))} and {numbers[-1]}"


def instead(expected: Array, found: Array, wrong: Mask) -> str:
    """What stands at the entries that differ: "0", "NaN", "2 times the right value"; else empty.

    The arrays (S, m, n) are those of the samples at which something differs, ``wrong`` is their mask.
    """
    there, right = found[wrong], expected[wrong]
    if np.isnan(there).all():
        return "NaN"
    if not np.isfinite(there).any():
        return "not finite"
    if not np.isfinite(there).all():
        return "partly not finite"
    if (there == 0).all():
        return "0"
    offset = float(np.median(there - right))
    if len(right) > 1 and np.abs(there - right - offset).max() < 1e-6 * max(1.0, abs(offset)):
        return f"{abs(offset):.7g} {'above' if offset > 0 else 'below'} the right value"
    large = np.abs(right) > 1e-9
    if not large.all() or len(right) < 2:
        return ""
    ratios = there / right
    factor = float(np.median(ratios))
    if np.abs(ratios - factor).max() > 1e-6 * max(1.0, abs(factor)):
        return ""
    named = next((f" ({name})" for value, name in _FACTORS if abs(factor - value) < 1e-6 * value), "")
    return "of the opposite sign" if abs(factor + 1) < 1e-6 else f"{factor:.7g} times the right value{named}"
