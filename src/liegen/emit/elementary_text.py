"""The polynomials of the elementary functions as statements in C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap

from liegen.coefficients import elementary

#: Longest line.
WIDTH = 100


def _nested(coefficients: Sequence[float], x: str) -> str:
    """Horner's rule."""
    first, *rest = coefficients
    inner = _nested(rest, x) if len(rest) > 1 else "".join(map(repr, rest))
    return f"({first!r} + {x} * {inner})" if rest else repr(first)


def split(coefficients: Sequence[float], x: str, prefix: str = "") -> tuple[str, ...]:
    """``even`` and ``odd`` so that the polynomial at x is even + x odd: two chains that run side by side."""
    lines: list[str] = []
    for name, part in (("even", coefficients[::2]), ("odd", coefficients[1::2])):
        text = f"const lanes {prefix}{name} = {_nested(part, x + x).strip('()')}"
        closing = ")" * (text.count("(") - text.count(")"))
        lines += wrap(f"{text}{closing};", WIDTH, subsequent_indent="    ", break_long_words=False)
    return tuple(lines)


def elementary_text() -> Mapping[str, tuple[str, ...]]:
    """The statements by function."""
    return {
        "atan": split(elementary.ATAN, "z"),
        "sincos": (*split(elementary.SIN, "z", "sin_"), *split(elementary.COS, "z", "cos_")),
        "exp": split(elementary.EXP, "u"),
        "log": split(elementary.LOG, "z"),
    }


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
