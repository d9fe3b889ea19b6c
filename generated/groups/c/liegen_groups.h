/*
 * liegen_groups: functions and their Jacobians
 *
 * Formulas:
 *   so2_compose: out = x.compose(y)
 *   so2_inverse: out = x.inverse()
 *   so2_between: out = x.between(y)
 *   so2_act: out = x @ p
 *   so2_transform_to: out = x.unrotate(p)
 *   so2_exp: out = SO2.exp(d)
 *   so2_log: out = x.log()
 *   so2_retract: out = x.retract(d)
 *   so2_local: out = x.local(y)
 *   so2_adjoint: out = x.adjoint()
 *   so2_ad: out = SO2.ad(d)
 *   so2_Jr: out = SO2.Jr(d)
 *   so2_Jl: out = SO2.Jl(d)
 *   so2_Jr_inv: out = SO2.Jr_inv(d)
 *   so2_Jl_inv: out = SO2.Jl_inv(d)
 *   se2_compose: out = x.compose(y)
 *   se2_inverse: out = x.inverse()
 *   se2_between: out = x.between(y)
 *   se2_act: out = x.transform_from(p)
 *   se2_transform_to: out = x.transform_to(p)
 *   se2_exp: out = SE2.exp(d)
 *   se2_log: out = x.log()
 *   se2_retract: out = x.retract(d)
 *   se2_local: out = x.local(y)
 *   se2_adjoint: out = x.adjoint()
 *   se2_ad: out = SE2.ad(d)
 *   se2_Jr: out = SE2.Jr(d)
 *   se2_Jl: out = SE2.Jl(d)
 *   se2_Jr_inv: out = SE2.Jr_inv(d)
 *   se2_Jl_inv: out = SE2.Jl_inv(d)
 *   so3_compose: out = x.compose(y)
 *   so3_inverse: out = x.inverse()
 *   so3_between: out = x.between(y)
 *   so3_act: out = x @ p
 *   so3_transform_to: out = x.unrotate(p)
 *   so3_exp: out = SO3.exp(d)
 *   so3_log: out = x.log()
 *   so3_retract: out = x.retract(d)
 *   so3_local: out = x.local(y)
 *   so3_adjoint: out = x.adjoint()
 *   so3_ad: out = SO3.ad(d)
 *   so3_Jr: out = SO3.Jr(d)
 *   so3_Jl: out = SO3.Jl(d)
 *   so3_Jr_inv: out = SO3.Jr_inv(d)
 *   so3_Jl_inv: out = SO3.Jl_inv(d)
 *   se3_compose: out = x.compose(y)
 *   se3_inverse: out = x.inverse()
 *   se3_between: out = x.between(y)
 *   se3_act: out = x.transform_from(p)
 *   se3_transform_to: out = x.transform_to(p)
 *   se3_exp: out = SE3.exp(d)
 *   se3_log: out = x.log()
 *   se3_retract: out = x.retract(d)
 *   se3_local: out = x.local(y)
 *   se3_adjoint: out = x.adjoint()
 *   se3_ad: out = SE3.ad(d)
 *   se3_Jr: out = SE3.Jr(d)
 *   se3_Jl: out = SE3.Jl(d)
 *   se3_Jr_inv: out = SE3.Jr_inv(d)
 *   se3_Jl_inv: out = SE3.Jl_inv(d)
 *   se23_compose: out = x.compose(y)
 *   se23_inverse: out = x.inverse()
 *   se23_between: out = x.between(y)
 *   se23_exp: out = SE23.exp(d)
 *   se23_log: out = x.log()
 *   se23_retract: out = x.retract(d)
 *   se23_local: out = x.local(y)
 *   se23_adjoint: out = x.adjoint()
 *   se23_ad: out = SE23.ad(d)
 *   se23_Jr: out = SE23.Jr(d)
 *   se23_Jl: out = SE23.Jl(d)
 *   se23_Jr_inv: out = SE23.Jr_inv(d)
 *   se23_Jl_inv: out = SE23.Jl_inv(d)
 *   gal3_compose: out = x.compose(y)
 *   gal3_inverse: out = x.inverse()
 *   gal3_between: out = x.between(y)
 *   gal3_exp: out = Gal3.exp(d)
 *   gal3_log: out = x.log()
 *   gal3_retract: out = x.retract(d)
 *   gal3_local: out = x.local(y)
 *   gal3_adjoint: out = x.adjoint()
 *   gal3_ad: out = Gal3.ad(d)
 *   gal3_Jr: out = Gal3.Jr(d)
 *   gal3_Jl: out = Gal3.Jl(d)
 *   gal3_Jr_inv: out = Gal3.Jr_inv(d)
 *   gal3_Jl_inv: out = Gal3.Jl_inv(d)
 *
 * Conventions:
 *   SO2: stored (cos, sin); tangent: angle [rad]; x.retract(d) = x exp(d)
 *   R2: stored as it is; tangent: the same; x.retract(d) = x + d
 *   R1: stored as it is; tangent: the same; x.retract(d) = x + d
 *   SE2: stored (cos, sin, x, y); tangent: x [m], y [m], angle [rad]; x.retract(d) = x exp(d)
 *   R3: stored as it is; tangent: the same; x.retract(d) = x + d
 *   SO3: stored unit quaternion (x, y, z, w); tangent: rotation vector [rad]; x.retract(d) = x exp(d)
 *   SE3: stored quaternion (x, y, z, w), translation (x, y, z); tangent: rotation [rad], translation [m];
 *       x.retract(d) = x exp(d)
 *   R6: stored as it is; tangent: the same; x.retract(d) = x + d
 *   SE23: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z); tangent: rotation [rad],
 *       position [m], velocity [m/s]; x.retract(d) = x exp(d)
 *   R9: stored as it is; tangent: the same; x.retract(d) = x + d
 *   Gal3: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z), time; tangent: rotation
 *       [rad], position [m], velocity [m/s], time [s]; x.retract(d) = x exp(d)
 *   R10: stored as it is; tangent: the same; x.retract(d) = x + d
 *
 * Shapes and units: at the top of each function's file.
 *
 * Operations:
 *   so2_compose: 6, with Jacobians 6
 *   so2_inverse: 1, with Jacobians 1
 *   so2_between: 6, with Jacobians 6
 *   so2_act: 6, with Jacobians 8
 *   so2_transform_to: 6, with Jacobians 8
 *   so2_exp: 2, with Jacobians 2
 *   so2_log: 1, with Jacobians 1
 *   so2_retract: 8, with Jacobians 8
 *   so2_local: 7, with Jacobians 7
 *   so2_adjoint: 0
 *   so2_ad: 0
 *   so2_Jr: 0
 *   so2_Jl: 0
 *   so2_Jr_inv: 0
 *   so2_Jl_inv: 0
 *   se2_compose: 14, with Jacobians 21
 *   se2_inverse: 7, with Jacobians 9
 *   se2_between: 14, with Jacobians 22
 *   se2_act: 8, with Jacobians 9
 *   se2_transform_to: 8, with Jacobians 10
 *   se2_exp: 20, with Jacobians 47
 *   se2_log: 25, with Jacobians 33
 *   se2_retract: 34, with Jacobians 68
 *   se2_local: 39, with Jacobians 50
 *   se2_adjoint: 2
 *   se2_ad: 2
 *   se2_Jr: 39
 *   se2_Jl: 39
 *   se2_Jr_inv: 38
 *   se2_Jl_inv: 38
 *   so3_compose: 28, with Jacobians 51
 *   so3_inverse: 3, with Jacobians 26
 *   so3_between: 28, with Jacobians 51
 *   so3_act: 38, with Jacobians 65
 *   so3_transform_to: 38, with Jacobians 41
 *   so3_exp: 16, with Jacobians 60
 *   so3_log: 33, with Jacobians 75
 *   so3_retract: 44, with Jacobians 111
 *   so3_local: 61, with Jacobians 112
 *   so3_adjoint: 23
 *   so3_ad: 3
 *   so3_Jr: 57
 *   so3_Jl: 57
 *   so3_Jr_inv: 54
 *   so3_Jl_inv: 54
 *   se3_compose: 61, with Jacobians 111
 *   se3_inverse: 33, with Jacobians 83
 *   se3_between: 61, with Jacobians 112
 *   se3_act: 41, with Jacobians 68
 *   se3_transform_to: 41, with Jacobians 44
 *   se3_exp: 79, with Jacobians 166
 *   se3_log: 90, with Jacobians 156
 *   se3_retract: 140, with Jacobians 277
 *   se3_local: 150, with Jacobians 235
 *   se3_adjoint: 50
 *   se3_ad: 6
 *   se3_Jr: 148
 *   se3_Jl: 148
 *   se3_Jr_inv: 125
 *   se3_Jl_inv: 125
 *   se23_compose: 87, with Jacobians 164
 *   se23_inverse: 56, with Jacobians 110
 *   se23_between: 87, with Jacobians 166
 *   se23_exp: 94, with Jacobians 236
 *   se23_log: 105, with Jacobians 218
 *   se23_retract: 181, with Jacobians 400
 *   se23_local: 191, with Jacobians 332
 *   se23_adjoint: 77
 *   se23_ad: 9
 *   se23_Jr: 203
 *   se23_Jl: 203
 *   se23_Jr_inv: 173
 *   se23_Jl_inv: 173
 *   gal3_compose: 94, with Jacobians 196
 *   gal3_inverse: 63, with Jacobians 131
 *   gal3_between: 94, with Jacobians 198
 *   gal3_exp: 152, with Jacobians 407
 *   gal3_log: 129, with Jacobians 300
 *   gal3_retract: 246, with Jacobians 603
 *   gal3_local: 222, with Jacobians 421
 *   gal3_adjoint: 93
 *   gal3_ad: 10
 *   gal3_Jr: 365
 *   gal3_Jl: 365
 *   gal3_Jr_inv: 245
 *   gal3_Jl_inv: 245
 *
 * Regenerate: liegen generate --group SO2 --group SE2 --group SO3 --group SE3 --group SE23 --group Gal3 -o DIR
 *
 * SPDX-License-Identifier: 0BSD
 * Generated by liegen. This code is free: use, change and ship it for any purpose, without conditions.
 */
