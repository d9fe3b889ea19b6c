"""What the header of lanes lays out for each scalar type: widths, bits, constants and polynomials."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np

from liegen.coefficients import elementary

from .precision import DOUBLE, SINGLE, Precision

#: Longest line.
WIDTH = 100
#: Numbers of a factor that are transposed at once, where a vector has as many.
ROW = 4


@dataclass(frozen=True)
class Shuffle:
    """Transposing for vectors of so many lanes.

    ``row``: side of the squares that are transposed, side by side. ``picks``: the lanes of two vectors that
    its steps take. ``join``: a vector from the rows ``r`` of all squares. ``split``: ``put`` for each row of
    ``v``.
    """

    lanes: int
    row: int
    picks: Mapping[str, str]
    join: str
    split: str

    @property
    def gathered(self) -> str:
        """A number of each of several arrays."""
        return ", ".join(f"from[{j}][at]" for j in range(self.lanes))


@dataclass(frozen=True)
class Lanes:
    """A scalar type in vectors. Numbers are spelt as doubles: :func:`in_single` rounds those of floats.

    ``widths`` by AVX-512, AVX and SSE2; ``integer`` is as wide as the type. ``x86`` ends the names of the
    machine's functions, ``register`` that of its vectors. ``far``: larger arguments of sin and cos are left
    to libm. ``shrink``: what numbers above ``large`` are multiplied by. ``top``, ``bottom``: where exp is
    infinite, and where it is 0. ``lift``: the power of two that makes denormal numbers normal.
    """

    precision: Precision
    type: Any
    integer: str
    literal: str
    widths: tuple[int, int, int]
    x86: str
    register: str
    bias: int
    far: float
    large: float
    shrink: float
    top: float
    bottom: float
    lift: int
    half_pi: tuple[float, ...]
    log_2: tuple[float, ...]
    polynomials: Mapping[str, tuple[str, ...]]
    shuffles: tuple[Shuffle, ...]

    @property
    def suffix(self) -> str:
        """Ends the names of the package's functions and structures."""
        return self.precision.suffix

    @property
    def libm(self) -> str:
        """Ends the names of libm's functions."""
        return self.precision.libm

    @property
    def size(self) -> int:
        """Bytes of a number."""
        return np.dtype(self.type).itemsize

    @property
    def mantissa(self) -> int:
        """Bits of the fraction."""
        return int(np.finfo(self.type).nmant)

    @property
    def largest(self) -> float:
        """The largest number."""
        return float(np.finfo(self.type).max)

    @property
    def smallest(self) -> float:
        """The smallest normal number."""
        return float(np.finfo(self.type).tiny)

    @property
    def largest_integer(self) -> str:
        """As a literal."""
        return f"{2 ** (8 * self.size - 1) - 1}{self.literal}"

    @property
    def shift(self) -> float:
        """Added to a number, it rounds it to an integer, which stands in the last bits of the sum."""
        return 1.5 * 2.0**self.mantissa

    @property
    def pi_tail(self) -> float:
        """What rounding takes from pi, as a part of it."""
        rounded = float(self.type(np.pi / 2))
        return math.fsum((*self.half_pi, -rounded)) / rounded

    def bits(self, x: float) -> str:
        """The bits of a number, as a literal."""
        return f"{int.from_bytes(np.array(x, self.type).tobytes(), sys.byteorder)}{self.literal}"


def _nested(coefficients: Sequence[float], x: str) -> str:
    """Horner's rule."""
    first, *rest = coefficients
    inner = _nested(rest, x) if len(rest) > 1 else "".join(map(repr, rest))
    return f"({first!r} + {x} * {inner})" if rest else f"lanes_of({first!r})"


def split(coefficients: Sequence[float], x: str, prefix: str = "") -> tuple[str, ...]:
    """``even`` and ``odd`` so that the polynomial at x is even + x odd: two chains that run side by side."""
    lines: list[str] = []
    for name, part in (("even", coefficients[::2]), ("odd", coefficients[1::2])):
        text = f"const lanes {prefix}{name} = {_nested(part, x + x).removeprefix('(').removesuffix(')')}"
        closing = ")" * (text.count("(") - text.count(")"))
        lines += wrap(f"{text}{closing};", WIDTH, subsequent_indent="    ", break_long_words=False)
    return tuple(lines)


def _polynomials(precision: Precision) -> Mapping[str, tuple[str, ...]]:
    """The statements by function."""

    def table(name: str) -> tuple[float, ...]:
        return getattr(elementary, f"{name}{precision.suffix.upper()}")

    return {
        "atan": split(table("ATAN"), "z"),
        "sincos": (*split(table("SIN"), "z", "sin_"), *split(table("COS"), "z", "cos_")),
        "exp": split(table("EXP"), "u"),
        "log": split(table("LOG"), "z"),
    }


def _shuffle(lanes: int) -> Shuffle:
    row, both = min(ROW, lanes), range(2)

    def picks(*starts: int, run: int) -> str:
        """Runs of the first vector, each followed by the same of the second."""
        return ", ".join(
            str(i + s * lanes) for start in starts for s in both for i in range(start, start + run)
        )

    steps = {"EVEN": picks(*range(0, lanes, 2), run=1), "ODD": picks(*range(1, lanes, 2), run=1)}
    if row == ROW:
        steps |= {"LOW": picks(*range(0, lanes, 4), run=2), "HIGH": picks(*range(2, lanes, 4), run=2)}
    rows = [f"LANES_SHUFFLE(v, v, {_numbers(k, k + row)})" for k in range(0, lanes, row)]
    puts = [f"put({i}, {text})" for i, text in enumerate(rows if lanes > row else ["v"])]
    return Shuffle(
        lanes, row, steps, _joined([f"(r)[{k}]" for k in range(lanes // row)], row), " ".join(puts)
    )


def _joined(parts: Sequence[str], width: int) -> str:
    if len(parts) == 1:
        return parts[0]
    pairs = zip(parts[::2], parts[1::2], strict=True)
    return _joined([f"LANES_SHUFFLE({a}, {b}, {_numbers(0, 2 * width)})" for a, b in pairs], 2 * width)


def _numbers(start: int, end: int) -> str:
    return ", ".join(map(str, range(start, end)))


SHUFFLES = tuple(map(_shuffle, (2, 4, 8, 16)))
DOUBLES = Lanes(
    precision=DOUBLE, type=np.float64, integer="long long", literal="LL", widths=(8, 4, 2), x86="pd",
    register="d", bias=1023, far=1.5e6, large=1e300, shrink=2.0**-100, top=710.0, bottom=-750.0, lift=54,
    half_pi=elementary.HALF_PI, log_2=elementary.LOG_2, polynomials=_polynomials(DOUBLE),
    shuffles=SHUFFLES,
)  # fmt: skip
SINGLES = Lanes(
    precision=SINGLE, type=np.float32, integer="int", literal="", widths=(16, 8, 4), x86="ps",
    register="", bias=127, far=1.5e3, large=1e37, shrink=2.0**-30, top=89.0, bottom=-105.0, lift=25,
    half_pi=elementary.HALF_PI_F32, log_2=elementary.LOG_2_F32, polynomials=_polynomials(SINGLE),
    shuffles=SHUFFLES,
)  # fmt: skip
