"""``Pattern``: where the blocks of H and g of all factors go in a sparse matrix and a vector."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, pairwise

import numpy as np
from numpy.typing import NDArray

#: (n, copies, 3): where entry (0, 0) goes, the step to the next row, the step to the next column.
Places = NDArray[np.intp]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Member:
    """A variable of a group of factors: its dimension, and the block of each factor; -1: held fixed."""

    group: str
    name: str
    dim: int
    blocks: Numbers


@dataclass(frozen=True, eq=False)
class Pattern:
    """A symmetric matrix of blocks with both triangles, as SciPy's BSR or, for blocks of several sizes, CSC.

    ``sizes`` and ``starts`` are those of the block rows; ``indices`` and ``indptr`` are SciPy's. There are
    ``entries`` numbers; one more takes what belongs to variables that are held fixed. Stored blocks are in
    the order of ``keys``: ``first`` is where entry (0, 0) is, ``across`` the step to the next row of a BSR
    block, to the next column of a CSC block; the other step is 1.
    """

    is_bsr: bool
    sizes: Numbers
    starts: Numbers
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]
    entries: int
    keys: Numbers
    first: Numbers
    across: Numbers

    @property
    def dim(self) -> int:
        """Rows of the matrix."""
        return int(self.sizes.sum())

    def vector(self, member: Member) -> Places:
        """Where each factor's part of g goes."""
        held = member.blocks < 0
        place = np.where(held, self.dim, self.starts[member.blocks])
        return np.stack([place, ~held, np.zeros_like(place)], axis=-1)[:, None].astype(np.intp)

    def block(self, a: Member, b: Member) -> Places:
        """Where H_ab goes, and for two variables its transpose."""
        forth = self._placed(a.blocks, b.blocks)
        if a is b:
            return forth[:, None]
        back = self._placed(b.blocks, a.blocks)[:, [0, 2, 1]]
        return np.stack([forth, back], axis=1)

    def _placed(self, rows: Numbers, columns: Numbers) -> Places:
        held = (rows < 0) | (columns < 0)
        outer, inner = (rows, columns) if self.is_bsr else (columns, rows)
        slot = np.searchsorted(
            self.keys, np.where(held, self.keys[:1].sum(), outer * len(self.sizes) + inner)
        )
        first = np.where(held, self.entries, np.append(self.first, 0)[slot])
        across = np.where(held, 0, np.append(self.across, 0)[slot])
        steps = (across, ~held) if self.is_bsr else (~held, across)
        return np.stack([first, *steps], axis=-1).astype(np.intp)


def made_pattern(groups: Sequence[Sequence[Member]]) -> Pattern:
    """The pattern of all pairs of variables that share a factor.

    Raises ValueError for a block that two variables give different dimensions, and for one in no factor.
    """
    sizes = _sizes([m for group in groups for m in group])
    count, is_bsr = len(sizes), len(set(sizes.tolist())) <= 1
    keys = np.unique(np.concatenate([np.arange(count) * (count + 1), *_keys(groups, count)]))
    outer, inner = np.divmod(keys, max(count, 1))
    starts = np.cumsum(sizes) - sizes
    blocks = np.searchsorted(outer, np.arange(count + 1))  # begin of each row of blocks, or column
    if is_bsr:
        k = int(sizes[0]) if count else 1
        first, across = np.arange(len(keys)) * k * k, np.full(len(keys), k)
        indices, indptr, entries = inner, blocks, len(keys) * k * k
    else:
        indices, indptr, first, across = _columns(sizes, starts, outer, inner, blocks)
        entries = len(indices)
    return Pattern(
        is_bsr, sizes, starts, indices.astype(np.int32), indptr.astype(np.int32), entries, keys, first, across
    )


def _columns(
    sizes: Numbers, starts: Numbers, outer: Numbers, inner: Numbers, blocks: Numbers
) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Indices and pointers of single columns; where each block begins, and how far its columns are apart."""
    heights = np.add.reduceat(sizes[inner], blocks[:-1])
    below = np.cumsum(sizes[inner]) - sizes[inner]
    below -= below[blocks[:-1]][outer]
    column_starts = np.cumsum(heights * sizes) - heights * sizes
    rows_of: list[Numbers] = np.split(np.arange(sizes.sum(), dtype=np.int64), starts[1:])
    order: list[int] = inner.tolist()
    rows: list[Numbers] = [
        np.tile(np.concatenate([rows_of[i] for i in order[a:b]]), width)
        for width, (a, b) in zip(sizes.tolist(), pairwise(blocks.tolist()), strict=True)
    ]
    indptr = np.concatenate([[0], np.cumsum(np.repeat(heights, sizes))])
    return np.concatenate(rows), indptr, column_starts[outer] + below, heights[outer]


def _keys(groups: Sequence[Sequence[Member]], count: int) -> Iterator[Numbers]:
    for members in groups:
        for a, b in combinations_with_replacement(members, 2):
            both = (a.blocks >= 0) & (b.blocks >= 0)
            i, j = a.blocks[both], b.blocks[both]
            yield i * count + j
            yield j * count + i


def _sizes(members: Sequence[Member]) -> Numbers:
    count = 1 + max((int(m.blocks.max(initial=-1)) for m in members), default=-1)
    sizes = np.zeros(count, dtype=np.int64)
    for m in members:
        mine = m.blocks[m.blocks >= 0]
        other = mine[(sizes[mine] != 0) & (sizes[mine] != m.dim)]
        if len(other):
            raise ValueError(
                f"{m.group}: block {other[0]} has {m.dim} dimensions as {m.name}, "
                f"{sizes[other[0]]} elsewhere; number the blocks of different states apart"
            )
        sizes[mine] = m.dim
    if count and not sizes.all():
        raise ValueError(f"block {int(np.argmin(sizes))} is in no factor; number the blocks without gaps")
    return sizes
