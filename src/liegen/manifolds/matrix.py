"""Matrices: results such as an adjoint, with no operations of their own."""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar

import numpy as np

from .additive_form import AdditiveForm
from .group import Manifold


class MatrixForm(AdditiveForm):
    """Matrices with the given rows and columns, stored row by row."""

    def __init__(self, rows: int, columns: int) -> None:
        self.name = f"{rows} x {columns} matrix"
        self.storage = tuple(f"m{i}_{j}" for i in range(rows) for j in range(columns))
        self.tangent = self.storage
        self._shape = rows, columns

    @property
    def shape(self) -> tuple[int, ...]:
        """(rows, columns)."""
        return self._shape


class MatrixValue(Manifold):
    """A matrix; as an array its shape is (..., rows, columns)."""

    __slots__ = ()
    form: ClassVar[MatrixForm]  # pyright: ignore[reportIncompatibleVariableOverride]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> object:
        flat = np.asarray(super().__array__(dtype, copy))
        return flat.reshape(*flat.shape[:-1], *self.form.shape)


@cache
def matrix_class(rows: int, columns: int) -> type[MatrixValue]:
    """The class of matrices with the given rows and columns."""
    form = MatrixForm(rows, columns)
    return type(f"Matrix{rows}x{columns}", (MatrixValue,), {"__slots__": (), "form": form})
