"""What makes code generation quick must not show in what is generated."""

from __future__ import annotations

import gc
import operator

import casadi as ca
import numpy as np
import pytest

from liegen.algebra import backend, select
from liegen.algebra.casadi_backend import scalar, symbol
from liegen.algebra.linear import Remembered, matmul, product_from_left, product_from_right
from liegen.bench import formulas
from liegen.choice import Way, entries
from liegen.derive import lowered
from liegen.differentiate import expressions, linearised
from liegen.library import between_se3, projection_cal3_bundler
from liegen.program.lower import alone
from liegen.program.rewrite import uncollected

A, B = symbol("a"), symbol("b")
PLAIN = {"a": ca.SX.sym("a"), "b": ca.SX.sym("b")}


@pytest.mark.parametrize(
    "other", [B, PLAIN["b"], 2, 2.5, np.float64(0.5)], ids=["own", "SX", "int", "float", "NumPy"]
)
@pytest.mark.parametrize("op", [operator.add, operator.sub, operator.mul, operator.truediv])
def test_scalars_build_what_casadi_builds(op, other):
    plain = PLAIN["b"] if other is B else other
    for found, expected in ((op(A, other), op(PLAIN["a"], plain)), (op(other, A), op(plain, PLAIN["a"]))):
        assert type(found) is type(A) or isinstance(other, np.float64)  # NumPy calls CasADi itself
        assert str(found) == str(expected)
        assert found.op() == expected.op()


@pytest.mark.parametrize(
    "name", ["sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "abs", "not"]
)
def test_functions_of_scalars_are_those_of_casadi(name):
    named = {"abs": "fabs", "not": "logic_not"}.get(name, name)
    assert str(backend("casadi").functions[name](A)) == str(getattr(ca, named)(PLAIN["a"]))


def test_a_select_is_that_of_casadi():
    a, b = PLAIN.values()
    assert str(select(A < B, A, 1.0)) == str(ca.if_else(a < b, a, 1.0))
    assert type(select(scalar(1.0), A, 0.0)) is type(A)


@pytest.mark.parametrize(
    "function", [between_se3, projection_cal3_bundler, formulas.imu_step], ids=lambda f: f.name
)
def test_what_is_beside_a_program_changes_nothing(function):
    values = expressions(function.plain)
    blocks = [
        m for local in linearised(function.plain, values) for m in Way(function.plain, values, local).blocks
    ]
    begun = lowered(function.plain, values, {}, beside=entries(blocks))
    assert begun.operations > lowered(function.plain, values, {}).operations
    assert alone(begun) == lowered(function.plain, values, {})
    assert alone(alone(begun)) == alone(begun)


def test_the_same_matrices_are_multiplied_once():
    asked = []

    def counted(a, b):
        asked.append((a, b))
        return matmul(a, b)

    once = Remembered({})
    a, b, c = ((1.0, 2.0), (3.0, 4.0)), ((0, 1.0), (1.0, 0)), ((5.0, 0), (0, 7.0))
    first = once(counted, a, b)
    assert once(counted, a, b) is first
    assert len(asked) == 1
    assert once(counted, b, a) == matmul(b, a) != first
    assert product_from_left((a, b, c), once) == product_from_left((a, b, c))
    assert product_from_right((a, b, c), once) == product_from_right((a, b, c))


def fail():
    with uncollected():
        assert not gc.isenabled()
        with uncollected():
            pass
        assert not gc.isenabled()
        raise KeyError


def test_the_collector_is_as_it_was():
    assert gc.isenabled()
    with pytest.raises(KeyError):
        fail()
    assert gc.isenabled()
