"""The singular points of a formula's own operations: samples that are solved for them, and what is said."""

from __future__ import annotations

from .check import singular_points as singular_points
