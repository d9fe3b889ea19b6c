"""The samples of `check-jacobian`: a Jacobian that is wrong at special points only is not called correct."""

import numpy as np
import pytest

from liegen import R3, SE3, factor, library
from liegen.errors import DefinitionError
from liegen.foreign import compare
from liegen.foreign.calls import Foreign

PRIOR = library.prior_so3


def prior(change):
    """The exact Jacobian, with a change that knows the arguments and the residual."""

    def call(arguments):
        x, z = arguments
        J = PRIOR.jacobians(x, z=z)
        return J["res"], change(J["res_D_x"].copy(), J["res"], x, z)

    return compare(PRIOR, Foreign(call)).findings[1]


def angle(r):
    return np.linalg.norm(r)


def where(condition, value):
    """The Jacobian with other entries where the condition holds."""

    def change(J, r, x, z):
        return np.where(condition(r, x, z), value(J), J)

    return change


def without_column(J):
    J = J.copy()
    J[:, 2] = 0
    return J


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        (where(lambda r, x, z: angle(r) < 0.01, np.zeros_like),
         "correct, except where the rotation angle of res is below 0.01 rad: there all entries are 0"),
        (where(lambda r, x, z: angle(r) < 0.2, without_column),
         "correct, except where the rotation angle of res is below 0.2 rad: "
         "there only column 2 (rz [rad]) is 0"),
        (where(lambda r, x, z: angle(r) < 1e-7, lambda J: J * np.nan),
         "correct, except where the rotation angle of res is below 1e-07 rad: there all entries are NaN"),
        (where(lambda r, x, z: angle(r) == 0, lambda J: J * np.nan),
         "correct, except where the rotation angle of res is 0: there all entries are NaN"),
        (where(lambda r, x, z: angle(r) > np.pi - 1e-4, lambda J: J * np.nan),
         "correct, except where the rotation angle of res is within 0.001 rad of half a turn: "
         "there all entries are NaN"),
        (where(lambda r, x, z: angle(x[:3]) < 1e-9, lambda J: -J),
         "correct, except where the rotation angle of x is 0: there all entries are of the opposite sign"),
        (where(lambda r, x, z: (x[:3] == 0).sum() == 2, lambda J: 3 * J),
         "x turned about an axis"),
        (where(lambda r, x, z: x[3] < 0 or z[3] < 0, lambda J: 2 * J), "2 times the right value"),
    ],
    ids=("small", "a column", "NaN", "NaN at zero", "half a turn", "identity", "on an axis", "negated"),
)  # fmt: skip
def test_what_is_wrong_at_special_points_is_told(change, verdict):
    finding = prior(change)
    assert not finding.correct
    assert verdict in finding.verdict


def test_an_exception_at_a_special_point_is_told():
    from liegen.foreign.returned import RaisedError

    def call(arguments):
        J = PRIOR.jacobians(arguments[0], z=arguments[1])
        if angle(J["res"]) < 1e-9:
            raise RaisedError("mine raised ZeroDivisionError: float division")
        return J["res"], J["res_D_x"]

    res, by_x = compare(PRIOR, Foreign(call)).findings
    assert (
        res.verdict
        == "correct, except where the rotation angle of res is 1e-12 or less: there all entries are NaN"
    )
    assert "(it raised: mine raised ZeroDivisionError: float division)" in by_x.sample


@factor
def plane(T: SE3, *, p: R3, n: R3):
    from liegen import dot

    return dot(n, T.transform_from(p))


@pytest.mark.parametrize("column", range(6))
def test_wrong_everywhere_is_not_called_wrong_away_from_zero(column):
    def call(arguments):
        T, p, n = arguments
        J = plane.jacobians(T, p=p, n=n)
        by_T = J["res_D_T"].copy()
        by_T[0, column] *= 2
        return J["res"], by_T

    finding = compare(plane, Foreign(call)).findings[1]
    assert not finding.correct_at_zero
    assert f"only entry [0, {column}] " in finding.verdict
    assert "is 2 times the right value, at all random samples" in finding.verdict


@pytest.mark.parametrize("entry", [(0, 0), (2, 5), (5, 1)])
def test_one_wrong_entry_is_named(entry):
    between = library.between_se3

    def call(arguments):
        x, y, z = arguments
        J = between.jacobians(x, y, z=z)
        by_y = J["res_D_y"].copy()
        by_y[entry] += 1e-5  # the bound is 1e-7
        return J["res"], J["res_D_x"], by_y

    *others, by_y = compare(between, Foreign(call)).findings
    assert all(f.correct for f in others)
    assert f"only entry [{entry[0]}, {entry[1]}]" in by_y.verdict
    assert by_y.entry == entry


def test_the_worst_sample_counts_and_not_the_mean():
    between, calls = library.between_r3, []

    def call(arguments):
        J = [a.copy() for a in between.jacobians(arguments[0], arguments[1], z=arguments[2]).values()]
        calls.append(1)
        if len(calls) == 5:
            J[1][0, 0] += 1e-6
        return tuple(J)

    assert not compare(between, Foreign(call), samples=1000).findings[1].correct


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.inf, np.nan])
def test_a_tolerance_is_a_number_above_zero(tolerance):
    with pytest.raises(DefinitionError, match="the tolerance is a number above 0"):
        compare(PRIOR, Foreign(lambda a: ()), tolerance=tolerance)


def test_a_jump_allows_either_side():
    """At half a turn both logarithms are right, and the Jacobian that belongs to each."""

    def call(arguments):
        x, z = arguments
        J = PRIOR.jacobians(x, z=z)
        if angle(J["res"]) > np.pi - 1e-9:
            return -J["res"], PRIOR.jacobians(x, z=z)["res_D_x"].T  # Jr^-1(-r) = Jr^-1(r)^T
        return J["res"], J["res_D_x"]

    assert compare(PRIOR, Foreign(call)).passed
