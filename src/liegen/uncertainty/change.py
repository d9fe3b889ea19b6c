"""Covariances in other charts: of the coordinates d of another ``retract`` instead of n in T Exp(n)."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liegen.algebra.linear import plain
from liegen.charts import Chart, FormChart, Preset, form_chart, preset
from liegen.errors import UncertaintyError
from liegen.manifolds import Manifold, Sim2, Sim3
from liegen.manifolds.group import as_array
from liegen.manifolds.node import here

from .covariance import Array, covariance, through
from .order import permutation


def from_chart(T: Manifold, S: ArrayLike, chart: str | Chart | Preset) -> Array:
    """M S M^T: of n in T Exp(n), from the covariance S (..., n, n) of d in the chart's ``T.retract(d)``.

    M(T) is the chart's column map, d Log(T^-1 T.retract(d))/dd at 0; the result is of first order in d.
    ``chart`` is the name of a preset (``"sophus"``, ``"symforce"``, ``"ros"``, ...) or a ``liegen.Chart``.
    Vectors, S2 and calibrations have one chart only; Sim2 and Sim3 have theirs in both orders (``"sophus"``).
    Raises DefinitionError for a chart that does not exist.
    """
    found, order = _chart(T, chart)
    checked = covariance(S, T.form.dim)[..., order[:, None], order]
    return checked if found is None else through(_matrix(found.columns(T.coords)), checked)


def to_chart(T: Manifold, S: ArrayLike, chart: str | Chart | Preset) -> Array:
    """The covariance of the chart's coordinates d at T, from that of n in T Exp(n)."""
    found, order = _chart(T, chart)
    back, checked = np.argsort(order), covariance(S, T.form.dim)
    moved = checked if found is None else through(_matrix(found.rows(T.coords)), checked)
    return moved[..., back[:, None], back]


def _chart(T: Manifold, chart: str | Chart | Preset) -> tuple[FormChart | None, NDArray[np.intp]]:
    """The chart, None where it is liegen's own but for the order; the places of its coordinates in d."""
    if not isinstance(T, Manifold):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise UncertaintyError(
            f"{here()}: T must be an element of a manifold (SO3, SE3, ...), got a {type(T).__name__}"  # pyright: ignore[reportUnreachable]
        )
    found = preset(chart, str(here()))
    if isinstance(T, Sim2 | Sim3):
        order = found.chart(T.form).order
        if order != "own" and found.chart(T.form) == Chart(order=order):
            return None, np.argsort(permutation(type(T), order))
    return form_chart(T.form, found), np.arange(T.form.dim)


def _matrix(chain: Any) -> Array:
    """The product of sparse factors, as an array (..., n, n)."""
    return reduce(np.matmul, [as_array(factor) for factor in plain(chain)])
