"""Vectors and matrices as tuples of scalars of any backend, with structural zeros and ones.

The Python integers 0, 1 and -1 are structure, never numbers: a product with 0 is dropped, a product with 1
costs nothing. So the zero and identity blocks of a Jacobian never reach the generated code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from itertools import pairwise
from typing import Any, Protocol

from .base import Scalar

Vector = tuple[Scalar, ...]
Matrix = tuple[tuple[Scalar, ...], ...]


class Factor(Protocol):
    """A factor of which more is known than its numbers: see :mod:`liegen.algebra.factors`."""

    @property
    def parts(self) -> Chain:
        """What it is a product of."""
        ...


#: A matrix as a product of sparse factors, leftmost first; whoever multiplies chooses the order.
Chain = tuple[Matrix | Factor, ...]
#: The same in numbers, see :func:`plain`.
Numbers = tuple[Matrix, ...]


def is_structural(a: Scalar) -> bool:
    """Whether ``a`` is a structural integer."""
    return type(a) is int


def neg(a: Scalar) -> Scalar:
    """Return -a."""
    return -a


def times(a: Scalar, b: Scalar) -> Scalar:
    """Return a b; structural factors cost nothing."""
    if type(a) is int and -1 <= a <= 1:
        return b if a == 1 else -b if a else 0
    if type(b) is int and -1 <= b <= 1:
        return a if b == 1 else -a if b else 0
    return a * b


def plus(a: Scalar, b: Scalar) -> Scalar:
    """Return a + b; a structural zero costs nothing."""
    if type(a) is int and a == 0:
        return b
    if type(b) is int and b == 0:
        return a
    return a + b


def total(terms: Sequence[Scalar]) -> Scalar:
    """Sum from left to right."""
    return reduce(plus, terms, 0)


def add(a: Sequence[Scalar], b: Sequence[Scalar]) -> Vector:
    """Return a + b."""
    return tuple(plus(x, y) for x, y in zip(a, b, strict=True))


def sub(a: Sequence[Scalar], b: Sequence[Scalar]) -> Vector:
    """Return a - b."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


def scale(k: Scalar, v: Sequence[Scalar]) -> Vector:
    """Return k v."""
    return tuple(times(k, x) for x in v)


def negate(v: Sequence[Scalar]) -> Vector:
    """Return -v."""
    return tuple(-x for x in v)


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """Return a . b."""
    return total([times(x, y) for x, y in zip(a, b, strict=True)])


