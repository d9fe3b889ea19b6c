"""What the tests of verification share."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from liegen.define import Function

HERE = Path(__file__).parent


def user_factors() -> dict[str, Function]:
    """The factors of ``verified_factors.py``; other processes load them by this function too."""
    spec = importlib.util.spec_from_file_location("verified_factors", HERE / "verified_factors.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return {f.name: f for f in vars(module).values() if isinstance(f, Function)}


def failures(report) -> list[str]:
    """One line for each failed check."""
    return [
        f"{c.name}: {c.worst:.3g} (bound {c.bound:.3g}, {c.unit}) at {c.where}; {c.kept} kept; {c.note}"
        for c in report.checks
        if not c.passed
    ]
