"""liegen: factors and Jacobians on Lie groups, derived, emitted as NumPy and C, and verified.

Names are loaded on first use, so that ``import liegen`` is quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from .charts import Chart as Chart
    from .decorate import factor as factor
    from .decorate import function as function
    from .define import Function as Function
    from .errors import DefinitionError as DefinitionError
    from .errors import LiegenError as LiegenError
    from .layouts import Layout as Layout
    from .manifolds import R1 as R1
    from .manifolds import R2 as R2
    from .manifolds import R3 as R3
    from .manifolds import R4 as R4
    from .manifolds import R5 as R5
    from .manifolds import R6 as R6
    from .manifolds import R7 as R7
    from .manifolds import R8 as R8
    from .manifolds import R9 as R9
    from .manifolds import S2 as S2
    from .manifolds import SE2 as SE2
    from .manifolds import SE3 as SE3
    from .manifolds import SE23 as SE23
    from .manifolds import SO2 as SO2
    from .manifolds import SO3 as SO3
    from .manifolds import Cal3_S2 as Cal3_S2
    from .manifolds import Cal3Bundler as Cal3Bundler
    from .manifolds import Cal3DS2 as Cal3DS2
    from .manifolds import Condition as Condition
    from .manifolds import Gal3 as Gal3
    from .manifolds import NavState as NavState
    from .manifolds import Product as Product
    from .manifolds import R as R
    from .manifolds import Sim2 as Sim2
    from .manifolds import Sim3 as Sim3
    from .manifolds import Vector as Vector
    from .manifolds.functions import abs as abs
    from .manifolds.functions import acos as acos
    from .manifolds.functions import asin as asin
    from .manifolds.functions import atan2 as atan2
    from .manifolds.functions import cos as cos
    from .manifolds.functions import cross as cross
    from .manifolds.functions import dot as dot
    from .manifolds.functions import exp as exp
    from .manifolds.functions import log as log
    from .manifolds.functions import maximum as maximum
    from .manifolds.functions import minimum as minimum
    from .manifolds.functions import sin as sin
    from .manifolds.functions import sqrt as sqrt
    from .manifolds.functions import tan as tan
    from .manifolds.functions import where as where
    from .manifolds.vector import norm as norm
    from .manifolds.vector import stack as stack
    from .runtime import Compiled as Compiled
    from .runtime import NormalEquations as NormalEquations
    from .runtime import SparseSolver as SparseSolver
    from .runtime import compile as compile
    from .trace import frames as frames
    from .trace import outputs as outputs
    from .trace import require as require
    from .trace import singular as singular

_NAMES: dict[str, tuple[str, ...]] = {
    ".charts": ("Chart",),
    ".decorate": ("factor", "function"),
    ".define": ("Function",),
    ".errors": ("DefinitionError", "LiegenError"),
    ".layouts": ("Layout",),
    ".manifolds": (
        "R", "R1", "R2", "R3", "R4", "R5", "R6", "R7", "R8", "R9", "S2", "SE2", "SE23", "SE3", "SO2", "SO3",
        "Cal3Bundler", "Cal3DS2", "Cal3_S2", "Condition", "Gal3", "NavState", "Product", "Sim2", "Sim3",
        "Vector",
    ),
    ".manifolds.functions": (
        "abs", "acos", "asin", "atan2", "cos", "cross", "dot", "exp", "log", "maximum", "minimum", "sin",
        "sqrt", "tan", "where",
    ),
    ".manifolds.vector": ("norm", "stack"),
    ".runtime": ("Compiled", "NormalEquations", "SparseSolver", "compile"),
    ".trace": ("frames", "outputs", "require", "singular"),
}  # fmt: skip
_HOME = {name: module for module, names in _NAMES.items() for name in names}

__all__ = ["__version__", *_HOME]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'liegen' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
