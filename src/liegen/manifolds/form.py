"""The contract of a manifold and of a group: closed forms on tuples of scalars of any backend.

A group file writes the forms that are particular to it; everything that follows from them stands here.
Conventions: right perturbations, ``x.retract(d) = x exp(d)``, ``x.local(y) = log(x^-1 y)``.
Reference: Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics" (2018), cited as
"micro Lie" with its equation numbers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from liegen.algebra import Scalar
from liegen.algebra.linear import Chain, Matrix, Vector, diagonal, eye, negate, product, scale

Coords = Sequence[Scalar]
#: For each operand the derivative of a result, as a chain, or None where there is none.
Blocks = tuple[Chain | None, ...]
#: The coordinates of a result from those of its operands.
Compute = (
    Callable[[Any], Vector]
    | Callable[[Any, Any], Vector]
    | Callable[[Any, Any, Any], Vector]
    | Callable[[Any, Any, Any, Any], Vector]
)
#: The blocks from the result and the operands.
Rule = (
    Callable[[Any, Any], Blocks]
    | Callable[[Any, Any, Any], Blocks]
    | Callable[[Any, Any, Any, Any], Blocks]
    | Callable[[Any, Any, Any, Any, Any], Blocks]
)


class Source(Protocol):
    """A source of random numbers, as :class:`liegen.samples.Draw` is."""

    def uniform(self, low: float, high: float) -> float:
        """A number in [low, high)."""
        ...

    def unit(self, n: int) -> NDArray[np.float64]:
        """A unit vector with n components."""
        ...

    def vector(self, n: int, length: float | None = None, spread: float = 1.0) -> NDArray[np.float64]:
        """A vector of the given length, or of a size around ``spread``."""
        ...


class ManifoldForm(ABC):
    """A manifold: how it is stored, and its default chart."""

    name: str
    storage: tuple[str, ...]  # names of the stored scalars
    tangent: tuple[str, ...]  # names of the tangent's coordinates, with units
    note: str = ""  # one line on storage and chart for headers and documentation
    parts: tuple[ManifoldForm, ...] = ()  # of a product
    quaternions: tuple[int, ...] = ()  # where a quaternion q begins in the storage; -q is the same element
    flat: bool = False  # the chart is addition
    turns: bool = False  # a group whose elements rotate

    @property
    def dim(self) -> int:
        """Dimension of the tangent space."""
        return len(self.tangent)

    @property
    def size(self) -> int:
        """Number of stored scalars."""
        return len(self.storage)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array that holds an element."""
        return (self.size,)

    @abstractmethod
    def retract(self, x: Coords, d: Coords) -> Vector:
        """The point that the tangent vector ``d`` at ``x`` leads to."""

    @abstractmethod
    def local(self, x: Coords, y: Coords) -> Vector:
        """The tangent vector at ``x`` that leads to ``y``."""

    def lift(self, x: Coords) -> Matrix | None:
        """d local(x, y)/dy at y = x, dim x size; None: by automatic differentiation of ``local``."""
        return None

    def retract_blocks(self) -> Rule | None:
        """Rule (result, x, d) -> blocks of ``retract``; None: differentiation through the storage."""
        return None

    def local_blocks(self) -> Rule | None:
        """Rule (result, x, y) -> blocks of ``local``; None: differentiation through the storage."""
        return None

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        """The storage of any element; positions are of size ``spread`` [m]."""
        return source.unit(self.size).tolist()

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        """A tangent vector with this rotation angle [rad] and length of its other vectors (None: any)."""
        return (source.unit(self.dim) * angle).tolist()


