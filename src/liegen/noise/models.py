"""How the noise of a residual is given: one entry per model, adding a model adds one entry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liegen.algebra.linear import Matrix, Vector, diagonal
from liegen.names import SQRT_INFO

#: The keyword that every model adds.
KEYWORD = SQRT_INFO


@dataclass(frozen=True)
class Noise:
    """A model of the noise of a residual with m entries.

    ``shape(m)`` is that of ``sqrt_info``; ``matrix(stored, m)`` makes of its numbers, row-major, the upper
    triangular S with S^T S = covariance^-1, zeros as structure. ``kind(m)`` is the shape in words.
    ``draw`` gives samples for verification.
    """

    name: str
    shape: Callable[[int], tuple[int, ...]]
    matrix: Callable[[Vector, int], Matrix]
    kind: Callable[[int], str]
    meaning: str
    draw: Callable[[np.random.Generator, int], NDArray[np.float64]]


def _upper(stored: Vector, m: int) -> Matrix:
    return tuple(tuple(stored[i * m + j] if j >= i else 0 for j in range(m)) for i in range(m))


def _packed(stored: Vector, m: int) -> Matrix:
    rows = [m * i - i * (i + 1) // 2 for i in range(m)]  # entry (i, j) is number rows[i] + j
    return tuple(tuple(stored[rows[i] + j] if j >= i else 0 for j in range(m)) for i in range(m))


def _draw_full(generator: np.random.Generator, m: int) -> NDArray[np.float64]:
    """Numbers below the diagonal too: code that reads them is wrong."""
    S = generator.normal(size=(m, m))
    S[np.diag_indices(m)] = generator.uniform(0.5, 2.0, m)
    return S


NOISES: Mapping[str, Noise] = {
    noise.name: noise
    for noise in (
        Noise(
            "full",
            lambda m: (m, m),
            _upper,
            lambda m: f"{m} x {m} upper triangular",
            "square root S of the information, S^T S = covariance^-1; below the diagonal it is not read",
            _draw_full,
        ),
        Noise(
            "packed",
            lambda m: (m * (m + 1) // 2,),
            _packed,
            lambda m: f"R{m * (m + 1) // 2} packed upper triangle",
            "square root S of the information, S^T S = covariance^-1: its upper triangle, row by row",
            lambda generator, m: _draw_full(generator, m)[np.triu_indices(m)],
        ),
        Noise(
            "diagonal",
            lambda m: (m,),
            lambda stored, m: diagonal(stored),
            lambda m: f"R{m} diagonal",
            "1 / standard deviation of each entry of the residual, the diagonal of S",
            lambda generator, m: generator.uniform(0.5, 2.0, m),
        ),
        Noise(
            "isotropic",
            lambda m: (1,),
            lambda stored, m: diagonal([stored[0]] * m),
            lambda m: "R1 isotropic",
            "1 / standard deviation, the same of every entry of the residual; S is that times I",
            lambda generator, m: generator.uniform(0.5, 2.0, 1),
        ),
    )
}
