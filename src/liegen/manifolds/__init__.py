"""Manifolds: closed forms on scalars of any backend (``*_form``), and the typed values that use them."""

from __future__ import annotations

from .calibration import Cal3_S2 as Cal3_S2
from .calibration import Cal3Bundler as Cal3Bundler
from .calibration import Cal3DS2 as Cal3DS2
from .calibration import Calibration as Calibration
from .condition import Condition as Condition
from .extended import SE23 as SE23
from .extended import NavState as NavState
from .form import ManifoldForm as ManifoldForm
from .galilean import Gal3 as Gal3
from .group import Group as Group
from .group import Manifold as Manifold
from .groups import SE2 as SE2
from .groups import SE3 as SE3
from .groups import SO2 as SO2
from .groups import SO3 as SO3
from .matrix import MatrixValue as MatrixValue
from .matrix import matrix_class as matrix_class
from .node import Leaf as Leaf
from .node import Node as Node
from .node import Operation as Operation
from .node import Value as Value
from .product import Product as Product
from .s2 import S2 as S2
from .similarity import Sim2 as Sim2
from .similarity import Sim3 as Sim3
from .vector import R1 as R1
from .vector import R2 as R2
from .vector import R3 as R3
from .vector import R4 as R4
from .vector import R5 as R5
from .vector import R6 as R6
from .vector import R7 as R7
from .vector import R8 as R8
from .vector import R9 as R9
from .vector import R as R
from .vector import Vector as Vector
