"""Measurements of generated code: ratios of variants that are timed in turn in one run."""

from __future__ import annotations
