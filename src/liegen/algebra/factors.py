"""Factors of a chain that stand for group elements, so that what is inverse to each other can cancel.

A rotation matrix R(q) and an adjoint Ad(a) are images of group elements: products of images are images of
products. Their numbers do not show that any more, so a factor keeps the coordinates of its element.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .linear import Chain, Matrix, Vector, block_diagonal, eye, transpose


@dataclass(frozen=True, eq=False)
class Letter:
    """A rotation by its stored coordinates, with its matrix; or the inverse of that rotation."""

    coords: Vector
    matrix: Matrix
    inverse: bool = False

    @property
    def inverted(self) -> Letter:
        """The inverse rotation."""
        return replace(self, inverse=not self.inverse)

    @property
    def numbers(self) -> Matrix:
        """Its own matrix."""
        return transpose(self.matrix) if self.inverse else self.matrix


#: A product of rotations; the empty word is the identity.
Word = tuple[Letter, ...]


@dataclass(frozen=True, eq=False)
class Turn:
    """Blocks along a diagonal, each of them the matrix of a word; ``sizes`` are their numbers of rows."""

    words: tuple[Word, ...]
    sizes: tuple[int, ...]

    @property
    def parts(self) -> Chain:
        """One block diagonal factor for each place in the longest word."""
        length = max(map(len, self.words))
        return tuple(self._factor(place) for place in range(length)) or (eye(sum(self.sizes)),)

    @property
    def letters(self) -> int:
        """The length of all words together."""
        return sum(map(len, self.words))

    def _factor(self, place: int) -> Matrix:
        pairs = zip(self.words, self.sizes, strict=True)
        return block_diagonal(*(w[place].numbers if place < len(w) else eye(n) for w, n in pairs))


@dataclass(frozen=True, eq=False)
class Adjoint:
    """Ad of the group element with these coordinates, or of its inverse; ``parts`` are its sparse factors."""

    group: str
    coords: Vector
    inverse: bool
    parts: Chain


@dataclass(frozen=True, eq=False)
class Passing:
    """A factor that lets certain rotations pass: ``parts`` times ``taken`` is ``given`` times ``moved``."""

    parts: Chain
    taken: Turn
    given: Turn
    moved: Chain
