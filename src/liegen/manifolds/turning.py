"""Rotations and poses as factors of chains that know their element, so that inverse ones cancel."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from liegen.algebra import Scalar
from liegen.algebra.factors import Letter, Passing, Turn, Word
from liegen.algebra.linear import Chain, Matrix, beside, eye

if TYPE_CHECKING:
    from liegen.algebra.linear import Vector

    from .form import RotationForm

Coords = Sequence[Scalar]


class Turned(tuple[Scalar, ...]):
    """Scalars of an element that begin with a rotation whose matrix is known already."""

    rotation_matrix: Matrix

    def __new__(cls, scalars: Coords, rotation_matrix: Matrix) -> Turned:
        """The scalars, and the matrix that they are another form of."""
        made = super().__new__(cls, scalars)
        made.rotation_matrix = rotation_matrix
        return made


def known_matrix(a: Coords) -> Matrix | None:
    """The rotation's matrix where it need not be computed."""
    return a.rotation_matrix if isinstance(a, Turned) else None


class RotationFactors(ABC):
    """The factors of a group of rotations."""

    space: int

    @property
    @abstractmethod
    def dim(self) -> int:
        """Dimension of the tangent space."""

    @abstractmethod
    def matrix(self, a: Coords) -> Matrix:
        """R."""

    @abstractmethod
    def generator(self, v: Coords) -> Matrix:
        """d(exp(e) v)/de at 0, space x dim."""

    def letter(self, a: Coords, *, inverse: bool = False) -> Letter:
        """The rotation, or its inverse, as a letter of words."""
        return Letter(tuple(a), self.matrix(a), inverse)

    def turned(self, a: Coords, *, inverse: bool = False) -> Chain:
        """R, or R^T, as a factor that knows its rotation."""
        return (_alone(self.letter(a, inverse=inverse), self.space),)

    def word(self, letter: Letter) -> Word:
        """How a rotation turns tangent vectors: not at all in the plane."""
        return (letter,) if self.space > 2 else ()

    def lever(self, a: Coords, body: Coords, world: Coords) -> Chain:
        """d(exp(e) v)/de at 0, v seen from the body; ``world`` is R v: G(v) R^T = R^T G(R v)."""
        back = self.letter(a, inverse=True)
        taken = Turn((self.word(back),), (self.dim,))
        first, then = self.generator(body), self.generator(world)
        return (Passing((first,), taken, _alone(back, self.space), (then,)),)


class PoseFactors(ABC):
    """The factors of a group of poses."""

    rotation: RotationForm
    rotation_first: bool

    @abstractmethod
    def rotation_of(self, x: Coords) -> Vector:
        """The rotation's coordinates."""

    @abstractmethod
    def in_order(self, rotation: Matrix, translation: Matrix) -> tuple[Matrix, Matrix]:
        """Columns (or rows) of both parts in the order of this group's tangent."""

    def turned(self, x: Coords, *, inverse: bool = False) -> Chain:
        """R, or R^T, of a pose, by which vectors change their frame."""
        return self.rotation.turned(self.rotation_of(x), inverse=inverse)

    def lever(self, x: Coords, body: Coords, world: Coords) -> Chain:
        """d(exp(e) v)/de at 0 by a pose's perturbation, v seen from the body; ``world`` is R v.

        [G(v), I] diag(R^T, R^T) = R^T [G(R v), I]; in the plane, where turns commute, without the first R^T.
        """
        rotation = self.rotation
        back = rotation.letter(self.rotation_of(x), inverse=True)
        first, then = (
            (beside(*self.in_order(rotation.generator(v), eye(rotation.space))),) for v in (body, world)
        )
        return (Passing(first, self.turn(rotation.word(back), (back,)), _alone(back, rotation.space), then),)

    def turn(self, rotation: Word, translation: Word) -> Turn:
        """Words that turn the coordinates of rotation and translation."""
        pairs = ((rotation, self.rotation.dim), (translation, self.rotation.space))
        ordered = pairs if self.rotation_first else pairs[::-1]
        return Turn((ordered[0][0], ordered[1][0]), (ordered[0][1], ordered[1][1]))


def _alone(letter: Letter, space: int) -> Turn:
    return Turn(((letter,),), (space,))
