"""The registry of targets: one row per language."""

from __future__ import annotations

from . import c_target, numpy_target

TARGETS = (numpy_target.TARGET, c_target.TARGET)
