"""``Weighting``: a noise model, a loss and its mode, applied to a residual and its Jacobians."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from liegen.algebra import Scalar, lt, select, sqrt
from liegen.algebra.linear import (
    Matrix,
    Vector,
    dot,
    eye,
    is_structural,
    matmul,
    matscale,
    matvec,
    scale,
    sub,
)
from liegen.errors import DefinitionError

from .losses import LOSSES, Loss, known
from .models import KEYWORD, NOISES, Noise

K = TypeVar("K")
Blocks = Mapping[K, Matrix]
#: Triggs' 1 - alpha is not allowed below this; Ceres: "we limit alpha <= 1 - eps for some small eps".
GAP = 2.0**-6
#: Length of the scale's samples, in standard deviations.
_SCALES = (0.5, 5.0)


@dataclass(frozen=True)
class Weight:
    """A keyword that a weighting adds: its array's shape, that in words, and what it means."""

    name: str
    shape: tuple[int, ...]
    kind: str
    meaning: str

    @property
    def size(self) -> int:
        """Number of stored scalars."""
        return prod(self.shape)


@dataclass(frozen=True)
class Weighed:
    """The residual, and what makes the Jacobians of those of u: root (I - ratio u u^T)."""

    root: Scalar
    residual: Vector
    ratio: Scalar


@dataclass(frozen=True)
class Mode:
    """How a loss becomes part of least squares.

    ``formula`` has the residual, the Jacobian, and what they use, as text; ``latex`` the same in LaTeX.
    """

    name: str
    formula: tuple[str, str, str]
    latex: tuple[str, str, str]
    weigh: Callable[[Loss, Sequence[Scalar], Vector], Weighed]


def _reweighted(loss: Loss, parameters: Sequence[Scalar], u: Vector) -> Weighed:
    _, root, _ = loss.weights(dot(u, u), parameters)
    return Weighed(root, scale(root, u), 0)


def _corrected(loss: Loss, parameters: Sequence[Scalar], u: Vector) -> Weighed:
    """Triggs et al. (1999), eq. 10 and 11: alpha = 1 - sqrt(D), D = 1 + 2 s rho''/rho' = 1 - x bend."""
    s, k = dot(u, u), parameters[-1]
    x, root, bend = loss.weights(s, parameters)
    D = 1.0 - x * bend
    definite = lt(GAP * GAP, D)
    gap = sqrt(select(definite, D, GAP * GAP))
    # alpha / s, without 0/0 at s = 0: there D is 1
    ratio = select(definite, bend / k / k / (1.0 + gap), (1.0 - GAP) / select(definite, 1.0, s))
    return Weighed(root, scale(root / gap, u), ratio)


@dataclass(frozen=True)
class Weighted:
    """A residual, whitened and weighed, and what makes Jacobians of it: (I - ratio u u^T) scale J."""

    residual: Vector
    scale: Matrix
    u: Vector
    ratio: Scalar

    def jacobian(self, J: Matrix) -> Matrix:
        """The Jacobian of the weighed residual, from that of the residual as it was."""
        scaled = matmul(self.scale, J)
        if is_structural(self.ratio):
            return scaled
        (row,) = matmul((self.u,), scaled)
        moved = scale(self.ratio, row)
        return tuple(sub(own, scale(x, moved)) for own, x in zip(scaled, self.u, strict=True))

    @property
    def blocks(self) -> tuple[Matrix, ...]:
        """All its numbers, as matrices."""
        return (self.residual,), self.scale, (self.u,), ((self.ratio,),)

    @staticmethod
    def of(blocks: Sequence[Matrix]) -> Weighted:
        """What :attr:`blocks` were made of."""
        (residual,), scale, (u,), ((ratio,),) = blocks
        return Weighted(residual, scale, u, ratio)


MODES: Mapping[str, Mode] = {
    mode.name: mode
    for mode in (
        Mode(
            "irls",
            ("sqrt(w) u", "sqrt(w) {0}", "w = rho'(s)"),
            (r"\sqrt{w}\, u", r"\sqrt{w}\,", r"w = \rho'(s)"),
            _reweighted,
        ),
        Mode(
            "triggs",
            (
                "sqrt(w) / (1 - alpha_t) u",
                "sqrt(w) (I - alpha_t u u^T / s) {0}",
                "w = rho'(s), alpha_t = 1 - sqrt(1 + 2 s rho''(s) / w), at most 1 - 1/64",
            ),
            (
                r"\frac{\sqrt{w}}{1 - \alpha_t}\, u",
                r"\sqrt{w} \left(I - \frac{\alpha_t}{s} u u^{\top}\right)",
                r"w = \rho'(s),\; \alpha_t = 1 - \sqrt{1 + 2 s \rho''(s) / w}",
            ),
            _corrected,
        ),
    )
}


