"""What similarities of the plane and of space have in common: x = (R, t, s), x p = s R p + t, s > 0."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence

from liegen.algebra import Scalar, call
from liegen.algebra.linear import Matrix, Vector, add, matscale, matvec, negate, scale, sub
from liegen.coefficients import tables

from .form import Coords, GroupForm, RotationForm, Source

#: Logarithms of scales around 0 and at both sides of the coefficients' switches.
LOG_SCALES = (
    0.0, 1e-160, -1e-12, 1e-8, -1e-5, 1e-3, -0.1,
    *(side * end for end in (tables.SIMILARITY_END, math.sqrt(tables.HYPERBOLIC_END))
      for side in (1 - 1e-9, -1 - 1e-9)),
)  # fmt: skip

#: Largest logarithm of a scale but for these.
MOST = 3.0


class SimilarityForm(GroupForm):
    """Stored rotation, translation, scale; the tangent ends with the logarithm of the scale."""

    turns = True
    rotation: RotationForm
    rotation_first: bool

    @property
    def space(self) -> int:
        """Dimension of the vectors that it moves."""
        return self.rotation.space

    def rotation_of(self, x: Coords) -> Vector:
        """The rotation's coordinates."""
        return tuple(x[: self.rotation.size])

    def translation_of(self, x: Coords) -> Vector:
        """The translation, the image of the origin."""
        return tuple(x[self.rotation.size : -1])

    def scale_of(self, x: Coords) -> Scalar:
        """The scale."""
        return x[-1]

    def linear(self, x: Coords) -> Matrix:
        """The matrix s R."""
        return matscale(self.scale_of(x), self.rotation.matrix(self.rotation_of(x)))

    def in_order(self, rotation: Matrix, translation: Matrix, scaling: Matrix) -> tuple[Matrix, ...]:
        """Columns of the three parts in the order of this group's tangent."""
        first = (rotation, translation) if self.rotation_first else (translation, rotation)
        return (*first, scaling)

    def identity(self) -> Vector:
        return (*self.rotation.identity(), *(0,) * self.space, 1)

    def act(self, x: Coords, p: Coords) -> Vector:
        """Return s R p + t."""
        turned = matvec(self.rotation.matrix(self.rotation_of(x)), p)
        return add(scale(self.scale_of(x), turned), self.translation_of(x))

    def act_inverse(self, x: Coords, p: Coords) -> Vector:
        """Return R^T (p - t) / s."""
        back = self.rotation.matrix(self.rotation.inverse(self.rotation_of(x)))
        return scale(1 / self.scale_of(x), matvec(back, sub(p, self.translation_of(x))))

    def compose(self, a: Coords, b: Coords) -> Vector:
        """(R_a R_b, t_a + s_a R_a t_b, s_a s_b)."""
        q = self.rotation.compose(self.rotation_of(a), self.rotation_of(b))
        return (*q, *self.act(a, self.translation_of(b)), self.scale_of(a) * self.scale_of(b))

    def inverse(self, a: Coords) -> Vector:
        """(R^T, -R^T t / s, 1 / s)."""
        q, r = self.rotation.inverse(self.rotation_of(a)), 1 / self.scale_of(a)
        return (*q, *scale(-r, matvec(self.rotation.matrix(q), self.translation_of(a))), r)

    def between(self, a: Coords, b: Coords) -> Vector:
        """(R_a^T R_b, R_a^T (t_b - t_a) / s_a, s_b / s_a)."""
        q = self.rotation.compose(self.rotation.inverse(self.rotation_of(a)), self.rotation_of(b))
        r = 1 / self.scale_of(a)
        return (*q, *self.act_inverse(a, self.translation_of(b)), self.scale_of(b) * r)

    def log_scale(self, a: Coords) -> Scalar:
        """The logarithm of the scale."""
        return call("log", self.scale_of(a))

    def exp_scale(self, d: Coords) -> Scalar:
        """The scale of a tangent vector."""
        return call("exp", d[-1])

    @abstractmethod
    def Jl(self, d: Coords) -> Matrix:
        """Left Jacobian, the one that is written out here: exp(d + e) = exp(Jl e) exp(d)."""

    @abstractmethod
    def Jl_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """Inverse of ``Jl``."""

    def Jr(self, d: Coords) -> Matrix:
        """Jr(d) = Jl(-d) (micro Lie, eq. 76)."""
        return self.Jl(negate(d))

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        return self.Jl_inv(negate(d), principal=principal)

    def matrix(self, a: Coords) -> Matrix:
        """The homogeneous matrix [[s R, t], [0, 1]]."""
        rows = tuple((*row, t) for row, t in zip(self.linear(a), self.translation_of(a), strict=True))
        return (*rows, (0,) * self.space + (1,))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        """A rotation, a position of size ``spread`` [m], a scale of 1/4 to 4."""
        moved = source.vector(self.space, spread=spread)
        return (*self.rotation.draw(source, spread), *moved, 2.0 ** source.uniform(-2, 2))

    def draw_log_scale(self, source: Source, angle: float, offset: float | None) -> float:
        """Any scale, half of the time one at which digits get lost elsewhere; 1 where nothing is to move.

        Beyond half a turn scales of e^4.5 are left out: terms of exp's Jacobian are twenty times its entries.
        """
        if offset == 0:
            return 0.0
        k = int(source.uniform(0, 2 * len(LOG_SCALES)))
        special = LOG_SCALES[k] if k < len(LOG_SCALES) else source.uniform(-MOST, MOST)
        return special if angle <= math.pi or abs(special) <= MOST else source.uniform(-MOST, MOST)