class GroupForm(ManifoldForm):
    """A Lie group."""

    exponential: bool = True  # the chart is x exp(d)

    @abstractmethod
    def identity(self) -> Vector:
        """The neutral element."""

    @abstractmethod
    def compose(self, a: Coords, b: Coords) -> Vector:
        """The product a b."""

    @abstractmethod
    def inverse(self, a: Coords) -> Vector:
        """The inverse of a."""

    @abstractmethod
    def exp(self, d: Coords) -> Vector:
        """The group's exponential."""

    @abstractmethod
    def log(self, a: Coords) -> Vector:
        """The group's logarithm, the branch of the shorter way round."""

    @abstractmethod
    def adjoint(self, a: Coords) -> Chain:
        """Ad_a with a exp(d) = exp(Ad_a d) a (micro Lie, eq. 29-32)."""

    @abstractmethod
    def Jr(self, d: Coords) -> Matrix:
        """Right Jacobian: exp(d + e) = exp(d) exp(Jr(d) e) to first order (micro Lie, eq. 67)."""

    @abstractmethod
    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """Inverse of ``Jr``. ``principal``: d is a logarithm, so its rotation is at most pi."""

    @abstractmethod
    def matrix(self, a: Coords) -> Matrix:
        """The element as a square matrix; products of elements are products of matrices."""

    def between(self, a: Coords, b: Coords) -> Vector:
        """The product a^-1 b."""
        return self.compose(self.inverse(a), b)

    def adjoint_inverse(self, a: Coords) -> Chain:
        """Ad of a^-1."""
        return self.adjoint(self.inverse(a))

    def Jl(self, d: Coords) -> Matrix:
        """Left Jacobian, Jl(d) = Jr(-d) (micro Lie, eq. 76)."""
        return self.Jr(negate(d))

    def Jl_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """Inverse of ``Jl``."""
        return self.Jr_inv(negate(d), principal=principal)

    def retract(self, x: Coords, d: Coords) -> Vector:
        """Return x exp(d)."""
        return self.compose(x, self.exp(d))

    def local(self, x: Coords, y: Coords) -> Vector:
        """Return log(x^-1 y)."""
        return self.log(self.between(x, y))

    def retract_blocks(self) -> Rule:
        """d/dx = Ad(exp(d))^-1, d/dd = Jr(d) (micro Lie, eq. 82-83)."""
        return lambda _, _x, d: (self.adjoint_inverse(self.exp(d)), (self.Jr(d),))

    def local_blocks(self) -> Rule:
        """d/dy = Jr^-1(r), d/dx = -Jl^-1(r) (micro Lie, eq. 79, 84)."""
        return lambda r, _x, _y: (
            (_negative(self.Jl_inv(r, principal=True)),),
            (self.Jr_inv(r, principal=True),),
        )

    def compose_blocks(self) -> Rule:
        """d/da = Ad(b^-1), d/db = I (micro Lie, eq. 63-64)."""
        return lambda _, _a, b: (self.adjoint_inverse(b), (eye(self.dim),))

    def inverse_blocks(self) -> Rule:
        """d/da = -Ad(a) (micro Lie, eq. 62)."""
        return lambda _, a: (_negated(self.adjoint(a)),)

    def between_blocks(self) -> Rule:
        """d/da = -Ad(c^-1) with c = a^-1 b, d/db = I (micro Lie, eq. 81)."""
        return lambda c, _a, _b: (_negated(self.adjoint_inverse(c)), (eye(self.dim),))

    def part_way(self, r: Coords, a: Scalar) -> Chain:
        """The product a Jr(a r) Jr^-1(r) for a logarithm r."""
        return (diagonal((a,) * self.dim), self.Jr(scale(a, r)), self.Jr_inv(r, principal=True))

    def local_between(self) -> tuple[Compute, Rule] | None:
        """Value and rule of z.local(x.between(y)) as one operation on (z, x, y), where that saves any.

        It is meant for Jacobians by x; the value alone is cheaper in two steps.
        """
        return None

    def exp_blocks(self) -> Rule:
        """d/dd = Jr(d)."""
        return lambda _, d: ((self.Jr(d),),)

    def log_blocks(self) -> Rule:
        """d/da = Jr^-1(log a) (micro Lie, eq. 79)."""
        return lambda r, _a: ((self.Jr_inv(r, principal=True),),)

    def adjoint_matrix(self, a: Coords) -> Matrix:
        """Ad_a multiplied out."""
        return product(self.adjoint(a))


