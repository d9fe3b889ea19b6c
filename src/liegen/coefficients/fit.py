"""Derive the tables of :mod:`liegen.coefficients.tables` from the closed forms.

``python -m liegen.coefficients.fit`` rewrites ``tables.py``.

Every function is approximated as ``f(x) = f0 + g(x) P(x)``: f0 is its value at the removable singularity,
and g is x (or 1 - w) over a power of a polynomial Q. So the result is f0 to the last digit near the
singularity, and elsewhere the rounding errors of P and Q count only by the small part that g P has in f.

P is the minimax polynomial for the *relative* error of f, by the exchange algorithm of Remez on a grid of
Chebyshev points, its coefficients rounded one after the other with the rest fitted again. Q comes from the
rational function that interpolates at Chebyshev points; P is fitted to the rounded Q.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import closed_forms as forms
from .closed_forms import ClosedForm

mp: Any = importlib.import_module("mpmath").mp  # ships no type information

BITS = 200
GRID = 400
#: Below this part of its largest value g is too small for P to matter, the rounding of f0 stays what it is.
NEGLIGIBLE = 2.0**-6

#: How close to its bound the exchange must come.
SETTLED = 1e-6

#: Ends of the ranges [0, end] in s. Above STUMPFF3 and STUMPFF5 the closed forms are accurate.
STUMPFF3 = 3.0
STUMPFF5 = 10.0
INVERSE = 10.0  # pi^2 and a little, for angles that rounding carries beyond pi
SIMILARITY = 2.75  # of |lambda|: the range is [-end, end]
HYPERBOLIC = 20.0  # of lambda^2
ENDS = {
    "STUMPFF3_END": STUMPFF3,
    "STUMPFF5_END": STUMPFF5,
    "INVERSE_END": INVERSE,
    "SIMILARITY_END": SIMILARITY,
    "HYPERBOLIC_END": HYPERBOLIC,
}


@dataclass(frozen=True)
class Sample:
    """A grid point with its target for P and the weight of P's error in the relative error of f."""

    x: Any
    target: Any
    weight: Any


def _number(rational: Any) -> Any:
    return mp.mpf(rational.p) / rational.q


def horner(coefficients: Sequence[Any], x: Any) -> Any:
    """The polynomial with these coefficients, lowest power first, at ``x``."""
    total = mp.mpf(0)
    for a in reversed(coefficients):
        total = total * x + a
    return total


def chebyshev(end: float, count: int, start: float = 0.0) -> list[Any]:
    """Chebyshev points of [start, end], ascending."""
    half = (mp.mpf(end) - start) / 2
    return [start + half * (1 - mp.cos(mp.pi * (2 * i + 1) / (2 * count))) for i in range(count)]


def denominator(form: ClosedForm, end: float, top: int, bottom: int) -> tuple[float, ...]:
    """Q of degree ``bottom``, lowest power first, its leading coefficient 1 left out.

    P/Q of these degrees interpolates (f - f0)/|x - point| so that f0 + |x - point| P/Q agrees with f at
    Chebyshev points of the range, stretched until one of them is ``point``.
    """
    *nodes, widest = chebyshev(2, top + bottom + 2)
    points = [abs(form.point - end * (1 - x / widest)) for x in nodes]
    start = _number(forms.limit(form))
    values = [(forms.evaluate((form,), x)[0] - start) / abs(x - form.point) for x in points]
    samples = list(zip(points, values, strict=True))
    rows = [[x**j for j in range(top + 1)] + [-y * x**j for j in range(bottom)] for x, y in samples]
    solution = mp.lu_solve(mp.matrix(rows), mp.matrix([y * x**bottom for x, y in samples]))
    return tuple(float(solution[top + 1 + j]) for j in range(bottom))


def _extrema(errors: list[Any], count: int) -> list[int]:
    """Grid indices of ``count`` adjacent local extrema of alternating sign, the largest there are."""
    chosen: list[int] = []
    for i, e in enumerate(errors):
        if chosen and (errors[chosen[-1]] > 0) == (e > 0):
            chosen[-1] = i if abs(e) > abs(errors[chosen[-1]]) else chosen[-1]
        else:
            chosen.append(i)
    while len(chosen) > count:
        size = [abs(errors[i]) for i in chosen]
        k = size.index(min(size))
        if k in (0, len(chosen) - 1):
            chosen.pop(k)
        elif len(chosen) == count + 1:
            chosen.pop(0 if size[0] < size[-1] else -1)
        else:  # a pair, so that the signs still alternate
            first = k if size[k + 1] < size[k - 1] else k - 1
            del chosen[first : first + 2]
    return chosen


