"""Expressions that the tests of passes lower: sums and products of eight symbols, rotations."""

import itertools

import casadi as ca

from liegen.program import Port
from liegen.program.lower import lower
from liegen.program.passes import (
    optimise,
)


def optimised(program):
    return optimise(program)[0]


X = [ca.SX.sym(n) for n in "abcdefgh"]


def lowered(*expressions, requirements=()):
    ports = [(Port("p", (8,)), X)], [(Port("r", (len(expressions),)), list(expressions))]
    return lower("f", *ports, requirements)


def counts(*expressions):
    return optimised(lowered(*expressions)).op_counts()


def product(p, q):
    x, y, z, w = p
    i, j, k, r = q
    return [
        w * i + x * r + y * k - z * j,
        w * j - x * k + y * r + z * i,
        w * k + x * j - y * i + z * r,
        w * r - x * i - y * j - z * k,
    ]


def conjugate(q):
    return [-q[0], -q[1], -q[2], q[3]]


def rotation(q):
    x, y, z, w = q
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def times(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def rotation_times(negated):
    """The entries of plus or minus R(q) R(p)."""
    flat = list(itertools.chain(*times(rotation(X[:4]), rotation(X[4:]))))
    return [-entry for entry in flat] if negated else flat