def _negative(a: Matrix) -> Matrix:
    return tuple(negate(row) for row in a)


def _negated(chain: Chain) -> Chain:
    return (_negative(chain[0]), *chain[1:])


class PoseForm(GroupForm):
    """A semidirect product of a rotation and a translation: x = (R, t), x p = R p + t."""

    turns = True
    rotation: RotationForm
    rotation_first: bool

    @property
    def space(self) -> int:
        """Dimension of the vectors that it moves."""
        return self.rotation.space

    def join(self, rotation: Coords, translation: Coords) -> Vector:
        """Coordinates from both parts."""
        return (*rotation, *translation)

    def rotation_of(self, x: Coords) -> Vector:
        """The rotation's coordinates."""
        return tuple(x[: self.rotation.size])

    def translation_of(self, x: Coords) -> Vector:
        """The translation."""
        return tuple(x[self.rotation.size :])

    def in_order(self, rotation: Matrix, translation: Matrix) -> tuple[Matrix, Matrix]:
        """Columns (or rows) of both parts in the order of this group's tangent."""
        return (rotation, translation) if self.rotation_first else (translation, rotation)

    def identity(self) -> Vector:
        """No rotation, no translation."""
        return self.join(self.rotation.identity(), (0,) * self.rotation.space)

    def compose(self, a: Coords, b: Coords) -> Vector:
        """(R_a R_b, t_a + R_a t_b)."""
        q, moved = self.rotation_of(a), self.rotation.rotate(self.rotation_of(a), self.translation_of(b))
        t = tuple(s + u for s, u in zip(self.translation_of(a), moved, strict=True))
        return self.join(self.rotation.compose(q, self.rotation_of(b)), t)

    def inverse(self, a: Coords) -> Vector:
        """(R^T, -R^T t)."""
        q = self.rotation.inverse(self.rotation_of(a))
        return self.join(q, negate(self.rotation.rotate(q, self.translation_of(a))))

    def between(self, a: Coords, b: Coords) -> Vector:
        """(R_a^T R_b, R_a^T (t_b - t_a))."""
        q = self.rotation.inverse(self.rotation_of(a))
        d = tuple(u - s for s, u in zip(self.translation_of(a), self.translation_of(b), strict=True))
        return self.join(self.rotation.compose(q, self.rotation_of(b)), self.rotation.rotate(q, d))

    def draw(self, source: Source, spread: float) -> Sequence[float]:
        """A rotation, and a position of size ``spread`` [m]."""
        return (*self.rotation.draw(source, spread), *source.vector(self.rotation.space, spread=spread))

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        """A rotation by ``angle`` [rad], and a translation of length ``offset`` [m]."""
        turn = self.rotation.draw_tangent(source, angle, offset)
        move = source.vector(self.rotation.space, offset)
        return (*turn, *move) if self.rotation_first else (*move, *turn)

    def matrix(self, a: Coords) -> Matrix:
        """The homogeneous matrix [[R, t], [0, 1]]."""
        R = self.rotation.matrix(self.rotation_of(a))
        rows = tuple((*row, t) for row, t in zip(R, self.translation_of(a), strict=True))
        return (*rows, (0,) * self.rotation.space + (1,))


class RotationForm(GroupForm):
    """A group of rotations of the plane or of space."""

    turns = True
    space: int  # dimension of the vectors that it rotates

    @abstractmethod
    def rotate(self, a: Coords, v: Coords) -> Vector:
        """R v, the cheapest way for a single vector."""

    @abstractmethod
    def generator(self, v: Coords) -> Matrix:
        """d(exp(e) v)/de at 0, space x dim."""