def minimax(samples: Sequence[Sample], degree: int) -> tuple[list[Any], Any]:
    """(P, e): the polynomial with the least largest ``e = |weight (P - target)|`` (Remez, on the grid)."""
    n = degree + 2
    last = len(samples) - 1
    reference = [round(float(last / 2 * (1 - mp.cos(mp.pi * i / (n - 1))))) for i in range(n)]
    for _ in range(60):
        chosen = [samples[i] for i in reference]
        rows = [[p.x**j for j in range(n - 1)] + [(-1) ** i / p.weight] for i, p in enumerate(chosen)]
        *coefficients, level = mp.lu_solve(mp.matrix(rows), mp.matrix([p.target for p in chosen]))
        errors = [p.weight * (horner(coefficients, p.x) - p.target) for p in samples]
        if max(abs(e) for e in errors) <= abs(level) * (1 + SETTLED):
            return coefficients, abs(level)
        reference = _extrema(errors, n)
    raise ArithmeticError(f"the exchange of degree {degree} does not settle")


def rounded_minimax(samples: Sequence[Sample], degree: int) -> tuple[float, ...]:
    """``minimax`` in double precision: after each coefficient is rounded, the rest are fitted again."""
    rest, done = list(samples), list[float]()
    for left in range(degree, -1, -1):
        a = float(minimax(rest, left)[0][0])
        done.append(a)
        rest = [Sample(p.x, (p.target - a) / p.x, p.weight * abs(p.x)) for p in rest]
    return tuple(done)


def correction(
    form: ClosedForm,
    end: float,
    degree: int,
    q: Callable[[Any], Any] = lambda _: mp.mpf(1),
    low: float = 0.0,
) -> tuple[float, ...]:
    """P of ``degree`` in f = f0 + g P, g = x/q(x) (or (1 - w)/q(w)), on [low, end]; f0, rounded, first."""
    start, side = float(forms.limit(form)), -1 if form.point else 1
    samples: list[Sample] = []
    for x in chebyshev(end, GRID, low):
        f, g = forms.evaluate((form,), x)[0], side * (x - form.point) / q(x)
        samples.append(Sample(x, (f - start) / g, abs(g) / f))
    largest = max(abs(p.weight) for p in samples)
    return start, *rounded_minimax([p for p in samples if abs(p.weight) > NEGLIGIBLE * largest], degree)


def tables() -> dict[str, tuple[float, ...]]:
    """The coefficients in ``tables.py`` by their names, lowest power first."""
    with mp.workprec(BITS):
        c3, c4, c5, c6 = map(forms.stumpff_form, (3, 4, 5, 6))
        d, e, log = forms.inverse_form(), forms.inverse_derivative_form(), forms.log_form()
        log_q = denominator(log, 1.0, 5, 6)
        inverse_q = denominator(d, INVERSE, 3, 3)
        return {
            "C3_3": correction(c3, STUMPFF3, 6),
            "C4_5": correction(c4, STUMPFF5, 7),
            "C5_5": correction(c5, STUMPFF5, 7),
            "C6_5": correction(c6, STUMPFF5, 7),
            "C5_H": correction(c5, 0.0, 10, low=-HYPERBOLIC),
            "C6_H": correction(c6, 0.0, 10, low=-HYPERBOLIC),
            "P5": correction(forms.remainder_form(5), SIMILARITY, 16, low=-SIMILARITY),
            "INVERSE_Q": (*inverse_q, 1.0),
            "INVERSE_D": correction(d, INVERSE, 3, lambda x: horner((*inverse_q, 1), x)),
            "INVERSE_E": correction(e, INVERSE, 6, lambda x: horner((*inverse_q, 1), x) ** 2),
            "LOG_Q": (*log_q, 1.0),
            "LOG_P": correction(log, 1.0, 5, lambda x: horner((*log_q, 1), x)),
        }


HEADER = '''"""Constants of the coefficient functions, generated by ``python -m liegen.coefficients.fit``."""

'''


def render() -> str:
    """The text of ``tables.py``."""
    lines = [HEADER, *(f"{name} = {end!r}\n" for name, end in ENDS.items())]
    for name, value in tables().items():
        lines.append(f"{name} = (\n" + "".join(f"    {a!r},\n" for a in value) + ")\n")
    return "".join(lines)


def main() -> None:
    """Write ``tables.py`` beside this file."""
    Path(__file__).with_name("tables.py").write_text(render(), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
