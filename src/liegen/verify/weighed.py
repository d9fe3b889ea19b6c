"""Robust factors: the Jacobian that the mode of the loss defines, which is no derivative of the residual."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import reference
from .branches import Entries, Slopes, flat
from .draws import AnyFunction, Values
from .reference.calls import Call
from .reference.logarithms import PRINCIPAL
from .reference.matrix import mp
from .reference.weights import weighted_rows


def defined_slopes(function: AnyFunction) -> Slopes:
    """sqrt(rho') S J, or Triggs' corrected one, of a factor with a loss."""

    def slopes(values: Values, flip: bool) -> Entries:
        jacobians: Any = reference.jacobians(function.plain, values, flip=flip)
        evaluation = reference.evaluate(function.graph, values, flip=flip)
        ((name, node),) = function.graph.outputs
        with mp.workdps(reference.DIGITS):
            call = Call(node.operation, node.operands, [evaluation[n] for n in node.operands], PRINCIPAL)
            rows = {variable: weighted_rows(call, J) for (_, variable), J in jacobians.items()}
        return {f"{name}_D_{variable}": np.array(flat(J)) for variable, J in rows.items()}

    return slopes
