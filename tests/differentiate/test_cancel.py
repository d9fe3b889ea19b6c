"""What cancels in chains: how many factors are left, that the product stays, and what it saves."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from liegen import SE3, Chart, function
from liegen.algebra.factors import Adjoint, Turn
from liegen.algebra.linear import eye, matscale, plain, product_from_left
from liegen.charts import PRESETS
from liegen.differentiate import expressions
from liegen.differentiate.cancel import cancelled
from liegen.differentiate.elements import elements
from liegen.library import between_se3, prior_se3, range_se3_r3

AT = (
    np.array([0.1, -0.7, 0.1, 0.7, 1.0, 2.0, -3.0]),
    np.array([0.5, 0.5, -0.5, 0.5, -2.0, 0.3, 1.0]),
)


@function
def relative(x: SE3, y: SE3):
    return x.between(y)


VALUES = expressions(relative.graph)
KNOWN = elements(relative.graph.nodes(), VALUES.scalars)
X, Y = VALUES.inputs["x"], VALUES.inputs["y"]
C = VALUES.scalars[id(relative.graph.outputs[0][1])]
FORM, R = SE3.form, SE3.form.rotation


def turn(coords, *, inverse=False):
    word = (R.letter(coords[:4], inverse=inverse),)
    return FORM.turn(word, word)


LEVER = FORM.lever(X, Y[4:], tuple(ca.mtimes(ca.SX(ca.vertcat(*(ca.horzcat(*r) for r in R.matrix(X[:4])))),
                                             ca.vertcat(*Y[4:])).nonzeros()))  # fmt: skip
#: By rule: the chain, and how many images are left in it.
CHAINS = {
    "Ad(c^-1) Ad(x^-1) = Ad(y^-1)": ((*FORM.Ad_inverse(C), *FORM.Ad_inverse(X)), 1),
    "Ad(c) Ad(c^-1) = I": ((*FORM.Ad(C), *FORM.Ad_inverse(C)), 0),
    "Ad(x) Ad(c) = Ad(y)": ((*FORM.Ad(X), *FORM.Ad(C)), 1),
    "R(c) R(y)^T = R(x)^T": ((turn(C), turn(Y, inverse=True)), 1),
    "passing a choice of parts": ((*R.turned(X[:4]), eye(6)[3:], turn(X, inverse=True)), 0),
    "passing a scaled order": (
        (turn(X), matscale(2, (*eye(6)[3:], *eye(6)[:3])), turn(X, inverse=True)),
        0,
    ),
    "passing a lever": ((*R.turned(X[:4]), *LEVER, turn(X, inverse=True)), 0),
    "splitting an adjoint": ((turn(C), *FORM.Ad_inverse(C)), 0),
    "nothing to cancel": ((*FORM.Ad_inverse(C), *FORM.Ad(Y)), 2),
}  # fmt: skip


def number(chain):
    matrix = product_from_left(chain)
    entries = ca.vertcat(*(ca.SX(e) for row in matrix for e in row))
    f = ca.Function("f", [ca.vertcat(*X), ca.vertcat(*Y)], [entries])
    return np.array(f(*AT)).reshape(len(matrix), -1)


@pytest.mark.parametrize("name", CHAINS)
def test_the_product_stays_and_the_images_cancel(name):
    chain, left = CHAINS[name]
    short = cancelled(chain, KNOWN)
    assert sum(isinstance(f, Turn | Adjoint) for f in short) == left
    np.testing.assert_allclose(number(short), number(chain), atol=1e-14)


def test_a_chain_that_cancels_is_the_identity():
    assert plain(cancelled((*FORM.Ad(C), *FORM.Ad_inverse(C)), KNOWN)) == (eye(6),)


def test_rotations_do_not_pass_what_mixes_axes():
    mixing = tuple(tuple(int(j == (i + 1) % 6) for j in range(6)) for i in range(6))
    assert len(cancelled((turn(X), mixing, turn(X, inverse=True)), KNOWN)) == 3


def test_rotations_do_not_pass_a_sum_of_parts():
    """The rows (I, I) add two parts, which turn by themselves."""
    both = tuple(tuple(int(j % 3 == i) for j in range(6)) for i in range(3))
    chain = (*R.turned(X[:4]), both, turn(X, inverse=True))
    short = cancelled(chain, KNOWN)
    assert len(short) == len(chain)
    np.testing.assert_allclose(number(short), number(chain), atol=1e-14)


def test_rotations_pass_a_lever_of_their_own_element_alone():
    """Of another pose than the lever's, they stay behind the lever."""
    chain = (*R.turned(X[:4]), *LEVER, turn(Y, inverse=True))
    short = cancelled(chain, KNOWN)
    assert len(short) == len(chain)
    np.testing.assert_allclose(number(short), number(chain), atol=1e-14)


def test_rotations_that_do_not_cancel_do_not_pass():
    order = (*eye(6)[3:], *eye(6)[:3])
    chain = (turn(X), order, turn(Y))
    assert cancelled(chain, KNOWN) == chain


@pytest.mark.parametrize("name", PRESETS)
def test_no_preset_costs_more_than_the_default(name):
    for f in (between_se3, prior_se3, range_se3_r3):
        assert f.in_chart(name).kernel.jacobians.operations <= f.kernel.jacobians.operations


def test_a_coupled_left_chart_costs_one_product_more():
    # the residual's Jl^-1 times Ad(x^-1), of which the default needs half, and takes as one operation
    left = between_se3.in_chart(Chart(side="left")).kernel.jacobians.operations
    assert left == 475
    assert between_se3.kernel.jacobians.operations == 412
