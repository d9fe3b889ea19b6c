"""``NormalEquations``: H d = -g of many factors, as one sparse matrix and one vector."""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.emit.sums import sums_symbol
from liegen.errors import ToolError

from .compiled import Indexed
from .indexed import Input, structures
from .pattern import Member, Pattern, Places, made_pattern
from .source import PACKAGE

Array = NDArray[np.float64]


class Terms(NamedTuple):
    """``cost`` of all factors, gradient ``g`` (dim,), and ``H`` as a sparse array of SciPy."""

    cost: float
    g: Array
    H: Any


class _Sums(ctypes.Structure):
    """``sums`` of ``templates/runtime/sums.c.j2``."""

    _fields_ = (("data", ctypes.c_void_p), ("places", ctypes.c_void_p), ("copies", ctypes.c_ssize_t))


@dataclass(frozen=True, eq=False)
class Group:
    """Factors of one kind: the function of their terms; where their costs, parts of g and blocks of H go."""

    terms: Indexed
    costs: Places
    vectors: tuple[Places, ...]
    blocks: tuple[Places, ...]


class NormalEquations:
    """Gauss-Newton terms of groups of factors, added up in a pattern that is worked out once.

    ``factors`` are compiled factors with index arrays. The index of a variable is the number of its block in
    H, unless ``blocks`` has an entry for the group: {variable: (n,) numbers}, where -1 holds the variable
    fixed. Blocks of one size make a BSR array of SciPy, others a CSC array; both triangles are stored.

    Raises ValueError for a block with two sizes or without a factor, and for numbers of another shape than
    the index, TypeError for a variable that has neither.
    """

    def __init__(
        self, factors: Sequence[Indexed], blocks: Sequence[Mapping[str, ArrayLike]] | None = None
    ) -> None:
        none: dict[str, ArrayLike] = {}
        own = blocks if blocks is not None else [none] * len(factors)
        members = [_members(f, b) for f, b in zip(factors, own, strict=True)]
        self.pattern: Pattern = made_pattern(members)
        self.groups: tuple[Group, ...] = tuple(
            Group(
                f.gauss_newton,
                np.zeros((f.indices.length, 1, 3), dtype=np.intp),
                tuple(self.pattern.vector(m) for m in variables),
                tuple(self.pattern.block(a, b) for a, b in combinations_with_replacement(variables, 2)),
            )
            for f, variables in zip(factors, members, strict=True)
        )

    def __call__(self, *arguments: Mapping[str, Any]) -> Terms:
        """Add up the terms of all groups, each with its arguments by name: arrays (N, ...) where indexed.

        A factor outside of its domain makes NaN of the cost, and of its parts of g and H.
        """
        if len(arguments) != len(self.groups):
            raise ValueError(
                f"{len(self.groups)} groups of factors need as many arguments, got {len(arguments)}"
            )
        cost, g, H = np.zeros(1), np.zeros(self.pattern.dim + 1), np.zeros(self.pattern.entries + 1)
        for group, named in zip(self.groups, arguments, strict=True):
            targets = [(cost, group.costs), *((g, p) for p in group.vectors), *((H, p) for p in group.blocks)]
            _add(group.terms, named, targets)
        return Terms(float(cost[0]), g[:-1], _sparse(self.pattern, H[:-1]))


def _members(factor: Indexed, blocks: Mapping[str, ArrayLike]) -> list[Member]:
    """The variables of a group in their order."""
    method = factor.gauss_newton.compiled.source.methods[0]
    found: list[Member] = []
    for port in method.outputs:
        if not port.name.startswith("g_"):
            continue
        name = port.name.removeprefix("g_")
        if name not in blocks and name not in factor.indices.arrays:
            raise TypeError(f"{factor.name}: variable {name} needs an index, or numbers of its blocks")
        numbers = np.asarray(blocks.get(name, factor.indices.arrays.get(name)), dtype=np.int64)
        if numbers.shape != (factor.indices.length,):
            raise ValueError(
                f"{factor.name}: blocks of {name}: expected shape ({factor.indices.length},), "
                f"got {numbers.shape}"
            )
        found.append(Member(factor.name, name, port.size, numbers))
    return found


def _add(terms: Indexed, named: Mapping[str, Any], targets: Sequence[tuple[Array, Places]]) -> None:
    """Add each output of the terms at its places."""
    libraries, source = terms.compiled.libraries, terms.compiled.source
    if libraries is None:
        for output, (data, places) in zip(terms(**named), targets, strict=True):
            _add_in_numpy(output, data, places)
        return
    function = libraries.whole[sums_symbol(source.name, PACKAGE)]
    function.argtypes, function.restype = [ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p], ctypes.c_int
    arrays, passed = structures(
        source.methods[0], terms.bound((), named), terms.indices, np.dtype(np.float64)
    )
    sums = [_Sums(data.ctypes.data, places.ctypes.data, places.shape[1]) for data, places in targets]
    function(terms.indices.length, (Input * len(passed))(*passed), (_Sums * len(sums))(*sums))
    del arrays  # alive until here


def _add_in_numpy(output: Array, data: Array, places: Places) -> None:
    rows, columns = (*output.shape[1:], 1, 1)[:2]
    start, down, right = (places[..., k, None, None] for k in range(3))
    at = start + down * np.arange(rows)[:, None] + right * np.arange(columns)
    values = np.broadcast_to(output.reshape(-1, 1, rows, columns), at.shape)
    data += np.bincount(at.ravel(), weights=values.ravel(), minlength=len(data))


def _sparse(pattern: Pattern, data: Array) -> Any:
    """SciPy's array on the data. Raises ToolError without SciPy."""
    try:
        sparse: Any = importlib.import_module("scipy.sparse")
    except ImportError as error:
        raise ToolError("a sparse H needs SciPy: pip install liegen[sparse]") from error
    shape = (pattern.dim, pattern.dim)
    if not pattern.is_bsr:
        return sparse.csc_array((data, pattern.indices, pattern.indptr), shape=shape)
    k = int(pattern.sizes[0]) if len(pattern.sizes) else 1
    return sparse.bsr_array((data.reshape(-1, k, k), pattern.indices, pattern.indptr), shape=shape)
