"""Whitened residuals, robust losses and their cost, from textbook formulas of rho.

Slopes and curvatures of rho are central differences of it; nothing of ``liegen.noise`` is used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .calls import Call, Rule
from .matrix import Matrix, Number, Vector, dot, matvec, mp, scale, sub, transpose

#: 1 - alpha of Triggs' correction is not allowed below this.
GAP = 64


def _barron(s: Number, alpha: Number, c: Number) -> Number:
    """Barron (2019), eq. 13, times 2 c^2."""
    x = s / c**2
    if alpha == 2:
        return s
    if alpha == 0:
        return 2 * c**2 * mp.log(x / 2 + 1)
    if alpha == -mp.inf:
        return 2 * c**2 * (1 - mp.exp(-x / 2))
    b = abs(alpha - 2)
    return 2 * c**2 * b / alpha * ((x / b + 1) ** (alpha / 2) - 1)


_Rho = Callable[[Number, Number], Number] | Callable[[Number, Number, Number], Number]
#: rho(s, parameters in order).
RHO: Mapping[str, _Rho] = {
    "huber": lambda s, k: s if s <= k**2 else 2 * k * mp.sqrt(s) - k**2,
    "pseudo-huber": lambda s, k: 2 * k**2 * (mp.sqrt(1 + s / k**2) - 1),
    "cauchy": lambda s, c: c**2 * mp.log(1 + s / c**2),
    "tukey": lambda s, c: (1 - (1 - s / c**2) ** 3) * c**2 / 3 if s < c**2 else c**2 / 3,
    "geman-mcclure": lambda s, c: s * c**2 / (c**2 + s),
    "welsch": lambda s, c: c**2 * (1 - mp.exp(-s / c**2)),
    "barron": _barron,
}


def _white(noise: str, r: Vector, stored: Vector) -> Vector:
    """S r; below the diagonal the numbers do not count."""
    if noise == "packed":
        rest = list(stored)
        return tuple(sum((rest.pop(0) * x for x in r[i:]), mp.zero) for i in range(len(r)))
    if noise == "full":
        m = len(r)
        upper = tuple(tuple(stored[i * m + j] if j >= i else mp.zero for j in range(m)) for i in range(m))
        return matvec(upper, r)
    scales = stored if noise == "diagonal" else stored * len(r)
    return tuple(k * x for k, x in zip(scales, r, strict=True))


def _parts(call: Call) -> tuple[Vector, Callable[[Number], Number] | None, Number]:
    """u = S r, rho as a function of s, and the square of the loss's scale."""
    noise, loss, _ = call.operation.parameters
    r, *rest = call.values
    u = _white(noise, r, rest.pop(0)) if noise else r
    numbers = [x for (x,) in rest]
    if not loss:
        return u, None, mp.one
    rho: Any = RHO[loss]
    return u, lambda s: rho(s, *numbers), numbers[-1] ** 2


def _cost(call: Call) -> Vector:
    u, rho, _ = _parts(call)
    s = dot(u, u)
    return ((rho(s) if rho else s) / 2,)


@dataclass(frozen=True)
class _Scaling:
    """sqrt(rho'), and 1 - alpha of Triggs' correction: 1 where the mode has none."""

    root: Number
    gap: Number


def _scaling(rho: Callable[[Number], Number] | None, s: Number, size: Number, mode: str) -> _Scaling:
    if rho is None:
        return _Scaling(mp.one, mp.one)
    h = (s + size) * mp.mpf(10) ** -25
    forth, here, back = rho(s + h), rho(s), rho(s - h)
    slope, curvature = (forth - back) / (2 * h), (forth - 2 * here + back) / h**2
    # flat to all digits
    root = mp.sqrt(slope) if slope > mp.mpf(10) ** -40 else mp.zero
    if mode == "irls" or not root:
        return _Scaling(root, mp.one)
    definite = mp.mpf(1) + 2 * s * curvature / slope
    return _Scaling(root, max(mp.sqrt(max(definite, mp.zero)), mp.one / GAP))


def _weighted(call: Call) -> Vector:
    u, rho, size = _parts(call)
    scaling = _scaling(rho, dot(u, u), size, call.operation.parameters[2])
    return scale(scaling.root / scaling.gap, u)


def weighted_rows(call: Call, rows: Sequence[Vector]) -> Matrix:
    """The Jacobian of a weighted residual by definition, from that of the residual itself.

    sqrt(rho') S J, and with Triggs' correction sqrt(rho') (I - alpha u u^T / s) S J (Triggs et al. 1999,
    eq. 11); no derivative of the weighted residual.
    """
    u, rho, size = _parts(call)
    s = dot(u, u)
    scaling = _scaling(rho, s, size, call.operation.parameters[2])
    noise, stored = call.operation.parameters[0], call.values[1] if len(call.values) > 1 else ()
    k = (1 - scaling.gap) / s if s else mp.zero
    columns: list[Vector] = []
    for column in transpose(tuple(map(tuple, rows))):
        white = _white(noise, column, stored) if noise else column
        columns.append(scale(scaling.root, sub(white, scale(k * dot(u, white), u))))
    return transpose(tuple(columns))


OPERATIONS: Mapping[str, Rule] = {"weighted": _weighted, "cost": _cost}
