"""Exact cancellation in chains: what is inverse to each other meets and disappears before it is multiplied.

All the rules, for matrices of rotations R and adjoints Ad, which are images of group elements:

1. Products of images are images of products: Ad(a) Ad(b) = Ad(a b), R(a) R(b) = R(a b), and a a^-1 is the
   identity. With c = a^-1 b from the graph, Ad(c^-1) Ad(a^-1) is Ad(b^-1). Of all ways to write a product by
   elements of the graph, one with the fewest is taken.
2. Rotations along a diagonal multiply block by block.
3. A matrix P of blocks that are multiples of the identity (an order, a scale, a choice of parts) lets
   rotations pass: P diag(R_1, R_2, ...) = diag(R_j, R_k, ...) P. They pass where they then cancel.
4. G(v), by which R v moves with R, is seen alike from everywhere: G(v) R^T = R^T G(R v).
5. Where rotations stand in a chain, an adjoint is split into its rotation and its unit triangular factor.
"""

from __future__ import annotations

from itertools import accumulate, groupby

from liegen.algebra import Scalar
from liegen.algebra.factors import Adjoint, Passing, Turn, Word
from liegen.algebra.linear import Chain, Factor, Matrix, Sign, eye, is_identity, is_structural, plain

from .elements import Elements, Key, key


def cancelled(chain: Chain, elements: Elements) -> Chain:
    """A chain with the same product, without what cancels."""
    merged = _adjoints(chain, elements)
    if any(isinstance(f, Turn) for f in merged):
        merged = tuple(g for f in merged for g in (f.parts if isinstance(f, Adjoint) else (f,)))
    gathered: tuple[Matrix | Factor, ...] = ()
    for factor in merged:
        gathered = _followed(gathered, factor, elements) if isinstance(factor, Turn) else (*gathered, factor)
    kept = tuple(f for f in gathered if not (isinstance(f, Turn) and not f.letters))
    return kept or (eye(len(plain(chain)[0])),)


def _adjoints(chain: Chain, elements: Elements) -> Chain:
    """Rule 1 for neighbouring adjoints; a sign between them goes before them, an identity nowhere."""
    signed: list[Matrix | Factor] = []
    for factor in (f for f in chain if not is_identity(f)):
        behind = bool(signed) and isinstance(signed[-1], Adjoint) and isinstance(factor, Sign)
        signed = [*signed[:-1], factor, signed[-1]] if behind else [*signed, factor]
    found: list[Matrix | Factor] = []
    for group, run in groupby(signed, key=lambda f: f.group if isinstance(f, Adjoint) else ""):
        factors = tuple(run)
        found += elements.adjoint([f for f in factors if isinstance(f, Adjoint)]) if group else factors
    return tuple(found)


def _followed(before: Chain, turn: Turn, elements: Elements) -> Chain:
    """Rules 1 to 4: the chain ``before``, then rotations, which pass to where they cancel."""
    moved, k = turn, len(before)
    passed: Chain = ()
    while k and not isinstance(before[k - 1], Turn):
        found = _exchanged(before[k - 1], moved)
        if found is None:
            break
        moved, factors = found
        passed, k = (*factors, *passed), k - 1
    earlier = before[k - 1] if k else None
    if isinstance(earlier, Turn) and earlier.sizes == moved.sizes:
        words = tuple(elements.rotation((*a, *b)) for a, b in zip(earlier.words, moved.words, strict=True))
        both = Turn(words, moved.sizes)
        if not passed or both.letters < earlier.letters + turn.letters:
            return (*before[: k - 1], both, *passed)
    return (*before[:k], moved, *passed) if moved.letters < turn.letters else (*before, turn)


def _exchanged(factor: Matrix | Factor, turn: Turn) -> tuple[Turn, Chain] | None:
    """Rotations that stand before a factor instead of after it, and what the factor is then."""
    if isinstance(factor, Sign):
        return turn, (factor,)
    if isinstance(factor, Passing):
        same = factor.taken.sizes == turn.sizes and _names(factor.taken) == _names(turn)
        return (factor.given, factor.moved) if same else None
    found = _passed(factor, turn) if isinstance(factor, tuple) else None
    return None if found is None else (found, (factor,))


def _names(turn: Turn) -> list[list[tuple[Key, bool]]]:
    return [[(key("R", x.coords), x.inverse) for x in word] for word in turn.words]


def _passed(P: Matrix, turn: Turn) -> Turn | None:
    """The rotations on the left of P, None where P does not consist of multiples of the identity."""
    starts = dict(zip(accumulate(turn.sizes, initial=0), range(len(turn.sizes)), strict=False))
    words: list[Word] = []
    sizes: list[int] = []
    row = 0
    while row < len(P):
        first = next((j for j, x in enumerate(P[row]) if not _is_zero(x)), None)
        if first not in starts:
            return None
        block = starts[first]
        n = turn.sizes[block]
        if not all(_is_multiple(P[row + i : row + i + 1], first + i, P[row][first]) for i in range(n)):
            return None
        words.append(turn.words[block])
        sizes.append(n)
        row += n
    return Turn(tuple(words), tuple(sizes))


def _is_multiple(row: Matrix, column: int, scale: Scalar) -> bool:
    """Whether the row exists and holds ``scale`` in that column, zeros elsewhere."""
    return len(row) == 1 and all(
        _same(x, scale) if j == column else _is_zero(x) for j, x in enumerate(row[0])
    )


def _is_zero(x: Scalar) -> bool:
    return is_structural(x) and x == 0


def _same(x: Scalar, y: Scalar) -> bool:
    """Whether both are one number or one scalar of a graph."""
    numbers = isinstance(x, int | float) and isinstance(y, int | float)
    return x is y or (numbers and x == y)