#ifndef LIEGEN_GROUPS_H
#define LIEGEN_GROUPS_H

#include "so2_compose.h"
#include "so2_inverse.h"
#include "so2_between.h"
#include "so2_act.h"
#include "so2_transform_to.h"
#include "so2_exp.h"
#include "so2_log.h"
#include "so2_retract.h"
#include "so2_local.h"
#include "so2_adjoint.h"
#include "so2_ad.h"
#include "so2_Jr.h"
#include "so2_Jl.h"
#include "so2_Jr_inv.h"
#include "so2_Jl_inv.h"
#include "se2_compose.h"
#include "se2_inverse.h"
#include "se2_between.h"
#include "se2_act.h"
#include "se2_transform_to.h"
#include "se2_exp.h"
#include "se2_log.h"
#include "se2_retract.h"
#include "se2_local.h"
#include "se2_adjoint.h"
#include "se2_ad.h"
#include "se2_Jr.h"
#include "se2_Jl.h"
#include "se2_Jr_inv.h"
#include "se2_Jl_inv.h"
#include "so3_compose.h"
#include "so3_inverse.h"
#include "so3_between.h"
#include "so3_act.h"
#include "so3_transform_to.h"
#include "so3_exp.h"
#include "so3_log.h"
#include "so3_retract.h"
#include "so3_local.h"
#include "so3_adjoint.h"
#include "so3_ad.h"
#include "so3_Jr.h"
#include "so3_Jl.h"
#include "so3_Jr_inv.h"
#include "so3_Jl_inv.h"
#include "se3_compose.h"
#include "se3_inverse.h"
#include "se3_between.h"
#include "se3_act.h"
#include "se3_transform_to.h"
#include "se3_exp.h"
#include "se3_log.h"
#include "se3_retract.h"
#include "se3_local.h"
#include "se3_adjoint.h"
#include "se3_ad.h"
#include "se3_Jr.h"
#include "se3_Jl.h"
#include "se3_Jr_inv.h"
#include "se3_Jl_inv.h"
#include "se23_compose.h"
#include "se23_inverse.h"
#include "se23_between.h"
#include "se23_exp.h"
#include "se23_log.h"
#include "se23_retract.h"
#include "se23_local.h"
#include "se23_adjoint.h"
#include "se23_ad.h"
#include "se23_Jr.h"
#include "se23_Jl.h"
#include "se23_Jr_inv.h"
#include "se23_Jl_inv.h"
#include "gal3_compose.h"
#include "gal3_inverse.h"
#include "gal3_between.h"
#include "gal3_exp.h"
#include "gal3_log.h"
#include "gal3_retract.h"
#include "gal3_local.h"
#include "gal3_adjoint.h"
#include "gal3_ad.h"
#include "gal3_Jr.h"
#include "gal3_Jl.h"
#include "gal3_Jr_inv.h"
#include "gal3_Jl_inv.h"

#endif
