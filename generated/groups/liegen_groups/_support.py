# liegen_groups: functions and their Jacobians
#
# Formulas:
#   so2_compose: out = x.compose(y)
#   so2_inverse: out = x.inverse()
#   so2_between: out = x.between(y)
#   so2_act: out = x @ p
#   so2_transform_to: out = x.unrotate(p)
#   so2_exp: out = SO2.exp(d)
#   so2_log: out = x.log()
#   so2_retract: out = x.retract(d)
#   so2_local: out = x.local(y)
#   so2_adjoint: out = x.adjoint()
#   so2_ad: out = SO2.ad(d)
#   so2_Jr: out = SO2.Jr(d)
#   so2_Jl: out = SO2.Jl(d)
#   so2_Jr_inv: out = SO2.Jr_inv(d)
#   so2_Jl_inv: out = SO2.Jl_inv(d)
#   se2_compose: out = x.compose(y)
#   se2_inverse: out = x.inverse()
#   se2_between: out = x.between(y)
#   se2_act: out = x.transform_from(p)
#   se2_transform_to: out = x.transform_to(p)
#   se2_exp: out = SE2.exp(d)
#   se2_log: out = x.log()
#   se2_retract: out = x.retract(d)
#   se2_local: out = x.local(y)
#   se2_adjoint: out = x.adjoint()
#   se2_ad: out = SE2.ad(d)
#   se2_Jr: out = SE2.Jr(d)
#   se2_Jl: out = SE2.Jl(d)
#   se2_Jr_inv: out = SE2.Jr_inv(d)
#   se2_Jl_inv: out = SE2.Jl_inv(d)
#   so3_compose: out = x.compose(y)
#   so3_inverse: out = x.inverse()
#   so3_between: out = x.between(y)
#   so3_act: out = x @ p
#   so3_transform_to: out = x.unrotate(p)
#   so3_exp: out = SO3.exp(d)
#   so3_log: out = x.log()
#   so3_retract: out = x.retract(d)
#   so3_local: out = x.local(y)
#   so3_adjoint: out = x.adjoint()
#   so3_ad: out = SO3.ad(d)
#   so3_Jr: out = SO3.Jr(d)
#   so3_Jl: out = SO3.Jl(d)
#   so3_Jr_inv: out = SO3.Jr_inv(d)
#   so3_Jl_inv: out = SO3.Jl_inv(d)
#   se3_compose: out = x.compose(y)
#   se3_inverse: out = x.inverse()
#   se3_between: out = x.between(y)
#   se3_act: out = x.transform_from(p)
#   se3_transform_to: out = x.transform_to(p)
#   se3_exp: out = SE3.exp(d)
#   se3_log: out = x.log()
#   se3_retract: out = x.retract(d)
#   se3_local: out = x.local(y)
#   se3_adjoint: out = x.adjoint()
#   se3_ad: out = SE3.ad(d)
#   se3_Jr: out = SE3.Jr(d)
#   se3_Jl: out = SE3.Jl(d)
#   se3_Jr_inv: out = SE3.Jr_inv(d)
#   se3_Jl_inv: out = SE3.Jl_inv(d)
#   se23_compose: out = x.compose(y)
#   se23_inverse: out = x.inverse()
#   se23_between: out = x.between(y)
#   se23_exp: out = SE23.exp(d)
#   se23_log: out = x.log()
#   se23_retract: out = x.retract(d)
#   se23_local: out = x.local(y)
#   se23_adjoint: out = x.adjoint()
#   se23_ad: out = SE23.ad(d)
#   se23_Jr: out = SE23.Jr(d)
#   se23_Jl: out = SE23.Jl(d)
#   se23_Jr_inv: out = SE23.Jr_inv(d)
#   se23_Jl_inv: out = SE23.Jl_inv(d)
#   gal3_compose: out = x.compose(y)
#   gal3_inverse: out = x.inverse()
#   gal3_between: out = x.between(y)
#   gal3_exp: out = Gal3.exp(d)
#   gal3_log: out = x.log()
#   gal3_retract: out = x.retract(d)
#   gal3_local: out = x.local(y)
#   gal3_adjoint: out = x.adjoint()
#   gal3_ad: out = Gal3.ad(d)
#   gal3_Jr: out = Gal3.Jr(d)
#   gal3_Jl: out = Gal3.Jl(d)
#   gal3_Jr_inv: out = Gal3.Jr_inv(d)
#   gal3_Jl_inv: out = Gal3.Jl_inv(d)
#   sim2_compose: out = x.compose(y)
#   sim2_inverse: out = x.inverse()
#   sim2_between: out = x.between(y)
#   sim2_act: out = x.transform_from(p)
#   sim2_transform_to: out = x.transform_to(p)
#   sim2_exp: out = Sim2.exp(d)
#   sim2_log: out = x.log()
#   sim2_retract: out = x.retract(d)
#   sim2_local: out = x.local(y)
#   sim2_adjoint: out = x.adjoint()
#   sim2_ad: out = Sim2.ad(d)
#   sim2_Jr: out = Sim2.Jr(d)
#   sim2_Jl: out = Sim2.Jl(d)
#   sim2_Jr_inv: out = Sim2.Jr_inv(d)
#   sim2_Jl_inv: out = Sim2.Jl_inv(d)
#   sim3_compose: out = x.compose(y)
#   sim3_inverse: out = x.inverse()
#   sim3_between: out = x.between(y)
#   sim3_act: out = x.transform_from(p)
#   sim3_transform_to: out = x.transform_to(p)
#   sim3_exp: out = Sim3.exp(d)
#   sim3_log: out = x.log()
#   sim3_retract: out = x.retract(d)
#   sim3_local: out = x.local(y)
#   sim3_adjoint: out = x.adjoint()
#   sim3_ad: out = Sim3.ad(d)
#   sim3_Jr: out = Sim3.Jr(d)
#   sim3_Jl: out = Sim3.Jl(d)
#   sim3_Jr_inv: out = Sim3.Jr_inv(d)
#   sim3_Jl_inv: out = Sim3.Jl_inv(d)
#
# Conventions:
#   SO2: stored (cos, sin); tangent: angle [rad]; x.retract(d) = x exp(d)
#   R2: stored as it is; tangent: the same; x.retract(d) = x + d
#   R1: stored as it is; tangent: the same; x.retract(d) = x + d
#   SE2: stored (cos, sin, x, y); tangent: x [m], y [m], angle [rad]; x.retract(d) = x exp(d)
#   R3: stored as it is; tangent: the same; x.retract(d) = x + d
#   SO3: stored unit quaternion (x, y, z, w); tangent: rotation vector [rad]; x.retract(d) = x exp(d)
#   SE3: stored quaternion (x, y, z, w), translation (x, y, z); tangent: rotation [rad], translation [m];
#       x.retract(d) = x exp(d)
#   R6: stored as it is; tangent: the same; x.retract(d) = x + d
#   SE23: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z); tangent: rotation [rad],
#       position [m], velocity [m/s]; x.retract(d) = x exp(d)
#   R9: stored as it is; tangent: the same; x.retract(d) = x + d
#   Gal3: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z), time; tangent: rotation
#       [rad], position [m], velocity [m/s], time [s]; x.retract(d) = x exp(d)
#   R10: stored as it is; tangent: the same; x.retract(d) = x + d
#   Sim2: stored (cos, sin), translation (x, y), scale; x p = scale R p + translation; tangent: x [m], y
#       [m], angle [rad], log of the scale; x.retract(d) = x exp(d)
#   R4: stored as it is; tangent: the same; x.retract(d) = x + d
#   Sim3: stored quaternion (x, y, z, w), translation (x, y, z), scale; x p = scale R p + translation;
#       tangent: rotation [rad], translation [m], log of the scale; x.retract(d) = x exp(d)
#   R7: stored as it is; tangent: the same; x.retract(d) = x + d
#
# Shapes and units: at the top of each function's file.
#
# Operations:
#   so2_compose: 6, with Jacobians 6
#   so2_inverse: 1, with Jacobians 1
#   so2_between: 6, with Jacobians 6
#   so2_act: 6, with Jacobians 8
#   so2_transform_to: 6, with Jacobians 8
#   so2_exp: 2, with Jacobians 2
#   so2_log: 1, with Jacobians 1
#   so2_retract: 8, with Jacobians 8
#   so2_local: 7, with Jacobians 7
#   so2_adjoint: 0
#   so2_ad: 0
#   so2_Jr: 0
#   so2_Jl: 0
#   so2_Jr_inv: 0
#   so2_Jl_inv: 0
#   se2_compose: 14, with Jacobians 21
#   se2_inverse: 7, with Jacobians 9
#   se2_between: 14, with Jacobians 22
#   se2_act: 8, with Jacobians 9
#   se2_transform_to: 8, with Jacobians 10
#   se2_exp: 20, with Jacobians 47
#   se2_log: 25, with Jacobians 33
#   se2_retract: 34, with Jacobians 68
#   se2_local: 39, with Jacobians 50
#   se2_adjoint: 2
#   se2_ad: 2
#   se2_Jr: 39
#   se2_Jl: 39
#   se2_Jr_inv: 38
#   se2_Jl_inv: 38
#   so3_compose: 28, with Jacobians 51
#   so3_inverse: 3, with Jacobians 26
#   so3_between: 28, with Jacobians 51
#   so3_act: 38, with Jacobians 65
#   so3_transform_to: 38, with Jacobians 41
#   so3_exp: 16, with Jacobians 60
#   so3_log: 33, with Jacobians 75
#   so3_retract: 44, with Jacobians 111
#   so3_local: 61, with Jacobians 112
#   so3_adjoint: 23
#   so3_ad: 3
#   so3_Jr: 57
#   so3_Jl: 57
#   so3_Jr_inv: 54
#   so3_Jl_inv: 54
#   se3_compose: 61, with Jacobians 111
#   se3_inverse: 33, with Jacobians 83
#   se3_between: 61, with Jacobians 112
#   se3_act: 41, with Jacobians 68
#   se3_transform_to: 41, with Jacobians 44
#   se3_exp: 79, with Jacobians 166
#   se3_log: 90, with Jacobians 156
#   se3_retract: 140, with Jacobians 277
#   se3_local: 150, with Jacobians 235
#   se3_adjoint: 50
#   se3_ad: 6
#   se3_Jr: 148
#   se3_Jl: 148
#   se3_Jr_inv: 125
#   se3_Jl_inv: 125
#   se23_compose: 87, with Jacobians 164
#   se23_inverse: 56, with Jacobians 110
#   se23_between: 87, with Jacobians 166
#   se23_exp: 94, with Jacobians 236
#   se23_log: 105, with Jacobians 218
#   se23_retract: 181, with Jacobians 400
#   se23_local: 191, with Jacobians 332
#   se23_adjoint: 77
#   se23_ad: 9
#   se23_Jr: 203
#   se23_Jl: 203
#   se23_Jr_inv: 173
#   se23_Jl_inv: 173
#   gal3_compose: 94, with Jacobians 196
#   gal3_inverse: 63, with Jacobians 131
#   gal3_between: 94, with Jacobians 198
#   gal3_exp: 152, with Jacobians 407
#   gal3_log: 129, with Jacobians 300
#   gal3_retract: 246, with Jacobians 603
#   gal3_local: 222, with Jacobians 421
#   gal3_adjoint: 93
#   gal3_ad: 10
#   gal3_Jr: 365
#   gal3_Jl: 365
#   gal3_Jr_inv: 245
#   gal3_Jl_inv: 245
#   sim2_compose: 17, with Jacobians 30
#   sim2_inverse: 10, with Jacobians 15
#   sim2_between: 18, with Jacobians 31
#   sim2_act: 10, with Jacobians 20
#   sim2_transform_to: 10, with Jacobians 16
#   sim2_exp: 141, with Jacobians 309
#   sim2_log: 161, with Jacobians 329
#   sim2_retract: 158, with Jacobians 338
#   sim2_local: 179, with Jacobians 358
#   sim2_adjoint: 5
#   sim2_ad: 3
#   sim2_Jr: 233
#   sim2_Jl: 232
#   sim2_Jr_inv: 233
#   sim2_Jl_inv: 233
#   sim3_compose: 73, with Jacobians 148
#   sim3_inverse: 45, with Jacobians 81
#   sim3_between: 74, with Jacobians 149
#   sim3_act: 44, with Jacobians 95
#   sim3_transform_to: 45, with Jacobians 57
#   sim3_exp: 170, with Jacobians 520
#   sim3_log: 221, with Jacobians 530
#   sim3_retract: 243, with Jacobians 667
#   sim3_local: 295, with Jacobians 653
#   sim3_adjoint: 62
#   sim3_ad: 6
#   sim3_Jr: 437
#   sim3_Jl: 436
#   sim3_Jr_inv: 375
#   sim3_Jl_inv: 375
#
# Regenerate: liegen generate --group SO2 --group SE2 --group SO3 --group SE3 --group SE23 --group Gal3 --group Sim2 --group Sim3 -o DIR
#
# SPDX-License-Identifier: 0BSD
# Generated by liegen. This code is free: use, change and ship it for any purpose, without conditions.
"""Arguments in, arrays out: conversion, shape checks, broadcasting."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]

#: Elements of a batch that are computed together, few enough that their temporaries stay in the cache.
BLOCK = 2048


def evaluate(
    kernel: Callable[..., None], name: str,
    arguments: tuple[tuple[str, npt.ArrayLike, int], ...], shapes: tuple[tuple[int, ...], ...],
) -> list[Array]:
    """Run a kernel over the leading dimensions; it sees every array with its components first."""
    values = [_read(name, argument, value, size) for argument, value, size in arguments]
    batch = _batch(name, [argument for argument, _, _ in arguments], values)
    count = prod(batch)
    rows = [_rows(value, batch) for value in values]
    outputs = [np.zeros((count, *shape)) for shape in shapes]
    with np.errstate(all="ignore"):
        if count == 1:  # NumPy's scalars are much faster than arrays of one element
            kernel(*(row[0] for row in rows), *(out[0] for out in outputs))
        else:
            for start in range(0, count, BLOCK):
                block = slice(start, start + BLOCK)
                inputs = [np.ascontiguousarray((r if len(r) == 1 else r[block]).T) for r in rows]
                kernel(*inputs, *(np.moveaxis(out[block], 0, -1) for out in outputs))
    return [out.reshape(*batch, *shape) for out, shape in zip(outputs, shapes, strict=True)]


def _read(name: str, argument: str, value: npt.ArrayLike, size: int) -> Array:
    array = np.asarray(value) if size > 1 else np.atleast_1d(value)  # a number stands for a vector of one
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name}: argument {argument}: expected real numbers, got {array.dtype}")
    if array.ndim == 0 or array.shape[-1] != size:
        raise ValueError(f"{name}: argument {argument}: expected shape (..., {size}), got {array.shape}")
    return array.astype(np.float64, copy=False)


def _batch(name: str, names: list[str], values: list[Array]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(value.shape[:-1] for value in values))
    except ValueError:
        got = ", ".join(f"{n} {v.shape[:-1]}" for n, v in zip(names, values, strict=True))
        raise ValueError(f"{name}: leading dimensions do not broadcast: {got}") from None


def _rows(value: Array, batch: tuple[int, ...]) -> Array:
    """One row an element, or a single row that all elements share."""
    shared = prod(value.shape[:-1]) == 1
    return (value if shared else np.broadcast_to(value, (*batch, value.shape[-1]))).reshape(-1, value.shape[-1])
