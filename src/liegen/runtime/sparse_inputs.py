"""What ``SparseSolver`` is given: a matrix, right-hand sides, damping; refused by name, or made float64."""

from __future__ import annotations

import importlib
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
FORMATS = ("bsr", "csc", "csr")
#: Largest difference of H_ij and H_ji that counts as rounding, relative to sqrt(H_ii H_jj).
ASYMMETRY = 1e-8


def matrix_of(H: Any) -> Any:
    """A square sparse array of doubles in one of ``FORMATS``, with finite numbers; H itself where it is one.

    Raises TypeError for what holds no real numbers, ValueError for another shape, NaN and infinite numbers.
    """
    sparse: Any = importlib.import_module("scipy.sparse")
    given: Any = H if sparse.issparse(H) else _real(_dense(H, "H"), "H")
    if len(given.shape) != 2 or given.shape[0] != given.shape[1]:
        raise ValueError(f"H must be square, its shape is {tuple(given.shape)}")
    stored: Any = given if sparse.issparse(H) else sparse.csc_array(given)
    made = stored if stored.format in FORMATS else stored.tocsc()
    if made.dtype != np.float64:
        _need_real(made.dtype, "H")
        made = made.astype(np.float64)
    if not math.isfinite(made.data.sum()) and not np.isfinite(made.data).all():
        entries = made.tocoo()
        k = int(np.flatnonzero(~np.isfinite(entries.data))[0])
        at = f"H[{int(entries.row[k])}, {int(entries.col[k])}]"
        raise ValueError(
            f"{at} is {entries.data[k]}; a factor is outside of its domain, or an argument is bad"
        )
    return made


def right_sides(b: ArrayLike, dim: int) -> Array:
    """Right-hand sides (dim,) or (dim, k). Raises TypeError and ValueError, likewise."""
    made = _real(_dense(b, "b"), "b")
    if made.ndim not in (1, 2) or len(made) != dim:
        raise ValueError(f"b must have the shape ({dim},) or ({dim}, k) for this H, got {made.shape}")
    if not np.isfinite(made).all():
        index = [int(k) for k in np.argwhere(~np.isfinite(made))[0]]
        raise ValueError(f"b{index} is {made[tuple(index)]}; give it a finite number")
    return made


def damping_of(damping: Any) -> float:
    """A finite number that is not negative. Raises TypeError and ValueError, likewise."""
    if type(damping) is float and 0.0 <= damping < math.inf:
        return damping
    number = np.asarray(damping)
    if number.shape != () or number.dtype.kind not in "fiu":
        what = type(damping).__name__ if number.shape == () else f"an array of shape {number.shape}"
        raise TypeError(f"damping must be a number, which scales the diagonal of H, got {what}")
    if not 0.0 <= float(number) < math.inf:
        raise ValueError(f"damping must be finite and not negative, got {damping}")
    return float(number)


def need_symmetric(H: Any) -> None:
    """Raise ValueError where H is not symmetric to rounding: one triangle alone would be another system."""
    entries = H.tocsc()
    deviation = np.sqrt(np.abs(entries.diagonal()))
    gap = abs(entries - entries.T).tocoo()
    bad = gap.data > ASYMMETRY * deviation[gap.row] * deviation[gap.col]
    if bad.any():
        i, j = (int(part[bad][0]) for part in (gap.row, gap.col))
        raise ValueError(
            f"H is not symmetric: H[{i}, {j}] is {entries[i, j]:.9g}, H[{j}, {i}] is {entries[j, i]:.9g}; "
            "give both triangles"
        )


def _dense(value: Any, name: str) -> Any:
    sparse: Any = importlib.import_module("scipy.sparse")
    if sparse.issparse(value):
        raise TypeError(f"{name} is a sparse array; give {name}.toarray()")
    if np.ma.isMaskedArray(value):
        raise TypeError(f"{name} is a masked array, whose mask would be ignored; give {name}.filled(...)")
    try:
        return np.asarray(value)
    except ValueError:
        raise TypeError(f"{name} must be an array of numbers, got rows of different lengths") from None


def _real(array: NDArray[Any], name: str) -> Array:
    _need_real(array.dtype, name)
    return array.astype(np.float64, copy=False)


def _need_real(dtype: np.dtype[Any], name: str) -> None:
    if dtype.kind == "c":
        raise TypeError(f"{name} must hold real numbers, got {dtype}; give {name}.real")
    if dtype.kind not in "fiub":
        raise TypeError(f"{name} must hold real numbers, got {dtype}; give float64")
