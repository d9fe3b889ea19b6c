"""The tables: functions that are compared, and who takes part. A new peer is a file and a line here."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from liegen.gauss_newton import gauss_newton_kernel
from liegen.library import between_se2, between_se3, between_so3, prior_se3

from . import casadi_c, ceres_jets, formulas, ours, symforce_cpp, wrenfold_cpp
from .variant import AnyFunction, Maker, Task

#: Every function with definitions that peers publish, in the order of tables.
PUBLISHED: tuple[AnyFunction, ...] = (
    between_se3,
    between_se3.whitened("full", name="between_se3_whitened"),
    between_so3,
    between_se2,
    formulas.between_so3xr3,
    prior_se3,
    formulas.reprojection_bal,
    formulas.bearing_range_se2_r2,
    formulas.quaternion_local,
    formulas.quaternion_interpolation,
    formulas.imu_step,
    formulas.rolling_shutter,
)

#: Peers by name; the first is the base of all ratios.
PEERS: Mapping[str, Maker] = {
    ours.NAME: ours.variants,
    f"{ours.NAME} batches": ours.batches,
    wrenfold_cpp.NAME: wrenfold_cpp.variants,
    symforce_cpp.NAME: symforce_cpp.variants,
    ceres_jets.NAME: ceres_jets.variants,
    casadi_c.NAME: casadi_c.variants,
}


def tasks(functions: tuple[AnyFunction, ...]) -> tuple[Task, ...]:
    """Tasks of these functions; those of ``PUBLISHED`` have formulas of the peers.

    Whitened factors are there twice: as they are, and as Gauss-Newton terms.
    """
    known = {id(f) for f in PUBLISHED}
    found: list[Task] = []
    for f in functions:
        found.append(Task(f, id(f) in known))
        if f.weighting:
            found.append(
                Task(f, id(f) in known, partial(gauss_newton_kernel, f.kernel, f.plain, f.weighting))
            )
    return tuple(found)
