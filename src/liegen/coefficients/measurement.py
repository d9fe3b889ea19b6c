"""Errors of the coefficient functions against their closed forms in mpmath, beside the textbook formulas."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liegen.algebra import Scalar, call, cos, sin, sqrt

from . import closed_forms, inverse_jacobian, log_factor, stumpff, tables

mp: Any = importlib.import_module("mpmath").mp  # ships no type information

Array = NDArray[np.float64]
DIGITS = 40
#: The unit of "scaled" errors, the spacing of doubles at 1.
EPSILON = 2.0**-52
#: Zero, denormals, angles whose square underflows or is denormal, and one at which nothing changes any more.
TINY_ANGLES = (0.0, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-200, 1e-162, 1e-160, 1e-155, 1e-154, 1e-100, 1e-20)


@dataclass(frozen=True)
class Argument:
    """Which double counts as exact: ``of_angle`` makes it, ``given`` is what the function gets for it."""

    name: str
    of_angle: Callable[[Array], Array]
    given: Callable[[Scalar], Scalar]


@dataclass(frozen=True)
class Family:
    """Functions that come together: every way to call them, their closed forms, their textbook formulas.

    ``calls`` and ``closed`` take the function's argument; ``textbook`` takes theta, or w for the logarithm.
    """

    names: tuple[str, ...]
    calls: tuple[Callable[[Array], tuple[Array, ...]], ...]
    closed: Callable[[Any], tuple[Any, ...]]
    textbook: Callable[[Scalar], tuple[Scalar, ...]]


@dataclass(frozen=True)
class Errors:
    """One function at angles ``theta`` [rad]: absolute errors, and what they are held against.

    ``ours`` is the largest over all calls, ``rounded`` that of the double nearest to the exact value;
    ``conditioning`` is what half a unit in the last place of theta makes of c_k, and 0 for D, E, log factor.
    """

    name: str
    theta: Array
    exact: Array
    ours: Array
    textbook: Array
    rounded: Array
    conditioning: Array

    @property
    def unit(self) -> Array:
        """One unit in the last place (ulp) of the exact value."""
        return np.spacing(np.abs(self.exact))

    @property
    def power(self) -> int:
        """k of c_k."""
        return int(self.name[1:])


def _square(x: Scalar) -> Scalar:
    return x * x


def _itself(x: Scalar) -> Scalar:
    return x


#: The angle is exact, its square is rounded; then sqrt(theta * theta) is theta again, whatever the rounding.
THETA = Argument("theta", _itself, _square)
#: The square is exact, its root is rounded.
SQUARE = Argument("s", _square, _itself)
W = Argument("w", lambda theta: np.cos(0.5 * theta), _itself)


def textbook_stumpff(t: Scalar) -> tuple[Scalar, ...]:
    """c_0 to c_5 as they are usually written; NaN at 0."""
    return (
        cos(t),
        sin(t) / t,
        (1.0 - cos(t)) / t**2,
        (t - sin(t)) / t**3,
        (0.5 * t**2 - 1.0 + cos(t)) / t**4,
        (t**3 / 6 - t + sin(t)) / t**5,
    )


def textbook_inverse(t: Scalar) -> tuple[Scalar, ...]:
    """D = 1/t^2 - (1 + cos t)/(2 t sin t) (Sola, Deray, Atchuthan 2018, equation 144), and E = (dD/dt)/t."""
    slope = (1.0 + cos(t)) / (2.0 * t**3 * sin(t))
    return 1.0 / t**2 - slope * t**2, slope + 1.0 / (2.0 * t**2 * (1.0 - cos(t))) - 2.0 / t**4


def textbook_log(w: Scalar) -> tuple[Scalar, ...]:
    """2 acos(w)/sqrt(1 - w^2); NaN at 1."""
    return (2.0 * call("acos", w) / sqrt(1.0 - w * w),)


STUMPFF = Family(
    ("c0", "c1", "c2", "c3", "c4", "c5"),
    (lambda s: stumpff(s, 1), lambda s: stumpff(s, 3), lambda s: stumpff(s, 5)),
    lambda s: closed_forms.stumpff(s, 5),
    textbook_stumpff,
)
INVERSE = Family(
    ("D", "E"),
    (lambda s: inverse_jacobian(s), lambda s: inverse_jacobian(s, principal=False)),
    closed_forms.inverse_jacobian,
    textbook_inverse,
)
LOG = Family(
    ("log factor",),
    (lambda w: (log_factor(w),),),
    lambda w: (closed_forms.log_factor(w),),
    textbook_log,
)


def spread(low: float, high: float, count: int) -> Array:
    """``count`` points of (low, high), evenly spread, in no order: multiples of the golden ratio modulo 1."""
    return low + (high - low) * np.modf(np.arange(1, count + 1) * ((np.sqrt(5.0) - 1.0) / 2.0))[0]


def neighbours(points: Sequence[float]) -> Array:
    """Each point and the doubles beside it."""
    p = np.array(points)
    return np.concatenate([p, np.nextafter(p, -np.inf), np.nextafter(p, np.inf)])


def angles_from_zero(high: float, count: int) -> Array:
    """Angles of [0, high], spread evenly and in the logarithm; tiny ones; neighbours of switches, zeros."""
    switches = np.sqrt([2.0**-60, 2.0**-58, tables.STUMPFF3_END, tables.STUMPFF5_END, tables.INVERSE_END])
    corners = neighbours([*switches.tolist(), *(i * np.pi / 2 for i in range(1, 5))])
    log = 10.0 ** spread(-17.0, 0.0, count // 4)
    theta = np.concatenate([TINY_ANGLES, corners, log, spread(0.0, high, count - len(log))])
    return theta[theta <= high]


def angles_beyond(low: float, high: float, count: int) -> Array:
    """Angles of [low, high], half of them evenly spread in the logarithm."""
    log = 10.0 ** spread(float(np.log10(low)), float(np.log10(high)), count // 2)
    return np.concatenate([log, spread(low, min(high, max(60.0, 2.0 * low)), count - len(log))])


def _distance(values: Array, exact: Sequence[Any]) -> Array:
    """|value - exact|, computed in mpmath."""
    return np.array([float(abs(mp.mpf(float(v)) - x)) for v, x in zip(values, exact, strict=True)])


def _conditioning(k: int, theta: Array, exact: Sequence[Sequence[Any]]) -> Array:
    """What half a unit in the last place of theta makes of c_k.

    The slope, theta dc_k/dtheta = c_{k-1} - k c_k, and the curvature of c_2 at its double zeros, 1/theta^2.
    """
    half, least = np.spacing(theta) / 2, np.maximum(theta, 5e-324)
    lower = (
        [-(mp.mpf(float(t)) ** 2) * c for t, c in zip(theta, exact[1], strict=True)]
        if k == 0
        else exact[k - 1]
    )
    slope = np.array([float(a - k * c) for a, c in zip(lower, exact[k], strict=True)])
    curvature = 0.5 / np.maximum(theta, 1.0) ** 2 if k == 2 else 0.0
    return np.abs(slope) * (half / least) + curvature * half**2


def measure(family: Family, argument: Argument, theta: Array) -> tuple[Errors, ...]:
    """The family's errors at the angles theta, one record per function."""
    points = argument.of_angle(theta)
    given = argument.given(points)
    with np.errstate(all="ignore"):
        called = [function(given) for function in family.calls]
        written = family.textbook(points if argument is W else theta)
    with mp.workdps(DIGITS):
        rows = [family.closed(argument.given(mp.mpf(float(p)))) for p in points]
        exact = list(zip(*rows, strict=True))
        rounded = [np.array([float(x) for x in column]) for column in exact]
        return tuple(
            Errors(
                name,
                theta,
                rounded[i],
                np.max([_distance(values[i], exact[i]) for values in called if i < len(values)], axis=0),
                _distance(written[i], exact[i]),
                _distance(rounded[i], exact[i]),
                _conditioning(i, theta, exact) if family is STUMPFF else np.zeros_like(theta),
            )
            for i, name in enumerate(family.names)
        )


def in_ulp(e: Errors) -> Array:
    """Error in units in the last place, beyond the conditioning."""
    return np.maximum(e.ours - e.conditioning, 0.0) / e.unit


def scaled(e: Errors, error: Array) -> Array:
    """An absolute error of c_k times theta^k, in units of 2^-52."""
    return error * e.theta**e.power / EPSILON
