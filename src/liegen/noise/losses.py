"""Robust losses: one entry per loss, adding a loss adds one entry.

A loss is a function rho of s = |S r|^2 with slope 1 at 0; the cost is 1/2 rho(s). Every loss has a scale k
(``k`` or ``c``, in units of standard deviations) and is stated here on x = s / k^2, free of it:
rho(s) = k^2 R(x). Its derivatives are given by what the weights need, each a closed form without
cancellation: the root of the slope, root(x) = sqrt(rho'), and bend(x) = -2 k^2 rho'' / rho'.

Sources: Huber (1964); Charbonnier et al. (1997) for pseudo-Huber; Black and Rangarajan, "On the unification
of line processes, outlier rejection, and robust statistics" (1996); Zhang, "Parameter estimation techniques"
(1997), Table 1; Barron, "A General and Adaptive Robust Loss Function" (2019), eq. 8 and 13, times 2 c^2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from liegen.algebra import Scalar, call, lt, select, sqrt

from .scalars import expm1_ratio, log1p, log1p_over, safe

#: A function of x = s / k^2 and of the loss's shape parameters.
Normalised = Callable[[Scalar], Scalar] | Callable[[Scalar, Scalar], Scalar]


@dataclass(frozen=True)
class Loss:
    """A loss by its closed forms on x = s / scale^2; ``scale`` and ``shape`` name its parameters."""

    name: str
    scale: str
    R: Normalised
    root: Normalised
    bend: Normalised
    formula: str
    #: What happens where |S r| is the scale.
    there: str
    shape: tuple[str, ...] = ()
    #: Values of the shape parameters that verification takes in turn.
    shapes: tuple[tuple[float, ...], ...] = ((),)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, the scale last."""
        return (*self.shape, self.scale)

    def meaning(self, parameter: str) -> str:
        """What a parameter means."""
        if parameter == self.scale:
            return f"scale of the loss, a length of the whitened residual: {self.there}"
        return (
            "shape of the loss, any real number or -inf: 2 is least squares, 1 pseudo-Huber, 0 Cauchy, "
            "-2 Geman-McClure, -inf Welsch, up to their scales"
        )

    def normalised(self, s: Scalar, parameters: Sequence[Scalar]) -> tuple[Scalar, Sequence[Scalar]]:
        """x and the shape parameters, of s and the parameters in order."""
        *shape, k = parameters
        return s / k / k, shape

    def weights(self, s: Scalar, parameters: Sequence[Scalar]) -> tuple[Scalar, Scalar, Scalar]:
        """x, root and bend at s."""
        x, shape = self.normalised(s, parameters)
        return x, _at(self.root, x, shape), _at(self.bend, x, shape)

    def rho(self, s: Scalar, *parameters: Scalar) -> Scalar:
        """rho(s); twice the cost."""
        x, shape = self.normalised(s, parameters)
        return _at(self.R, x, shape) * parameters[-1] * parameters[-1]

    def slope(self, s: Scalar, *parameters: Scalar) -> Scalar:
        """rho'(s), the weight of iteratively reweighted least squares."""
        x, shape = self.normalised(s, parameters)
        root = _at(self.root, x, shape)
        return root * root

    def curvature(self, s: Scalar, *parameters: Scalar) -> Scalar:
        """rho''(s); beside a kink that of the side towards 0."""
        x, shape = self.normalised(s, parameters)
        k = parameters[-1]
        return -0.5 * self.slope(s, *parameters) * _at(self.bend, x, shape) / k / k


def _at(form: Any, x: Scalar, shape: Sequence[Scalar]) -> Scalar:
    return form(x, *shape)


def _outside(x: Scalar) -> tuple[Scalar, Scalar]:
    """Whether x > 1, and x or 1."""
    outside = lt(1.0, x)
    return outside, safe(outside, x, 1.0)


def _huber(x: Scalar) -> Scalar:
    outside, y = _outside(x)
    return select(outside, 2.0 * sqrt(y) - 1.0, x)


def _huber_root(x: Scalar) -> Scalar:
    return 1.0 / sqrt(sqrt(_outside(x)[1]))


def _huber_bend(x: Scalar) -> Scalar:
    outside, y = _outside(x)
    return select(outside, 1.0 / y, 0.0)


def _inside(x: Scalar) -> tuple[Scalar, Scalar]:
    """Whether x < 1, and 1 - x or 1."""
    inside = lt(x, 1.0)
    return inside, select(inside, 1.0 - x, 1.0)


