"""Errors of the similarity groups' coefficients over both variables, beside the formulas as written."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from liegen.algebra import Scalar

from . import similarity_doubles as doubles
from . import similarity_forms as forms
from .measurement import DIGITS, EPSILON, TINY_ANGLES, Array, neighbours, spread
from .tables import HYPERBOLIC_END, SIMILARITY_END, STUMPFF5_END

mp: Any = importlib.import_module("mpmath").mp  # ships no type information

#: |lambda| up to here, scales from 1/150 to 150.
LARGEST = 5.0


@dataclass(frozen=True)
class Plane:
    """Functions of lambda and s that come together, with their bounds in units of the value at theta = 0."""

    names: tuple[str, ...]
    bounds: tuple[float, ...]
    called: Callable[[Scalar, Scalar], tuple[Scalar, ...]]
    forms: Callable[[], tuple[Any, ...]]
    high: float  # largest theta
    scales: tuple[int, ...]  # the function whose value at theta = 0 is the unit


PLANES = (
    Plane(
        ("A", "B", "C"), (4.0,) * 3, doubles.similarity, forms.similarity_forms, 2 * np.pi, (0, 1, 2)
    ),
    Plane(
        ("a", "b", "c"), (4.0, 10.0, 10.0), doubles.similarity_inverse, forms.similarity_inverse_forms,
        np.pi, (0, 1, 2),
    ),
    Plane(
        ("A2", "B2", "C2", "Bs", "Cs"), (10.0,) * 5, doubles.similarity_derivatives,
        forms.similarity_derivative_forms, 2 * np.pi, (0, 1, 2, 3, 4),
    ),
    Plane(
        ("D", "D0", "K", "T", "C of log", "G", "H", "F"), (8.0, 6.0, 6.0, 6.0, 8.0, 12.0, 12.0, 32.0),
        doubles.similarity_logarithm, forms.similarity_logarithm_forms, np.pi, (0, 1, 2, 3, 4, 7, 6, 7),
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Worst:
    """The worst of a function in units of 2^-52 times the value at theta = 0, ``written`` of its formula."""

    function: str
    high: float
    bound: float
    worst: float
    lam: float
    theta: float
    written: float

    @property
    def holds(self) -> bool:
        """Whether the bound is kept."""
        return self.worst <= self.bound


def grid(high: float, count: int) -> tuple[Array, Array]:
    """Pairs (lambda, theta), the same each time: spread evenly, in the logarithm, tiny, at the switches."""
    few = count // 4
    size = 10.0 ** spread(-17.0, 0.0, few)
    signs = np.where(np.arange(few) % 2, 1.0, -1.0)
    edges = neighbours([SIMILARITY_END, float(np.sqrt(HYPERBOLIC_END)), LARGEST])
    tiny = np.array(TINY_ANGLES)
    lam = np.concatenate([edges, -edges, tiny, -tiny, size * signs, spread(-LARGEST, LARGEST, count)])
    near = 10.0 ** spread(-16.5, 0.0, few)
    theta = np.concatenate([tiny, neighbours([float(np.sqrt(STUMPFF5_END))]), near, spread(0.0, high, count)])
    theta = theta[theta <= high]
    n = max(len(lam), len(theta))
    rows = np.arange(2 * n)  # every lambda twice, and every angle, in other company
    return lam[rows % len(lam)], theta[(rows * 7 + rows // n) % len(theta)]


def measure(plane: Plane, count: int) -> tuple[Worst, ...]:
    """The plane's functions at about ``2 count`` pairs."""
    lam, theta = grid(plane.high, count)
    s = theta * theta
    ours = plane.called(lam, s)
    written = forms.sp.lambdify((forms.LAMBDA, forms.S), list(plane.forms()), modules="numpy")
    with np.errstate(all="ignore"):
        naive = [np.broadcast_to(v, lam.shape) for v in written(lam, s)]
    units = np.empty((2, len(plane.names), len(lam)))
    with mp.workdps(DIGITS):
        for i, (x, y) in enumerate(zip(lam.tolist(), s.tolist(), strict=True)):
            exact = forms.evaluate(plane.forms(), mp.mpf(x), mp.mpf(y))
            limits = forms.evaluate(plane.forms(), mp.mpf(x), mp.mpf(0))
            for k, e in enumerate(exact):
                for j, values in enumerate((ours, naive)):
                    units[j, k, i] = _units(float(values[k][i]), e, limits[plane.scales[k]])
    found: list[Worst] = []
    for k, name in enumerate(plane.names):
        i = int(units[0, k].argmax())  # a NaN counts as the largest
        worst, written = float(units[0, k, i]), float(np.nanmax(units[1, k]))
        found.append(Worst(name, plane.high, plane.bounds[k], worst, float(lam[i]), float(theta[i]), written))
    return tuple(found)


def _units(value: float, exact: Any, scale: Any) -> float:
    return float(abs(mp.mpf(value) - exact) / abs(scale)) / EPSILON if np.isfinite(value) else np.nan
