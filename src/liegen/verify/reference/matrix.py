"""Vectors and matrices of mpmath numbers as tuples, and the matrix exponential."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

mp: Any = importlib.import_module("mpmath").mp  # ships no type information
#: A number of mpmath at the working precision.
Number = Any
Vector = tuple[Number, ...]
Matrix = tuple[Vector, ...]
#: A value: a matrix for a group element, a tuple of numbers for anything else, a bool for a condition.
Element = Any


def add(a: Vector, b: Vector) -> Vector:
    """Sum."""
    return tuple(x + y for x, y in zip(a, b, strict=True))


def sub(a: Vector, b: Vector) -> Vector:
    """Difference."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


def scale(k: Number, v: Vector) -> Vector:
    """Multiple."""
    return tuple(k * x for x in v)


def dot(a: Iterable[Number], b: Iterable[Number]) -> Number:
    """Scalar product, rounded once."""
    return mp.fdot(zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    (x, y, z), (u, v, w) = a, b
    return (y * w - z * v, z * u - x * w, x * v - y * u)


def length(v: Vector) -> Number:
    """Euclidean length; mpmath's exponents are unbounded, so nothing under- or overflows."""
    return mp.sqrt(dot(v, v))


def normalised(v: Vector) -> Vector:
    """The unit vector v / |v|; not a number at 0."""
    n = length(v)
    return tuple(x / n for x in v) if n else (mp.nan,) * len(v)


def transpose(a: Matrix) -> Matrix:
    """Transpose."""
    return tuple(zip(*a, strict=True))


def matvec(a: Matrix, v: Vector) -> Vector:
    """Matrix times vector."""
    return tuple(dot(row, v) for row in a)


def matmul(a: Matrix, b: Matrix) -> Matrix:
    """Matrix times matrix."""
    columns = transpose(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def identity(n: int) -> Matrix:
    """The n x n identity."""
    return tuple(tuple(mp.one if i == j else mp.zero for j in range(n)) for i in range(n))


def skew(v: Vector) -> Matrix:
    """[v]x with [v]x p = v x p."""
    x, y, z = v
    return ((mp.zero, -z, y), (z, mp.zero, -x), (-y, x, mp.zero))


def magnitude(a: Matrix) -> Number:
    """The largest sum of absolute values of a row."""
    return max(sum(abs(x) for x in row) for row in a)


_HALVED = -10  # the series runs on a matrix of magnitude below 2**_HALVED


def expm(a: Matrix) -> Matrix:
    """The matrix exponential: Taylor series of a / 2^k, squared k times.

    Tiny matrices are not scaled, so that each entry keeps its relative precision.
    """
    return _expm(a, mp.prec)


@lru_cache(maxsize=4096)  # differences take the same steps again and again
def _expm(a: Matrix, _precision: int) -> Matrix:
    size = magnitude(a)
    if not all(mp.isfinite(x) for row in a for x in row):
        return tuple((mp.nan,) * len(a) for _ in a)
    k = max(0, int(mp.mag(size)) - _HALVED) if size else 0
    result = _taylor(tuple(tuple(mp.ldexp(x, -k) for x in row) for row in a))
    for _ in range(k):
        result = matmul(result, result)
    return result


def _taylor(a: Matrix) -> Matrix:
    term, total, n = a, tuple(add(p, q) for p, q in zip(identity(len(a)), a, strict=True)), 1
    enough = mp.ldexp(magnitude(a), -mp.prec - 10)
    while magnitude(term) > enough:
        n += 1
        term = tuple(tuple(x / n for x in row) for row in matmul(term, a))
        total = tuple(add(p, q) for p, q in zip(total, term, strict=True))
    return total
