"""Jacobians by the stored numbers instead of the tangent, as Ceres wants them from a cost function."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from liegen.charts import form_chart
from liegen.define import Function

from .points import Array, Sampled, columns_of

#: Step of the differences of fourth order that PlusJacobian is taken with.
_STEP = 1e-3


def as_tangent(function: Function[..., Any], held: Sampled) -> tuple[Sampled, tuple[str, ...]]:
    """The same results with every Jacobian by the tangent, and for each output a note if it was by more.

    A Jacobian with a column for each stored number is ``[J 0]``, where its last columns are 0 and the others
    are the right J, or A with A P = J for P the derivative of the stored numbers by the tangent.
    """
    found: list[Array] = [held.found[0]]
    notes = [""]
    for k, p in enumerate(function.graph.variables, start=1):
        array, dim = held.found[k], p.manifold.form.dim
        if array.shape[-1] == dim:
            found.append(array)
            notes.append("")
            continue
        size = array.shape[-1]
        padded = bool((array[..., dim:] == 0).all())
        if padded:
            found.append(array[..., :dim])
            notes.append(
                f"it has {size} columns, for the stored numbers of {p.name}: [J 0], the Jacobian by the "
                f"{dim} tangent coordinates and {size - dim} of zeros"
            )
            continue
        plus = _plus_jacobian(p, held)[held.firsts]
        found.append(array @ plus)
        notes.append(
            f"it is by the {size} stored numbers of {p.name} (ambient, as J * MinusJacobian); times "
            f"PlusJacobian it is the one by the {dim} tangent coordinates"
        )
    return replace(held, found=tuple(found)), tuple(notes)


def _plus_jacobian(p: Any, held: Sampled) -> Array:
    """The derivative (P, size, dim) of the stored numbers of x retracted by d, at d = 0."""
    form = p.manifold.form
    side = form_chart(form, p.chart) or form
    x = held.values[p.name].coords

    def moved(d: Array) -> Array:
        return columns_of(p.storage.write(side.retract(x, tuple(np.float64(e) for e in d))), held.points)

    columns = [
        (8 * (moved(_STEP * e) - moved(-_STEP * e)) - (moved(2 * _STEP * e) - moved(-2 * _STEP * e)))
        / (12 * _STEP)
        for e in np.eye(form.dim)
    ]
    return np.stack(columns, axis=-1)
