"""Numbers of options: each has a range, and is written as numbers are everywhere.

Python takes more: ``1_0`` is 10, digits of other scripts count, ``inf`` is a float.
"""

from __future__ import annotations

import math
import re
from typing import Any

import click

_WHOLE = re.compile(r"[+-]?[0-9]+")
_REAL = re.compile(r"[+-.0-9a-zA-Z]+")


def _odd(given: object, written: re.Pattern[str]) -> bool:
    return isinstance(given, str) and not written.fullmatch(given)


class Whole(click.IntRange):
    """A whole number in a range, in the digits 0 to 9."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Raises BadParameter for anything else."""
        if _odd(value, _WHOLE):
            self.fail(f"{value!r} is not a valid integer.", param, ctx)
        return super().convert(value, param, ctx)


class Finite(click.FloatRange):
    """A finite number in a range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Raises BadParameter for anything else."""
        if _odd(value, _REAL):
            self.fail(f"{value!r} is not a valid float.", param, ctx)
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


#: Seeds of random samples.
SEED = Whole(0, 2**63 - 1)
#: How many samples of a factor.
COUNT = Whole(1, 100_000)
#: A relative difference.
TOLERANCE = Finite(min=0, min_open=True)
