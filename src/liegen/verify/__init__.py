"""Proof that generated code is right: an independent reference, differences, remainders, and agreement."""

from __future__ import annotations

from .report import Check as Check
from .report import FactorReport as FactorReport
from .report import Report as Report
from .run import verify as verify
from .sanity import check_finite as check_finite
