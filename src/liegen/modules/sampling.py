"""Arguments of group functions: elements and tangent vectors with the rotation that a case asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from liegen.manifolds import Group, Manifold, Value
from liegen.samples import Case, Draw, Sampler, default_sampler

#: Largest random rotation of a tangent vector [rad]: beyond pi, and away from the poles of Jr^-1 at 2 pi.
TURN = 5.5


def sampler(group: type[Group], arguments: Mapping[str, type[Manifold]]) -> Sampler:
    """Elements as ``default_sampler`` draws them; the argument ``d`` is a tangent vector of the group."""
    rest = default_sampler({name: m for name, m in arguments.items() if name != "d"})

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        values = dict(rest(draw, case))
        if "d" in arguments:
            values["d"] = arguments["d"].from_storage(_tangent(group, draw, case))
        return {name: values[name] for name in arguments}

    return sample


def _tangent(group: type[Group], draw: Draw, case: Case) -> np.ndarray:
    """The case's rotation and offset; coordinates that are no angles or scales have the case's spread."""
    asked = case if case.angle is not None else replace(case, angle=draw.uniform(0, TURN))
    spread = case.spread if case.offset is None else 1.0
    size = [spread if "[m" in name or "[s]" in name else 1.0 for name in group.form.tangent]
    return draw.tangent(group, asked) * np.array(size)
