"""``Signature``: what a foreign function must take and return, as plain values that another process reads."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from liegen.define import Function
from liegen.kernel import Kernel
from liegen.manifolds import Vector


@dataclass(frozen=True)
class Argument:
    """An argument: its manifold's name, tangent dimension, and the shape of its stored numbers."""

    name: str
    manifold: str
    variable: bool
    vector: bool  # of R^n
    dim: int
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of stored scalars."""
        return math.prod(self.shape)


@dataclass(frozen=True)
class Signature:
    """The arguments in order; ``size`` stored scalars of the output, whose tangent has ``rows``."""

    factor: str
    arguments: tuple[Argument, ...]
    size: int
    rows: int

    @property
    def variables(self) -> tuple[Argument, ...]:
        """The arguments that have Jacobians."""
        return tuple(a for a in self.arguments if a.variable)


def signature(function: Function[..., Any]) -> Signature:
    """The signature that a function in the place of ``function`` has."""
    vectors = [p.name for p in function.graph.parameters if issubclass(p.manifold, Vector)]
    return of_kernel(function.kernel, vectors)


def of_kernel(kernel: Kernel, vectors: Collection[str] = ()) -> Signature:
    """The signature of a kernel, in which the arguments ``vectors`` are of R^n."""
    arguments = tuple(
        Argument(a.name, a.manifold, a.variable, a.name in vectors, a.dim, a.shape) for a in kernel.arguments
    )
    output = kernel.outputs[0]
    return Signature(kernel.name, arguments, output.size, output.dim)
