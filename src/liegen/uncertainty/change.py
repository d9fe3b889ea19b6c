"""Covariances in other charts: of the coordinates d of another ``retract`` instead of n in T Exp(n)."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liegen.algebra.linear import plain
from liegen.charts import Chart, FormChart, Preset, form_chart, preset
from liegen.errors import UncertaintyError
from liegen.manifolds import Manifold
from liegen.manifolds.group import as_array
from liegen.manifolds.node import here

from .covariance import Array, covariance, through


def from_chart(T: Manifold, S: ArrayLike, chart: str | Chart | Preset) -> Array:
    """M S M^T: of n in T Exp(n), from the covariance S (..., n, n) of d in the chart's ``T.retract(d)``.

    M(T) is the chart's column map, d Log(T^-1 T.retract(d))/dd at 0; the result is of first order in d.
    ``chart`` is the name of a preset (``"sophus"``, ``"symforce"``, ``"ros"``, ...) or a ``liegen.Chart``.
    Vectors, S2 and calibrations have one chart only. Raises DefinitionError for a chart that does not exist.
    """
    found = _chart(T, chart)
    checked = covariance(S, T.form.dim)
    return checked if found is None else through(_matrix(found.columns(T.coords)), checked)


def to_chart(T: Manifold, S: ArrayLike, chart: str | Chart | Preset) -> Array:
    """The covariance of the chart's coordinates d at T, from that of n in T Exp(n)."""
    found = _chart(T, chart)
    checked = covariance(S, T.form.dim)
    return checked if found is None else through(_matrix(found.rows(T.coords)), checked)


def _chart(T: Manifold, chart: str | Chart | Preset) -> FormChart | None:
    if not isinstance(T, Manifold):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise UncertaintyError(
            f"{here()}: T must be an element of a manifold (SO3, SE3, ...), got a {type(T).__name__}"  # pyright: ignore[reportUnreachable]
        )
    return form_chart(T.form, preset(chart, str(here())))


def _matrix(chain: Any) -> Array:
    """The product of sparse factors, as an array (..., n, n)."""
    return reduce(np.matmul, [as_array(factor) for factor in plain(chain)])
