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
#
# Regenerate: liegen generate --group SO2 --group SE2 --group SO3 --group SE3 --group SE23 --group Gal3 -o DIR
#
# SPDX-License-Identifier: 0BSD
# Generated by liegen. This code is free: use, change and ship it for any purpose, without conditions.
"""Functions and their Jacobians on NumPy arrays."""

from ._so2_compose import So2ComposeJacobians as So2ComposeJacobians
from ._so2_compose import so2_compose as so2_compose
from ._so2_compose import so2_compose_jacobians as so2_compose_jacobians
from ._so2_inverse import So2InverseJacobians as So2InverseJacobians
from ._so2_inverse import so2_inverse as so2_inverse
from ._so2_inverse import so2_inverse_jacobians as so2_inverse_jacobians
from ._so2_between import So2BetweenJacobians as So2BetweenJacobians
from ._so2_between import so2_between as so2_between
from ._so2_between import so2_between_jacobians as so2_between_jacobians
from ._so2_act import So2ActJacobians as So2ActJacobians
from ._so2_act import so2_act as so2_act
from ._so2_act import so2_act_jacobians as so2_act_jacobians
from ._so2_transform_to import So2TransformToJacobians as So2TransformToJacobians
from ._so2_transform_to import so2_transform_to as so2_transform_to
from ._so2_transform_to import so2_transform_to_jacobians as so2_transform_to_jacobians
from ._so2_exp import So2ExpJacobians as So2ExpJacobians
from ._so2_exp import so2_exp as so2_exp
from ._so2_exp import so2_exp_jacobians as so2_exp_jacobians
from ._so2_log import So2LogJacobians as So2LogJacobians
from ._so2_log import so2_log as so2_log
from ._so2_log import so2_log_jacobians as so2_log_jacobians
from ._so2_retract import So2RetractJacobians as So2RetractJacobians
from ._so2_retract import so2_retract as so2_retract
from ._so2_retract import so2_retract_jacobians as so2_retract_jacobians
from ._so2_local import So2LocalJacobians as So2LocalJacobians
from ._so2_local import so2_local as so2_local
from ._so2_local import so2_local_jacobians as so2_local_jacobians
from ._so2_adjoint import so2_adjoint as so2_adjoint
from ._so2_ad import so2_ad as so2_ad
from ._so2_Jr import so2_Jr as so2_Jr
from ._so2_Jl import so2_Jl as so2_Jl
from ._so2_Jr_inv import so2_Jr_inv as so2_Jr_inv
from ._so2_Jl_inv import so2_Jl_inv as so2_Jl_inv
from ._se2_compose import Se2ComposeJacobians as Se2ComposeJacobians
from ._se2_compose import se2_compose as se2_compose
from ._se2_compose import se2_compose_jacobians as se2_compose_jacobians
from ._se2_inverse import Se2InverseJacobians as Se2InverseJacobians
from ._se2_inverse import se2_inverse as se2_inverse
from ._se2_inverse import se2_inverse_jacobians as se2_inverse_jacobians
from ._se2_between import Se2BetweenJacobians as Se2BetweenJacobians
from ._se2_between import se2_between as se2_between
from ._se2_between import se2_between_jacobians as se2_between_jacobians
from ._se2_act import Se2ActJacobians as Se2ActJacobians
from ._se2_act import se2_act as se2_act
from ._se2_act import se2_act_jacobians as se2_act_jacobians
from ._se2_transform_to import Se2TransformToJacobians as Se2TransformToJacobians
from ._se2_transform_to import se2_transform_to as se2_transform_to
from ._se2_transform_to import se2_transform_to_jacobians as se2_transform_to_jacobians
from ._se2_exp import Se2ExpJacobians as Se2ExpJacobians
from ._se2_exp import se2_exp as se2_exp
from ._se2_exp import se2_exp_jacobians as se2_exp_jacobians
from ._se2_log import Se2LogJacobians as Se2LogJacobians
from ._se2_log import se2_log as se2_log
from ._se2_log import se2_log_jacobians as se2_log_jacobians
from ._se2_retract import Se2RetractJacobians as Se2RetractJacobians
from ._se2_retract import se2_retract as se2_retract
from ._se2_retract import se2_retract_jacobians as se2_retract_jacobians
from ._se2_local import Se2LocalJacobians as Se2LocalJacobians
from ._se2_local import se2_local as se2_local
from ._se2_local import se2_local_jacobians as se2_local_jacobians
from ._se2_adjoint import se2_adjoint as se2_adjoint
from ._se2_ad import se2_ad as se2_ad
from ._se2_Jr import se2_Jr as se2_Jr
from ._se2_Jl import se2_Jl as se2_Jl
from ._se2_Jr_inv import se2_Jr_inv as se2_Jr_inv
from ._se2_Jl_inv import se2_Jl_inv as se2_Jl_inv
from ._so3_compose import So3ComposeJacobians as So3ComposeJacobians
from ._so3_compose import so3_compose as so3_compose
from ._so3_compose import so3_compose_jacobians as so3_compose_jacobians
from ._so3_inverse import So3InverseJacobians as So3InverseJacobians
from ._so3_inverse import so3_inverse as so3_inverse
from ._so3_inverse import so3_inverse_jacobians as so3_inverse_jacobians
from ._so3_between import So3BetweenJacobians as So3BetweenJacobians
from ._so3_between import so3_between as so3_between
from ._so3_between import so3_between_jacobians as so3_between_jacobians
from ._so3_act import So3ActJacobians as So3ActJacobians
from ._so3_act import so3_act as so3_act
from ._so3_act import so3_act_jacobians as so3_act_jacobians
from ._so3_transform_to import So3TransformToJacobians as So3TransformToJacobians
from ._so3_transform_to import so3_transform_to as so3_transform_to
from ._so3_transform_to import so3_transform_to_jacobians as so3_transform_to_jacobians
from ._so3_exp import So3ExpJacobians as So3ExpJacobians
from ._so3_exp import so3_exp as so3_exp
from ._so3_exp import so3_exp_jacobians as so3_exp_jacobians
from ._so3_log import So3LogJacobians as So3LogJacobians
from ._so3_log import so3_log as so3_log
from ._so3_log import so3_log_jacobians as so3_log_jacobians
from ._so3_retract import So3RetractJacobians as So3RetractJacobians
from ._so3_retract import so3_retract as so3_retract
from ._so3_retract import so3_retract_jacobians as so3_retract_jacobians
from ._so3_local import So3LocalJacobians as So3LocalJacobians
from ._so3_local import so3_local as so3_local
from ._so3_local import so3_local_jacobians as so3_local_jacobians
from ._so3_adjoint import so3_adjoint as so3_adjoint
from ._so3_ad import so3_ad as so3_ad
from ._so3_Jr import so3_Jr as so3_Jr
from ._so3_Jl import so3_Jl as so3_Jl
from ._so3_Jr_inv import so3_Jr_inv as so3_Jr_inv
from ._so3_Jl_inv import so3_Jl_inv as so3_Jl_inv
from ._se3_compose import Se3ComposeJacobians as Se3ComposeJacobians
from ._se3_compose import se3_compose as se3_compose
from ._se3_compose import se3_compose_jacobians as se3_compose_jacobians
from ._se3_inverse import Se3InverseJacobians as Se3InverseJacobians
from ._se3_inverse import se3_inverse as se3_inverse
from ._se3_inverse import se3_inverse_jacobians as se3_inverse_jacobians
from ._se3_between import Se3BetweenJacobians as Se3BetweenJacobians
from ._se3_between import se3_between as se3_between
from ._se3_between import se3_between_jacobians as se3_between_jacobians
from ._se3_act import Se3ActJacobians as Se3ActJacobians
from ._se3_act import se3_act as se3_act
from ._se3_act import se3_act_jacobians as se3_act_jacobians
from ._se3_transform_to import Se3TransformToJacobians as Se3TransformToJacobians
from ._se3_transform_to import se3_transform_to as se3_transform_to
from ._se3_transform_to import se3_transform_to_jacobians as se3_transform_to_jacobians
from ._se3_exp import Se3ExpJacobians as Se3ExpJacobians
from ._se3_exp import se3_exp as se3_exp
from ._se3_exp import se3_exp_jacobians as se3_exp_jacobians
from ._se3_log import Se3LogJacobians as Se3LogJacobians
from ._se3_log import se3_log as se3_log
from ._se3_log import se3_log_jacobians as se3_log_jacobians
from ._se3_retract import Se3RetractJacobians as Se3RetractJacobians
from ._se3_retract import se3_retract as se3_retract
from ._se3_retract import se3_retract_jacobians as se3_retract_jacobians
from ._se3_local import Se3LocalJacobians as Se3LocalJacobians
from ._se3_local import se3_local as se3_local
from ._se3_local import se3_local_jacobians as se3_local_jacobians
from ._se3_adjoint import se3_adjoint as se3_adjoint
from ._se3_ad import se3_ad as se3_ad
from ._se3_Jr import se3_Jr as se3_Jr
from ._se3_Jl import se3_Jl as se3_Jl
from ._se3_Jr_inv import se3_Jr_inv as se3_Jr_inv
from ._se3_Jl_inv import se3_Jl_inv as se3_Jl_inv
from ._se23_compose import Se23ComposeJacobians as Se23ComposeJacobians
from ._se23_compose import se23_compose as se23_compose
from ._se23_compose import se23_compose_jacobians as se23_compose_jacobians
from ._se23_inverse import Se23InverseJacobians as Se23InverseJacobians
from ._se23_inverse import se23_inverse as se23_inverse
from ._se23_inverse import se23_inverse_jacobians as se23_inverse_jacobians
from ._se23_between import Se23BetweenJacobians as Se23BetweenJacobians
from ._se23_between import se23_between as se23_between
from ._se23_between import se23_between_jacobians as se23_between_jacobians
from ._se23_exp import Se23ExpJacobians as Se23ExpJacobians
from ._se23_exp import se23_exp as se23_exp
from ._se23_exp import se23_exp_jacobians as se23_exp_jacobians
from ._se23_log import Se23LogJacobians as Se23LogJacobians
from ._se23_log import se23_log as se23_log
from ._se23_log import se23_log_jacobians as se23_log_jacobians
from ._se23_retract import Se23RetractJacobians as Se23RetractJacobians
from ._se23_retract import se23_retract as se23_retract
from ._se23_retract import se23_retract_jacobians as se23_retract_jacobians
from ._se23_local import Se23LocalJacobians as Se23LocalJacobians
from ._se23_local import se23_local as se23_local
from ._se23_local import se23_local_jacobians as se23_local_jacobians
from ._se23_adjoint import se23_adjoint as se23_adjoint
from ._se23_ad import se23_ad as se23_ad
from ._se23_Jr import se23_Jr as se23_Jr
from ._se23_Jl import se23_Jl as se23_Jl
from ._se23_Jr_inv import se23_Jr_inv as se23_Jr_inv
from ._se23_Jl_inv import se23_Jl_inv as se23_Jl_inv
from ._gal3_compose import Gal3ComposeJacobians as Gal3ComposeJacobians
from ._gal3_compose import gal3_compose as gal3_compose
from ._gal3_compose import gal3_compose_jacobians as gal3_compose_jacobians
from ._gal3_inverse import Gal3InverseJacobians as Gal3InverseJacobians
from ._gal3_inverse import gal3_inverse as gal3_inverse
from ._gal3_inverse import gal3_inverse_jacobians as gal3_inverse_jacobians
from ._gal3_between import Gal3BetweenJacobians as Gal3BetweenJacobians
from ._gal3_between import gal3_between as gal3_between
from ._gal3_between import gal3_between_jacobians as gal3_between_jacobians
from ._gal3_exp import Gal3ExpJacobians as Gal3ExpJacobians
from ._gal3_exp import gal3_exp as gal3_exp
from ._gal3_exp import gal3_exp_jacobians as gal3_exp_jacobians
from ._gal3_log import Gal3LogJacobians as Gal3LogJacobians
from ._gal3_log import gal3_log as gal3_log
from ._gal3_log import gal3_log_jacobians as gal3_log_jacobians
from ._gal3_retract import Gal3RetractJacobians as Gal3RetractJacobians
from ._gal3_retract import gal3_retract as gal3_retract
from ._gal3_retract import gal3_retract_jacobians as gal3_retract_jacobians
from ._gal3_local import Gal3LocalJacobians as Gal3LocalJacobians
from ._gal3_local import gal3_local as gal3_local
from ._gal3_local import gal3_local_jacobians as gal3_local_jacobians
from ._gal3_adjoint import gal3_adjoint as gal3_adjoint
from ._gal3_ad import gal3_ad as gal3_ad
from ._gal3_Jr import gal3_Jr as gal3_Jr
from ._gal3_Jl import gal3_Jl as gal3_Jl
from ._gal3_Jr_inv import gal3_Jr_inv as gal3_Jr_inv
from ._gal3_Jl_inv import gal3_Jl_inv as gal3_Jl_inv

