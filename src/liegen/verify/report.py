"""What a verification found, as frozen values."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Check:
    """One check of one factor.

    ``worst`` is the largest error in the given unit, at the sample ``where``; ``bound`` what is allowed.
    ``kept`` samples were compared; ``skipped`` names the cases that could not be, with the reason.
    ``checked`` is false where the machine lacks what the check needs (a C compiler).
    """

    name: str
    passed: bool
    worst: float
    bound: float
    unit: str
    where: str
    kept: int
    skipped: tuple[str, ...] = ()
    note: str = ""
    checked: bool = True


@dataclass(frozen=True)
class OffUnit:
    """The largest error where quaternions and the like are ``off`` unit length, as is and with normalise."""

    off: float
    as_is: float
    normalised: float


@dataclass(frozen=True)
class FactorReport:
    """All checks of one factor, and what arguments off unit length do to it."""

    factor: str
    checks: tuple[Check, ...]
    off_unit: tuple[OffUnit, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


@dataclass(frozen=True)
class Report:
    """All factors, in the order in which they were given. ``compiler`` is empty where there is none."""

    factors: tuple[FactorReport, ...]
    samples: int
    seed: int
    compiler: str

    @property
    def passed(self) -> bool:
        """Whether every factor passed."""
        return all(factor.passed for factor in self.factors)

    def to_json(self) -> str:
        """The report as JSON; numbers that are not finite become strings."""
        factors = [
            {
                "factor": f.factor,
                "passed": f.passed,
                "checks": [_finite(asdict(c)) for c in f.checks],
                "off_unit": [_finite(asdict(o)) for o in f.off_unit],
            }
            for f in self.factors
        ]
        content = {
            "passed": self.passed,
            "samples": self.samples,
            "seed": self.seed,
            "compiler": self.compiler,
            "factors": factors,
        }
        return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _finite(check: dict[str, Any]) -> dict[str, Any]:
    return {k: str(v) if isinstance(v, float) and not math.isfinite(v) else v for k, v in check.items()}