def _tukey(x: Scalar) -> Scalar:
    inside, _ = _inside(x)
    y = select(inside, x, 1.0)
    return y * (1.0 - y + y * y / 3.0)


def _tukey_root(x: Scalar) -> Scalar:
    inside, y = _inside(x)
    return select(inside, y, 0.0)


def _tukey_bend(x: Scalar) -> Scalar:
    inside, y = _inside(x)
    return select(inside, 4.0 / y, 0.0)


def _exp(factor: float, x: Scalar) -> Scalar:
    return call("exp", factor * x)


def _distance(alpha: Scalar) -> tuple[Scalar, Scalar]:
    """Whether alpha > 2, and |alpha - 2|."""
    convex = lt(2.0, alpha)
    return convex, select(convex, alpha - 2.0, 2.0 - alpha)


def _barron(x: Scalar, alpha: Scalar) -> Scalar:
    """With v = alpha/2 log(1 + x/b): 2 b/alpha (e^v - 1) = b log(1 + x/b) (e^v - 1)/v."""
    convex, b = _distance(alpha)
    h = log1p_over(x, b)
    quadratic = lt(0.0, b)
    v = h / safe(quadratic, b, 1.0) + 0.5 * select(convex, h, -h)
    return select(quadratic, h * expm1_ratio(v), x)


def _barron_root(x: Scalar, alpha: Scalar) -> Scalar:
    convex, b = _distance(alpha)
    h = log1p_over(x, b)
    return call("exp", 0.25 * select(convex, h, -h))


def _barron_bend(x: Scalar, alpha: Scalar) -> Scalar:
    convex, b = _distance(alpha)
    quadratic = lt(0.0, b)
    bend = 1.0 / (1.0 + x / safe(quadratic, b, 1.0))
    return select(quadratic, select(convex, -bend, bend), 0.0)


_INF = float("inf")

LOSSES: Mapping[str, Loss] = {
    loss.name: loss
    for loss in (
        Loss(
            "huber",
            "k",
            _huber,
            _huber_root,
            _huber_bend,
            "s if s <= k^2 else 2 k sqrt(s) - k^2",
            "beyond it the cost grows linearly",
        ),
        Loss(
            "pseudo-huber",
            "k",
            lambda x: 2.0 * x / (sqrt(1.0 + x) + 1.0),
            lambda x: 1.0 / sqrt(sqrt(1.0 + x)),
            lambda x: 1.0 / (1.0 + x),
            "2 k^2 (sqrt(1 + s/k^2) - 1)",
            "at it the weight rho' is 1/sqrt(2), far beyond the cost grows linearly",
        ),
        Loss(
            "cauchy",
            "c",
            log1p,
            lambda x: 1.0 / sqrt(1.0 + x),
            lambda x: 2.0 / (1.0 + x),
            "c^2 log(1 + s/c^2)",
            "at it the weight rho' is 1/2",
        ),
        Loss(
            "tukey",
            "c",
            _tukey,
            _tukey_root,
            _tukey_bend,
            "c^2/3 (1 - (1 - s/c^2)^3) if s < c^2 else c^2/3",
            "beyond it the weight rho' is 0",
        ),
        Loss(
            "geman-mcclure",
            "c",
            lambda x: x / (1.0 + x),
            lambda x: 1.0 / (1.0 + x),
            lambda x: 4.0 / (1.0 + x),
            "c^2 s / (c^2 + s)",
            "at it the weight rho' is 1/4",
        ),
        Loss(
            "welsch",
            "c",
            lambda x: x * expm1_ratio(-x),
            partial(_exp, -0.5),
            lambda x: 2.0 + 0 * x,
            "c^2 (1 - exp(-s/c^2))",
            "at it the weight rho' is 1/e",
        ),
        Loss(
            "barron",
            "c",
            _barron,
            _barron_root,
            _barron_bend,
            "2 c^2 b/alpha ((1 + s/(b c^2))^(alpha/2) - 1), b = |alpha - 2|; its limits at 2, 0, -inf",
            "at it the weight rho' is (1 + 1/b)^(alpha/2 - 1)",
            ("alpha",),
            ((1.0,), (-2.0,), (0.0,), (2.0,), (-_INF,), (1.5,), (2.0 - 1e-9,), (1e-9,), (-30.0,), (3.0,)),
        ),
    )
}


def known(what: str, name: Any, table: Mapping[str, Any]) -> str:
    """What to say of a name that the table lacks; empty where it has it."""
    return (
        ""
        if isinstance(name, str) and name in table
        else f"unknown {what} {name!r}; choose from {', '.join(table)}"
    )
