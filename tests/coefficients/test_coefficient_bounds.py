"""The promised bounds, densely, with the angle as the exact argument; the references are power series.

The square that the functions get is theta * theta, rounded, or 0 where that underflows.
"""

import coefficient_reference as ref
import numpy as np
import pytest

from liegen.coefficients import inverse_jacobian, log_factor, stumpff, tables

mp = ref.mp
RANDOM = np.random.default_rng(4711)
#: 1e-162 squared is the first that underflows to 0, 1e-160 squared is denormal.
TINY = [0.0, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-200, 1e-162, 1e-160, 1e-155, 1e-150, 1e-100, 1e-30, 1e-17]
EPSILON = 2.0**-52
DENSE = [1_500, pytest.param(15_000, marks=pytest.mark.slow)]


def angles(high, count):
    near = ref.around(
        2.0**-30, tables.STUMPFF3_END**0.5, tables.STUMPFF5_END**0.5, *np.pi * np.array([0.5, 1, 1.5, 2])
    )
    evenly = high * RANDOM.random(count)
    theta = np.concatenate([TINY, near, evenly, 10.0 ** RANDOM.uniform(-17, 0, count // 3)])
    return theta[theta <= high]


def squared(theta, digits=ref.DIGITS):
    with mp.workdps(digits):
        return ref.exact(theta) ** 2


@ref.at_digits
def c(k, theta):
    s = ref.exact(theta) ** 2
    return mp.hyp1f2(1, mp.mpf(k + 1) / 2, mp.mpf(k + 2) / 2, -s / 4) / mp.factorial(k)


@ref.at_digits
def conditioning(k, theta):
    """The largest change of c_k between theta and half a unit in the last place to either side of it."""
    t, half = ref.exact(theta), ref.exact(np.spacing(theta)) / 2

    def value(x):
        return mp.hyp1f2(1, mp.mpf(k + 1) / 2, mp.mpf(k + 2) / 2, -x * x / 4) / mp.factorial(k)

    return float(max(abs(value(t + half) - value(t)), abs(value(t - half) - value(t))))


@ref.at_digits
def far(theta):
    """(c_0, ..., c_5) at a large angle, a double or an mpmath number, where the recurrence loses nothing."""
    t = mp.mpf(theta)
    values = [mp.cos(t), mp.sin(t) / t]
    for k in range(4):
        values.append((1 / mp.factorial(k) - values[k]) / t**2)
    return values


@pytest.mark.parametrize("count", DENSE)
def test_stumpff_to_2_pi(count):
    """4 ulp, and what half a unit in the last place of theta makes of c_k."""
    theta = angles(2 * np.pi, count)
    exact = [[c(k, t) for t in theta] for k in range(6)]
    for upto in (1, 3, 5):
        for k, values in enumerate(stumpff(theta * theta, upto)):
            error, unit = ref.error(values, exact[k]), ref.ulp(exact[k])
            for i in np.flatnonzero(~(error <= 4 * unit)):
                assert error[i] <= 4 * unit[i] + conditioning(k, theta[i]), (k, upto, theta[i])


@pytest.mark.parametrize("count", DENSE)
def test_stumpff_beyond_2_pi(count):
    """c_0, c_1, c_2: absolute error times theta^k at most 4 * 2^-52. c_3, c_4, c_5: as up to 2 pi."""
    theta = np.concatenate(
        [10.0 ** RANDOM.uniform(np.log10(2 * np.pi), 6, count), RANDOM.uniform(2 * np.pi, 60, count)]
    )
    exact = list(zip(*map(far, theta.tolist()), strict=True))
    for upto in (1, 3, 5):
        for k, values in enumerate(stumpff(theta * theta, upto)):
            error = ref.error(values, exact[k])
            if k <= 2:
                assert np.max(error * theta**k) <= 4 * EPSILON, (k, upto)
                continue
            slope = np.array([float(a - k * b) for a, b in zip(exact[k - 1], exact[k], strict=True)]) / theta
            allowed = 4 * ref.ulp(exact[k]) + np.abs(slope) * np.spacing(theta) / 2
            assert np.all(error <= allowed), (k, upto)


@pytest.mark.parametrize("principal", [True, False])
@pytest.mark.parametrize("count", [700, pytest.param(5_000, marks=pytest.mark.slow)])
def test_inverse_jacobian_to_pi(count, principal):
    """4 ulp for D, 8 for its derivative E."""
    theta = angles(np.pi, count)
    for values, f, bound in zip(
        inverse_jacobian(theta * theta, principal), (ref.d, ref.e), (4, 8), strict=True
    ):
        exact = [f(squared(t)) for t in theta]
        assert np.all(ref.error(values, exact) <= bound * ref.ulp(exact))


@pytest.mark.parametrize("count", DENSE)
def test_log_factor(count):
    w = np.cos(angles(np.pi, count) / 2)
    exact = [ref.log_factor(x) for x in w]
    assert np.all(ref.error(log_factor(w), exact) <= 4 * ref.ulp(exact))


@pytest.mark.parametrize("theta", TINY)
def test_at_tiny_angles_the_limits_are_exact(theta):
    for s in (theta * theta, np.array([theta * theta])):
        for upto in (1, 3, 5):
            assert [float(np.squeeze(v)) for v in stumpff(s, upto)] == [1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120][
                : upto + 1
            ]
        for principal in (True, False):
            assert [float(np.squeeze(v)) for v in inverse_jacobian(s, principal)] == [1 / 12, 1 / 360]
    assert log_factor(np.cos(theta / 2)) == 2.0


def test_the_root_of_a_rounded_square_is_the_angle():
    """Why an exact angle costs c_0, c_1, c_2 no conditioning: sqrt(theta * theta) is theta."""
    theta = np.concatenate([10.0 ** RANDOM.uniform(-150, 150, 200_000), RANDOM.uniform(0, 100, 200_000)])
    np.testing.assert_array_equal(np.sqrt(theta * theta), theta)


@pytest.mark.parametrize("k", [3, 4, 5])
def test_no_double_keeps_the_scaled_bound_for_c3_to_c5(k):
    """Even the double nearest to c_k is off by more than 4 * 2^-52 / theta^k at most large angles."""
    theta = np.linspace(40, 400, 300)
    exact = [far(t)[k] for t in theta.tolist()]
    nearest = ref.error([float(x) for x in exact], exact) * theta**k
    assert np.mean(nearest > 4 * EPSILON) > 0.5


@pytest.mark.parametrize("k", [0, 1, 2])
def test_no_rounded_angle_keeps_the_scaled_bound(k):
    """Half a unit in the last place of theta alone moves c_0, c_1, c_2 by more than 4 * 2^-52 / theta^k."""
    theta = np.linspace(64, 400, 300)
    with mp.workdps(ref.DIGITS):
        beside = [ref.exact(t) + ref.exact(np.spacing(t)) / 2 for t in theta]
        moved = [float(abs(far(t)[k] - far(x)[k])) for t, x in zip(theta.tolist(), beside, strict=True)]
    assert np.mean(np.array(moved) * theta**k > 4 * EPSILON) > 0.5
