"""Factors compiled and called from Python."""

from __future__ import annotations

from .compiled import Compiled as Compiled
from .compiled import Indexed as Indexed
from .compiled import compile as compile
from .normal_equations import NormalEquations as NormalEquations
from .sparse_solver import SparseSolver as SparseSolver
