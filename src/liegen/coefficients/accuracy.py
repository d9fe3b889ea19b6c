"""The bounds of the coefficient functions, measured.

``python -m liegen.coefficients.accuracy`` prints the tables of docs/coefficients.md, with ``--quick`` from a
tenth of the angles; it exits with 1 if a bound does not hold. The angles are the same in every run.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from . import similarity_measurement as planes
from .measurement import (
    INVERSE,
    LOG,
    SQUARE,
    STUMPFF,
    THETA,
    Argument,
    Array,
    Errors,
    W,
    angles_beyond,
    angles_from_zero,
    in_ulp,
    measure,
    scaled,
)

#: Angles in each range.
DENSE, QUICK = 20_000, 2_000
LARGEST = 1e6
CONDITIONED = "ulp + conditioning"


@dataclass(frozen=True)
class Row:
    """The worst of one function on one range, and the bound that it must keep."""

    function: str
    argument: str
    interval: str
    measure: str
    bound: float
    worst: float
    angle: float

    @property
    def holds(self) -> bool:
        """Whether the bound is kept."""
        return self.worst <= self.bound


def _row(e: Errors, argument: Argument, interval: str, what: str, bound: float, sizes: Array) -> Row:
    at = int(np.argmax(sizes))  # a NaN counts as the largest
    return Row(e.name, argument.name, interval, what, bound, float(sizes[at]), float(e.theta[at]))


def _far_row(e: Errors, argument: Argument) -> Row:
    """Beyond 2 pi: absolute errors of c_0, c_1, c_2 times theta^k; c_3, c_4, c_5 as on [0, 2 pi]."""
    interval = f"[2 pi, {LARGEST:g}]"
    if e.power > 2:
        return _row(e, argument, interval, CONDITIONED, 4.0, in_ulp(e))
    what, allowed = f"2^-52/theta^{e.power}", np.zeros_like(e.theta)
    if argument is SQUARE:
        what, allowed = what + " + conditioning", e.conditioning
    return _row(e, argument, interval, what, 4.0, scaled(e, np.maximum(e.ours - allowed, 0.0)))


def rows(count: int) -> tuple[Row, ...]:
    """Every bound, measured at about ``count`` angles per range."""
    found: list[Row] = []
    near, far = angles_from_zero(2 * np.pi, count), angles_beyond(2 * np.pi, LARGEST, count)
    for argument in (THETA, SQUARE):
        for e in measure(STUMPFF, argument, near):
            found.append(_row(e, argument, "[0, 2 pi]", CONDITIONED, 4.0, in_ulp(e)))
        for e in measure(STUMPFF, argument, far):
            found.append(_far_row(e, argument))
        inverse = measure(INVERSE, argument, angles_from_zero(np.pi, count))
        for e, bound in zip(inverse, (4.0, 8.0), strict=True):
            found.append(_row(e, argument, "[0, pi]", "ulp", bound, in_ulp(e)))
    for e in measure(LOG, W, angles_from_zero(np.pi, count)):
        found.append(_row(e, W, "[0, pi]", "ulp", 4.0, in_ulp(e)))
    return tuple(found)


@dataclass(frozen=True)
class Literal:
    """Worst |error| theta^k / 2^-52 of c_k on a range: theta exact, s exact, and of the nearest double."""

    function: str
    interval: str
    theta: float
    s: float
    rounded: float


FAR = ((2 * np.pi, 16.0, "[2 pi, 16]"), (16.0, 100.0, "[16, 100]"), (100.0, 1e3, "[100, 1000]"))


def literal(count: int) -> tuple[Literal, ...]:
    """What becomes of "absolute error times theta^k" beyond 2 pi when nothing is allowed for conditioning."""
    found: list[Literal] = []
    for low, high, name in FAR:
        theta = angles_beyond(low, high, count // 10)
        for a, b in zip(measure(STUMPFF, THETA, theta), measure(STUMPFF, SQUARE, theta), strict=True):
            worst = [float(np.max(scaled(e, size))) for e, size in ((a, a.ours), (b, b.ours), (a, a.rounded))]
            found.append(Literal(a.name, name, *worst))
    return tuple(found)


def table(header: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    """A table in Markdown, aligned."""
    widths = [max(len(row[i]) for row in (header, *body)) for i in range(len(header))]
    lines = [header, ["-" * w for w in widths], *body]
    cells = [" | ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)) for line in lines]
    return "".join(f"| {line} |\n" for line in cells)


def _row_cells(r: Row) -> tuple[str, ...]:
    return r.function, r.argument, r.interval, r.measure, f"{r.bound:g}", f"{r.worst:.2f}", f"{r.angle:.6g}"


def _literal_cells(x: Literal) -> tuple[str, ...]:
    return x.function, x.interval, f"{x.theta:.3g}", f"{x.s:.3g}", f"{x.rounded:.3g}"


def _plane_cells(x: planes.Worst) -> tuple[str, ...]:
    interval = "[0, pi]" if x.high < 4 else "[0, 2 pi]"
    place = f"{x.lam:.6g}", f"{x.theta:.6g}"
    return x.function, interval, f"{x.bound:g}", f"{x.worst:.2f}", *place, f"{x.written:.1g}"


def report(count: int) -> tuple[str, bool]:
    """(text, whether every bound holds)."""
    found = rows(count)
    header = ("function", "exact", "theta", "unit", "bound", "worst", "at theta")
    worst = table(header, [_row_cells(r) for r in found])
    header = ("function", "theta", "theta exact", "s exact", "nearest double")
    product = table(header, [_literal_cells(x) for x in literal(count)])
    two = [x for plane in planes.PLANES for x in planes.measure(plane, count // 20)]
    header = ("function", "theta", "bound", "worst", "at lambda", "at theta", "as written")
    text = (
        f"{worst}\nAbsolute error times theta^k beyond 2 pi, in units of 2^-52:\n\n{product}"
        f"\nSimilarities, in units of 2^-52 times the value at theta = 0:\n\n"
        f"{table(header, [_plane_cells(x) for x in two])}"
    )
    return text, all(r.holds for r in (*found, *two))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; 1 if a bound does not hold."""
    parser = argparse.ArgumentParser(prog="python -m liegen.coefficients.accuracy")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} angles a range, not {DENSE}")
    text, holds = report(QUICK if parser.parse_args(arguments).quick else DENSE)
    sys.stdout.write(text)
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
