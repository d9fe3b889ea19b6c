"""Straight-line scalar programs, the lowering from CasADi, and the passes that make them small."""

from __future__ import annotations

from .program import Instruction as Instruction
from .program import Port as Port
from .program import Program as Program
from .program import Requirement as Requirement
