"""Names and numbers in LaTeX: ``T_WB`` with the subscript WB, ``res`` as r, ``rho`` as the Greek letter."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from liegen.text import in_latex

_GREEK = re.compile(
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|"
    "phi|chi|psi|omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega"
)
#: Frames such as WB, WBi or T1: capitals, each with at most one small letter, and digits.
_FRAMES = re.compile(r"([A-Z][a-z]?\d*)+|\d+")


def spelled(names: Iterable[str]) -> dict[str, str]:
    """Each name in LaTeX; names that would look alike stand upright, letter by letter."""
    made: dict[str, str] = {}
    for name in names:
        short = "r" if name == "res" else latex_name(name)
        made[name] = upright(name) if short in made.values() else short
    return made


def latex_name(name: str) -> str:
    r"""``x1`` is ``x_{1}``, ``T_WB`` is ``T_{WB}``, ``gyro_bias`` is ``\mathrm{gyro}_{\mathrm{bias}}``."""
    stem, *rest = [token for token in name.split("_") if token] or [""]
    base = stem.rstrip("0123456789")
    if not base:
        return upright(name)
    subscripts = [_token(token) for token in _digits(stem[len(base) :], rest)]
    subscript = r"\,".join(subscripts)
    return _symbol(base) + (f"_{{{subscript}}}" if subscript else "")


def upright(name: str) -> str:
    r"""``\mathrm{rear\_left}``."""
    return rf"\mathrm{{{in_latex(name)}}}"


def worded(name: str) -> str:
    r"""``\mathrm{extended\ pose}``: the words of an operation's name."""
    words = r"\ ".join(in_latex(word) for word in name.split("_") if word)
    return rf"\mathrm{{{words}}}"


def latex_number(value: float) -> str:
    r"""Six digits; ``2.5e-07`` is ``2.5 \cdot 10^{-7}``."""
    digits, _, exponent = f"{value:.6g}".partition("e")
    if exponent:
        return rf"{digits} \cdot 10^{{{int(exponent)}}}"
    return digits.replace("inf", r"\infty").replace("nan", r"\mathrm{nan}")


def _digits(digits: str, rest: list[str]) -> Iterator[str]:
    if digits:
        yield digits
    yield from rest


def _symbol(word: str) -> str:
    if _GREEK.fullmatch(word):
        return rf"\{word}"
    return word if len(word) == 1 else upright(word)


def _token(token: str) -> str:
    return token if _FRAMES.fullmatch(token) else _symbol(token)
