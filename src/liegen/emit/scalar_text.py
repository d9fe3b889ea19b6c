"""The polynomials of the functions of angles of single calls as statements in C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap

from liegen.coefficients import elementary

from .lanes_text import WIDTH


def by_fours(coefficients: Sequence[float], x: str, name: str) -> tuple[str, ...]:
    """``p0``, ``p1``, ... of up to four powers of x each: short chains of sums, for a single argument."""
    lines: list[str] = []
    for k in range(0, len(coefficients), 4):
        pairs = [f"{a!r} + {x} * {b!r}" for a, b in zip(*[iter(coefficients[k : k + 4])] * 2, strict=True)]
        text = pairs[0] if len(pairs) == 1 else f"({pairs[0]}) + {x}{x} * ({pairs[1]})"
        line = f"const double {name}{k // 4} = {text};"
        lines += wrap(line, WIDTH, subsequent_indent="    ", break_long_words=False)
    return tuple(lines)


def scalar_text() -> Mapping[str, tuple[str, ...]]:
    """The statements of the functions of one argument: even numbers of coefficients of z = x^2."""
    return {
        "atan": by_fours(elementary.ATAN, "z", "p"),
        "sine": by_fours(elementary.SIN, "z", "s"),
        "cosine": by_fours(elementary.COS, "z", "c"),
    }