__all__ = [
    "So2ComposeJacobians",
    "so2_compose",
    "so2_compose_jacobians",
    "So2InverseJacobians",
    "so2_inverse",
    "so2_inverse_jacobians",
    "So2BetweenJacobians",
    "so2_between",
    "so2_between_jacobians",
    "So2ActJacobians",
    "so2_act",
    "so2_act_jacobians",
    "So2TransformToJacobians",
    "so2_transform_to",
    "so2_transform_to_jacobians",
    "So2ExpJacobians",
    "so2_exp",
    "so2_exp_jacobians",
    "So2LogJacobians",
    "so2_log",
    "so2_log_jacobians",
    "So2RetractJacobians",
    "so2_retract",
    "so2_retract_jacobians",
    "So2LocalJacobians",
    "so2_local",
    "so2_local_jacobians",
    "so2_adjoint",
    "so2_ad",
    "so2_Jr",
    "so2_Jl",
    "so2_Jr_inv",
    "so2_Jl_inv",
    "Se2ComposeJacobians",
    "se2_compose",
    "se2_compose_jacobians",
    "Se2InverseJacobians",
    "se2_inverse",
    "se2_inverse_jacobians",
    "Se2BetweenJacobians",
    "se2_between",
    "se2_between_jacobians",
    "Se2ActJacobians",
    "se2_act",
    "se2_act_jacobians",
    "Se2TransformToJacobians",
    "se2_transform_to",
    "se2_transform_to_jacobians",
    "Se2ExpJacobians",
    "se2_exp",
    "se2_exp_jacobians",
    "Se2LogJacobians",
    "se2_log",
    "se2_log_jacobians",
    "Se2RetractJacobians",
    "se2_retract",
    "se2_retract_jacobians",
    "Se2LocalJacobians",
    "se2_local",
    "se2_local_jacobians",
    "se2_adjoint",
    "se2_ad",
    "se2_Jr",
    "se2_Jl",
    "se2_Jr_inv",
    "se2_Jl_inv",
    "So3ComposeJacobians",
    "so3_compose",
    "so3_compose_jacobians",
    "So3InverseJacobians",
    "so3_inverse",
    "so3_inverse_jacobians",
    "So3BetweenJacobians",
    "so3_between",
    "so3_between_jacobians",
    "So3ActJacobians",
    "so3_act",
    "so3_act_jacobians",
    "So3TransformToJacobians",
    "so3_transform_to",
    "so3_transform_to_jacobians",
    "So3ExpJacobians",
    "so3_exp",
    "so3_exp_jacobians",
    "So3LogJacobians",
    "so3_log",
    "so3_log_jacobians",
    "So3RetractJacobians",
    "so3_retract",
    "so3_retract_jacobians",
    "So3LocalJacobians",
    "so3_local",
    "so3_local_jacobians",
    "so3_adjoint",
    "so3_ad",
    "so3_Jr",
    "so3_Jl",
    "so3_Jr_inv",
    "so3_Jl_inv",
    "Se3ComposeJacobians",
    "se3_compose",
    "se3_compose_jacobians",
    "Se3InverseJacobians",
    "se3_inverse",
    "se3_inverse_jacobians",
    "Se3BetweenJacobians",
    "se3_between",
    "se3_between_jacobians",
    "Se3ActJacobians",
    "se3_act",
    "se3_act_jacobians",
    "Se3TransformToJacobians",
    "se3_transform_to",
    "se3_transform_to_jacobians",
    "Se3ExpJacobians",
    "se3_exp",
    "se3_exp_jacobians",
    "Se3LogJacobians",
    "se3_log",
    "se3_log_jacobians",
    "Se3RetractJacobians",
    "se3_retract",
    "se3_retract_jacobians",
    "Se3LocalJacobians",
    "se3_local",
    "se3_local_jacobians",
    "se3_adjoint",
    "se3_ad",
    "se3_Jr",
    "se3_Jl",
    "se3_Jr_inv",
    "se3_Jl_inv",
    "Se23ComposeJacobians",
    "se23_compose",
    "se23_compose_jacobians",
    "Se23InverseJacobians",
    "se23_inverse",
    "se23_inverse_jacobians",
    "Se23BetweenJacobians",
    "se23_between",
    "se23_between_jacobians",
    "Se23ExpJacobians",
    "se23_exp",
    "se23_exp_jacobians",
    "Se23LogJacobians",
    "se23_log",
    "se23_log_jacobians",
    "Se23RetractJacobians",
    "se23_retract",
    "se23_retract_jacobians",
    "Se23LocalJacobians",
    "se23_local",
    "se23_local_jacobians",
    "se23_adjoint",
    "se23_ad",
    "se23_Jr",
    "se23_Jl",
    "se23_Jr_inv",
    "se23_Jl_inv",
    "Gal3ComposeJacobians",
    "gal3_compose",
    "gal3_compose_jacobians",
    "Gal3InverseJacobians",
    "gal3_inverse",
    "gal3_inverse_jacobians",
    "Gal3BetweenJacobians",
    "gal3_between",
    "gal3_between_jacobians",
    "Gal3ExpJacobians",
    "gal3_exp",
    "gal3_exp_jacobians",
    "Gal3LogJacobians",
    "gal3_log",
    "gal3_log_jacobians",
    "Gal3RetractJacobians",
    "gal3_retract",
    "gal3_retract_jacobians",
    "Gal3LocalJacobians",
    "gal3_local",
    "gal3_local_jacobians",
    "gal3_adjoint",
    "gal3_ad",
    "gal3_Jr",
    "gal3_Jl",
    "gal3_Jr_inv",
    "gal3_Jl_inv",
]
