"""Measurements of generated code: ratios of variants that are timed in turn in one run."""

from __future__ import annotations

from .casadi_c import FLAGS as FLAGS
from .casadi_c import compare as compare
from .timing import Row as Row
