"""The contract of a chart of one manifold."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from liegen.algebra.linear import Chain, Vector
from liegen.manifolds.form import Compute, Coords, Rule


class FormChart(ABC):
    """A chart other than the manifold's own. All blocks are by right exponential perturbations x exp(e)."""

    form: Any
    note: str  # one line on storage and chart, as of a ManifoldForm

    @abstractmethod
    def retract(self, x: Coords, d: Coords) -> Vector:
        """The point that the coordinates d at x lead to."""

    @abstractmethod
    def local(self, x: Coords, y: Coords) -> Vector:
        """The coordinates at x that lead to y."""

    @abstractmethod
    def retract_blocks(self) -> Rule | None:
        """Rule (result, x, d) -> blocks of ``retract``; None stands for automatic differentiation."""

    @abstractmethod
    def local_blocks(self) -> Rule | None:
        """Rule (result, x, y) -> blocks of ``local``; None stands for automatic differentiation."""

    def local_between(self) -> tuple[Compute, Rule] | None:
        """As that of :class:`GroupForm`, in this chart."""
        return None

    @abstractmethod
    def columns(self, x: Coords) -> Chain:
        """M(x) = d log(x^-1 x.retract(d))/dd at d = 0; a Jacobian in this chart is J M(x)."""

    @abstractmethod
    def rows(self, x: Coords) -> Chain:
        """The inverse of M(x)."""