def cross(a: Sequence[Scalar], b: Sequence[Scalar]) -> Vector:
    """Return a x b of two 3-vectors."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def eye(n: int) -> Matrix:
    """Identity, as structure."""
    return tuple(tuple(int(i == j) for j in range(n)) for i in range(n))


def selection(n: int, rows: Sequence[int]) -> Matrix:
    """These rows of the identity of n, as structure; no other one is made."""
    return tuple((0,) * k + (1,) + (0,) * (n - k - 1) for k in rows)


def zeros(rows: int, columns: int) -> Matrix:
    """Zero, as structure."""
    return ((0,) * columns,) * rows


def diagonal(v: Sequence[Scalar]) -> Matrix:
    """Diagonal matrix."""
    return tuple(tuple(x if i == j else 0 for j in range(len(v))) for i, x in enumerate(v))


def column(v: Sequence[Scalar]) -> Matrix:
    """One column."""
    return tuple((x,) for x in v)


def skew(v: Sequence[Scalar]) -> Matrix:
    """The matrix [v]x with [v]x w = v x w."""
    x, y, z = v
    return ((0, -z, y), (z, 0, -x), (-y, x, 0))


def transpose(a: Matrix) -> Matrix:
    """Return the transpose."""
    return tuple(zip(*a, strict=True))


def matvec(a: Matrix, v: Sequence[Scalar]) -> Vector:
    """Return A v."""
    return tuple(dot(row, v) for row in a)


def matmul(a: Matrix, b: Matrix) -> Matrix:
    """Return A B; rows of structural zeros cost nothing, rows of the identity take over rows of B."""
    nothing = (0,) * len(b[0])
    rows: list[tuple[Scalar, ...]] = []
    for row in a:
        terms = [(x, other) for x, other in zip(row, b, strict=True) if type(x) is not int or x]
        if not terms:
            rows.append(nothing)
        elif len(terms) == 1 and type(terms[0][0]) is int and terms[0][0] == 1:
            rows.append(terms[0][1])
        else:
            columns = zip(*[other for _, other in terms], strict=True)
            factors = [x for x, _ in terms]
            rows.append(tuple([_combined(factors, column) for column in columns]))
    return tuple(rows)


def _combined(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """a . b, where b has many structural zeros."""
    return total([times(x, y) for x, y in zip(a, b, strict=True) if type(y) is not int or y])


def elementwise(f: Callable[[Scalar, Scalar], Scalar], a: Matrix, b: Matrix) -> Matrix:
    """Apply ``f`` entry by entry."""
    return tuple(tuple(f(x, y) for x, y in zip(r, s, strict=True)) for r, s in zip(a, b, strict=True))


def matadd(a: Matrix, b: Matrix) -> Matrix:
    """Return A + B."""
    return tuple([s if _nothing(r) else r if _nothing(s) else add(r, s) for r, s in zip(a, b, strict=True)])


def _nothing(row: Sequence[Scalar]) -> bool:
    return all(type(x) is int and not x for x in row)


def matscale(k: Scalar, a: Matrix) -> Matrix:
    """Return k A."""
    return tuple(scale(k, row) for row in a)


def beside(*blocks: Matrix) -> Matrix:
    """Blocks in a row: [A B ...]."""
    return tuple(tuple(x for row in rows for x in row) for rows in zip(*blocks, strict=True))


def stacked(*blocks: Matrix) -> Matrix:
    """Blocks in a column."""
    return tuple(row for block in blocks for row in block)


def block_diagonal(*blocks: Matrix) -> Matrix:
    """Blocks along the diagonal, structural zeros elsewhere."""
    widths = [len(block[0]) for block in blocks]
    return tuple(
        (*(0,) * sum(widths[:k]), *row, *(0,) * sum(widths[k + 1 :]))
        for k, block in enumerate(blocks)
        for row in block
    )


def multiply_cost(a: Matrix, b: Matrix) -> int:
    """Number of scalar products in A B that structure does not make free."""
    in_columns = [sum([type(x) is not int for x in column]) for column in zip(*a, strict=True)]
    in_rows = [sum([type(x) is not int for x in row]) for row in b]
    return sum([m * n for m, n in zip(in_columns, in_rows, strict=True)])


@dataclass(frozen=True)
class Sign:
    """The factor -I of ``size`` rows."""

    size: int

    @property
    def parts(self) -> Chain:
        """Its matrix."""
        return (negative(eye(self.size)),)


def plain(chain: Chain) -> Numbers:
    """The chain in numbers; a ``Sign`` becomes the sign of the next factor."""
    flat: list[Matrix] = []
    signed = False
    for k, factor in enumerate(chain):
        if isinstance(factor, Sign) and k + 1 < len(chain):
            signed = not signed
            continue
        first, *others = (factor,) if isinstance(factor, tuple) else plain(factor.parts)
        flat += [negative(first) if signed else first, *others]
        signed = False
    return tuple(flat)


def negative(a: Matrix) -> Matrix:
    """Return -A."""
    return tuple(negate(row) for row in a)


def negated(chain: Chain) -> Chain:
    """A chain whose product is the negative."""
    first = chain[0]
    if isinstance(first, tuple):
        return (negative(first), *chain[1:])
    return (Sign(len(plain((first,))[0])), *chain)


def is_identity(a: Matrix | Factor) -> bool:
    """Whether a factor is I, as structure."""
    if not isinstance(a, tuple) or not all(is_structural(x) for row in a for x in row):
        return False
    return bool(a) and a == eye(len(a))


#: How a function of two matrices is called: ``once(f, a, b)`` is ``f(a, b)``.
Once = Callable[[Callable[[Matrix, Matrix], Any], Matrix, Matrix], Any]


def called(f: Callable[[Matrix, Matrix], Any], a: Matrix, b: Matrix) -> Any:
    """Return f(a, b)."""
    return f(a, b)


@dataclass(frozen=True, eq=False)
class Remembered:
    """Results by function and matrices (the same objects): what was asked before is not computed again."""

    known: dict[tuple[Any, int, int], tuple[Any, Matrix, Matrix]]

    def __call__(self, f: Callable[[Matrix, Matrix], Any], a: Matrix, b: Matrix) -> Any:
        """Return f(a, b)."""
        key = f, id(a), id(b)
        found = self.known.get(key)
        if found is None:
            found = self.known[key] = f(a, b), a, b  # both are held, so that no identity comes again
        return found[0]


def product_from_left(chain: Chain, once: Once = called) -> Matrix:
    """Multiply a chain out from the left."""
    return reduce(partial(once, matmul), plain(chain))


def product_from_right(chain: Chain, once: Once = called) -> Matrix:
    """Multiply a chain out from the right."""
    return reduce(lambda total, factor: once(matmul, factor, total), reversed(plain(chain)))


def product(chain: Chain, once: Once = called) -> Matrix:
    """Multiply a chain out, at each step where it costs least (leftmost first among equals)."""
    factors = list(plain(chain))
    costs = [once(multiply_cost, a, b) for a, b in pairwise(factors)]
    while costs:
        k = costs.index(min(costs))
        factors[k : k + 2] = [once(matmul, factors[k], factors[k + 1])]
        del costs[k]
        for i in (k - 1, k):
            if 0 <= i < len(costs):
                costs[i] = once(multiply_cost, factors[i], factors[i + 1])
    return factors[0]