@dataclass(frozen=True)
class Weighting:
    """What ``noise=``, ``loss=`` and ``mode=`` say; at least one of noise and loss is there."""

    noise: Noise | None
    loss: Loss | None
    mode: Mode
    #: What parameters of the loss are called where the factor has an argument of their name.
    renamed: tuple[tuple[str, str], ...] = ()

    def beside(self, arguments: Collection[str]) -> Weighting:
        """The same, with ``loss_k`` for ``k`` where that is an argument of the factor."""
        made: list[tuple[str, str]] = []
        for name in self.loss.parameters if self.loss else ():
            free = name
            while free in arguments:
                free = f"loss_{free}"
            made += [(name, free)] if free != name else []
        return replace(self, renamed=tuple(made))

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """What the loss's parameters are called, in order."""
        return tuple(dict(self.renamed).get(n, n) for n in (self.loss.parameters if self.loss else ()))

    def weights(self, m: int) -> tuple[Weight, ...]:
        """The keywords that it adds to a factor with m residuals."""
        noise, loss = self.noise, self.loss
        own = (Weight(KEYWORD, noise.shape(m), noise.kind(m), noise.meaning),) if noise else ()
        names = zip(loss.parameters, self.parameter_names, strict=True) if loss else ()
        return own + tuple(Weight(called, (1,), "R1", loss.meaning(n)) for n, called in names if loss)

    def parameters(self, given: Mapping[str, Vector]) -> tuple[Scalar, ...]:
        """The loss's parameters in order."""
        return tuple(given[name][0] for name in self.parameter_names)

    def weighted(self, given: Mapping[str, Vector], r: Vector) -> Weighted:
        """The residual, whitened and weighed. ``given`` holds the keywords' numbers."""
        S = self.noise.matrix(given[KEYWORD], len(r)) if self.noise else eye(len(r))
        u = matvec(S, r)
        if not self.loss:
            return Weighted(u, S, u, 0)
        weighed = self.mode.weigh(self.loss, self.parameters(given), u)
        # the root goes into S, which has fewer entries than the Jacobians
        return Weighted(weighed.residual, matscale(weighed.root, S), u, weighed.ratio)

    def apply(
        self, given: Mapping[str, Vector], r: Vector, blocks: Blocks[K]
    ) -> tuple[Vector, dict[K, Matrix]]:
        """The residual and its Jacobians, whitened and weighed. ``given`` holds the keywords' numbers."""
        weighted = self.weighted(given, r)
        return weighted.residual, {key: weighted.jacobian(J) for key, J in blocks.items()}

    def cost(self, given: Mapping[str, Vector], r: Vector) -> Scalar:
        """1/2 rho(|S r|^2)."""
        u = Weighting(self.noise, None, self.mode).weighted(given, r).residual
        s = dot(u, u)
        return 0.5 * (self.loss.rho(s, *self.parameters(given)) if self.loss else s)

    def lines(self, residual: str, m: int, variables: Sequence[str], frame: str | None) -> tuple[str, ...]:
        """What is computed, for headers and ``explain``; ``residual`` names the unwhitened one, of dim m."""
        u = f"{KEYWORD} {residual}" if self.noise else residual
        found: list[str] = []
        if self.noise:
            place = f"given in {frame}" if frame else "in the residual's own units"
            found.append(f"noise: {self.noise.name}, {place}")
        weights = [f"{w.name} ({w.kind}): {w.meaning}" for w in self.weights(m)]
        found += weights[: len(found)]
        if not self.loss:
            return (*found, f"res = {u}", *(f"res_D_{v} = {KEYWORD} {residual}_D_{v}" for v in variables))
        value, jacobian, where = self.mode.formula
        slopes = [f"{KEYWORD} {residual}_D_{v}" if self.noise else f"{residual}_D_{v}" for v in variables]
        return (
            *found,
            f"loss: {self.loss.name}, rho(s) = {self.loss.formula}; the cost is rho(s) / 2",
            *(f"{parameter} of the loss is called {called}" for parameter, called in self.renamed),
            *weights[1 if self.noise else 0 :],
            f"mode: {self.mode.name}; res^T res_D_{variables[0]} is the exact gradient of the cost",
            f"u = {u}, s = |u|^2, {where}",
            f"res = {value}",
            *(f"res_D_{v} = {jacobian.format(J)}" for v, J in zip(variables, slopes, strict=True)),
        )

    def latex_rows(self, residual: str, variables: Sequence[str]) -> tuple[str, ...]:
        r"""Rows of an ``aligned`` environment: what ``res`` and its Jacobians are, with S = ``sqrt_info``."""
        S = "S\\, " if self.noise else ""
        slopes = [rf"\frac{{\partial {residual}}}{{\partial {v}}}" for v in variables]
        made = [rf"\mathrm{{res}}_{{{v}}}" for v in variables]
        if not self.loss:
            rows = [rf"\mathrm{{res}} &= {S}{residual}"]
            return (*rows, *(f"{name} &= {S}{slope}" for name, slope in zip(made, slopes, strict=True)))
        value, weight, where = self.mode.latex
        return (
            rf"u &= {S}{residual},\; s = \left\lVert u \right\rVert^{{2}},\; {where}",
            rf"\mathrm{{res}} &= {value}",
            *(f"{name} &= {weight} {S}{slope}" for name, slope in zip(made, slopes, strict=True)),
        )

    def draw(self, generator: np.random.Generator, m: int) -> dict[str, NDArray[np.float64]]:
        """Numbers of the keywords for one sample of verification."""
        values = {KEYWORD: self.noise.draw(generator, m).ravel()} if self.noise else {}
        if self.loss:
            row = self.loss.shapes[int(generator.integers(len(self.loss.shapes)))]
            *shape, width = self.parameter_names
            values |= {n: np.array([x]) for n, x in zip(shape, row, strict=True)}
            values[width] = generator.uniform(*_SCALES, 1)
        return values


def weighting(noise: str | None, loss: str | None, mode: str | None, where: str) -> Weighting | None:
    """Read the names; None where neither noise nor loss is asked for.

    Raises DefinitionError for unknown names, at ``where``.
    """
    asked = (("noise", noise, NOISES), ("loss", loss, LOSSES), ("mode", mode, MODES))
    complaints = [known(what, name, table) for what, name, table in asked if name is not None]
    if any(complaints):
        raise DefinitionError(f"{where}: {'; '.join(filter(None, complaints))}")
    if mode is not None and loss is None:
        raise DefinitionError(f"{where}: mode={mode!r} is one of a loss; give loss= too")
    if noise is None and loss is None:
        return None
    return Weighting(NOISES[noise] if noise else None, LOSSES[loss] if loss else None, MODES[mode or "irls"])
