"""Statements 1 to 5 of the seed documents' facts ("Noise"), each a test that cites its number."""

import mpmath
import numpy as np
import pytest
import uncertainty_reference as ref
from scipy.linalg import eigvalsh
from scipy.stats import multivariate_normal
from uncertainty_reference import bound, close, draw, misfit, spd

from liegen import uncertainty
from liegen.library import (
    between_r3,
    between_se2,
    between_se3,
    between_so2,
    between_so3,
    prior_r3,
    prior_se2,
    prior_se3,
    prior_so2,
    prior_so3,
)
from liegen.manifolds import R3, SE2, SE3, SO2, SO3

PRIOR = {R3: prior_r3, SO2: prior_so2, SE2: prior_se2, SO3: prior_so3, SE3: prior_se3}
BETWEEN = {R3: between_r3, SO2: between_so2, SE2: between_se2, SO3: between_so3, SE3: between_se3}
N = 20_000
groups = pytest.mark.parametrize("G", ref.GROUPS, ids=lambda G: G.__name__)
poses = pytest.mark.parametrize("G", [SE2, SE3], ids=lambda G: G.__name__)
#: A measurement that turns by 1 rad and moves by 6 m, and standard deviations of 0.03 rad and 0.05 m.
MEASURED = {SE2: [4.0, -4.5, 1.0], SE3: [0.6, -0.5, 0.6, 4.0, -3.0, 3.3]}
SIGMAS = {SE2: [0.05, 0.05, 0.03], SE3: [0.03] * 3 + [0.05] * 3}


def rng():
    return np.random.default_rng(ref.SEED)


def elements(G, *, scale=0.7, count=3):
    source = np.random.default_rng(ref.SEED + 1)
    return [G.exp(d) for d in source.normal(size=(count, G.form.dim)) * scale]


def batch(G, matrices):
    """Typed values from matrices, through the storage's definition."""
    M = np.asarray(matrices)
    k = 2 if G is SE2 else 3
    R, t = M[..., :k, :k], M[..., :k, k]
    if G is SE2:
        return G.from_storage(np.stack([R[..., 0, 0], R[..., 1, 0], t[..., 0], t[..., 1]], axis=-1))
    quaternion = ref.Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat().reshape(*R.shape[:-2], 4)
    return G.from_storage(np.concatenate([quaternion, t], axis=-1))


# --- 1 ------------------------------------------------------------------------------------------------------


@groups
def test_1_error_is_the_squared_mahalanobis_distance(G):
    """Statement 1: e = h^T S^-1 h; half of it is the negative log density (and GTSAM's value)."""
    n = G.form.dim
    S, h = spd(n, rng(), np.geomspace(0.01, 3, n)), rng().normal(size=(5, n))
    e = uncertainty.squared_error(h, S)
    close(e, [x @ np.linalg.inv(S) @ x for x in h], 1e-12)
    density = multivariate_normal(np.zeros(n), S)
    close(e / 2, density.logpdf(np.zeros(n)) - density.logpdf(h), 1e-12)
    whitened = uncertainty.whiten(h, S)
    close(np.sum(whitened**2, axis=-1), e, 1e-15)


@poses
def test_1_covariance_is_in_the_frame_of_the_measurement(G):
    """Statement 1: the mean of e over measured residuals is n with S in the frame of z, and in no other."""
    z, x = G.exp(MEASURED[G]), elements(G)[0]
    S = spd(G.form.dim, rng(), SIGMAS[G])
    y = batch(G, x.matrix() @ z.matrix() @ ref.exp(G, draw(S, rng(), N)))
    h = np.asarray(BETWEEN[G](x, y, z=z))
    n, spread = G.form.dim, 5 * np.sqrt(2 * G.form.dim / N)
    assert abs(np.mean(uncertainty.squared_error(h, S)) - n) < spread
    in_x = uncertainty.body_to_world(z, S)
    assert abs(np.mean(uncertainty.squared_error(h, in_x)) - n) > 20 * spread


# --- 2 ------------------------------------------------------------------------------------------------------


@groups
def test_2_prior_residual_and_its_first_order(G):
    """Statement 2: h = Log(z^-1 x); about x0, h(x0 Exp d) = h + Jr^-1(h) d + O(d^2), which is d at x0 = z."""
    z, x0, step = elements(G)
    d = step.log()
    Z, X = z.matrix(), x0.matrix()
    at = PRIOR[G].jacobians(x0, z=z)
    close(at["res"], ref.log(G, np.linalg.inv(Z) @ X), 1e-13)
    close(at["res_D_x"], G.Jr_inv(at["res"]), 1e-13)

    def left_over(size, about, h, J):
        v = size * np.asarray(d)
        return np.linalg.norm(ref.log(G, np.linalg.inv(Z) @ about @ ref.exp(G, v)) - (h + J @ v))

    ratio = left_over(1e-2, X, at["res"], at["res_D_x"]), left_over(5e-3, X, at["res"], at["res_D_x"])
    if G in (R3, SO2):
        assert max(ratio) < 1e-14
    else:
        assert 3.7 < ratio[0] / ratio[1] < 4.3
        assert left_over(1e-2, X, at["res"], np.eye(G.form.dim)) > 10 * ratio[0]  # Jr^-1 cannot be left out
    near = PRIOR[G].jacobians(z, z=z)
    close(near["res_D_x"], np.eye(G.form.dim), 1e-15)
    assert left_over(0.5, Z, near["res"], near["res_D_x"]) < 1e-14  # exact at z: h(z Exp d) = d


@groups
def test_2_prior_jacobian_against_differences_in_fifty_digits(G):
    """Statement 2: dh/dd = Jr^-1(h), from expm and logm alone."""
    d0, h = rng().normal(size=(2, G.form.dim)) * 0.6
    z, x = G.exp(d0), G.exp(d0).compose(G.exp(h))
    with mpmath.workdps(40):
        E = mpmath.inverse(ref.mp_exp(G, d0)) * ref.mp_exp(G, d0) * ref.mp_exp(G, h)
        J = ref.slopes(lambda d: ref.mp_log(G, E * ref.mp_exp(G, d)), G.form.dim)
    close(PRIOR[G].jacobians(x, z=z)["res_D_x"], J, 1e-14)


@poses
def test_2_samples_have_their_covariance_in_the_body_frame(G):
    """Statement 2: x = z Exp(d), d ~ N(0, S); S misses by far in the world and in the tangent at 1."""
    z, S = G.exp(MEASURED[G]), spd(G.form.dim, rng(), SIGMAS[G])
    X = uncertainty.sample(z, S, rng(), N).matrix()
    Z = z.matrix()
    body = ref.log(G, np.linalg.inv(Z) @ X)
    assert misfit(body, S) < bound(N)
    world = ref.log(G, X @ np.linalg.inv(Z))
    assert misfit(world, S) > 20 * bound(N)
    assert misfit(world, uncertainty.body_to_world(z, S)) < bound(N)
    assert misfit(body, uncertainty.body_to_world(z, S)) > 20 * bound(N)
    assert misfit(ref.log(G, X) - np.asarray(z.log()), S) > 10 * bound(N)


# --- 3 ------------------------------------------------------------------------------------------------------


@groups
def test_3_between_is_zero_where_x1_z_is_x2(G):
    """Statement 3: h = Log(z^-1 x1^-1 x2), zero when x1 z = x2 (and not when z x1 = x2)."""
    x1, x2, z = elements(G)
    want = ref.log(G, np.linalg.inv(z.matrix()) @ np.linalg.inv(x1.matrix()) @ x2.matrix())
    close(BETWEEN[G](x1, x2, z=z), want, 1e-13)
    close(BETWEEN[G](x1, x1 @ z if G is not R3 else x1 + z, z=z), np.zeros(G.form.dim), 1e-15)
    if G not in (R3, SO2):
        assert np.linalg.norm(BETWEEN[G](x1, z @ x1, z=z)) > 0.1


@groups
def test_3_a_step_of_x1_seen_from_the_residual(G):
    """Statement 3: z^-1 (x1 Exp d)^-1 x2 = E Exp(-Ad(x2^-1 x1) d) = Exp(-Ad(z^-1) d) E, also for large d."""
    x1, x2, z = elements(G)
    X1, X2, Zi = x1.matrix(), x2.matrix(), np.linalg.inv(z.matrix())
    E = Zi @ np.linalg.inv(X1) @ X2
    for d in rng().normal(size=(5, G.form.dim)):
        moved = Zi @ np.linalg.inv(X1 @ ref.exp(G, d)) @ X2
        close(E @ ref.exp(G, -x2.between(x1).adjoint() @ d), moved, 1e-13)
        close(ref.exp(G, -z.inverse().adjoint() @ d) @ E, moved, 1e-13)
        if G not in (R3, SO2):
            assert np.max(np.abs(E @ ref.exp(G, -z.inverse().adjoint() @ d) - moved)) > 1e-2


@groups
def test_3_jacobians_of_between(G):
    """Statement 3: dh/dx1 = -Jr^-1(h) Ad(x2^-1 x1) = -Jl^-1(h) Ad(z^-1), dh/dx2 = Jr^-1(h)."""
    d1, d2, dz = rng().normal(size=(3, G.form.dim)) * 0.5
    x1, x2, z = G.exp(d1), G.exp(d2), G.exp(dz)
    at = BETWEEN[G].jacobians(x1, x2, z=z)
    h = at["res"]
    close(at["res_D_x"], -G.Jr_inv(h) @ x2.between(x1).adjoint(), 4e-15)
    close(at["res_D_x"], -G.Jl_inv(h) @ z.inverse().adjoint(), 1e-14)
    close(at["res_D_y"], G.Jr_inv(h), 4e-15)
    with mpmath.workdps(40):
        X1, X2, Zi = ref.mp_exp(G, d1), ref.mp_exp(G, d2), mpmath.inverse(ref.mp_exp(G, dz))

        def residual(d, e):
            return ref.mp_log(G, Zi * mpmath.inverse(X1 * ref.mp_exp(G, d)) * X2 * ref.mp_exp(G, e))

        none = [0] * G.form.dim
        close(at["res_D_x"], ref.slopes(lambda d: residual(d, none), G.form.dim), 2e-14)
        close(at["res_D_y"], ref.slopes(lambda e: residual(none, e), G.form.dim), 2e-14)


@poses
def test_3_x1_fixed_noise_is_in_the_body_frame_of_x2(G):
    """Statement 3: with x1 fixed the marginal of x2 has the covariance S in the body frame of x2."""
    x1, z = elements(G)[0], G.exp(MEASURED[G])
    S = spd(G.form.dim, rng(), SIGMAS[G])
    x2 = x1 @ z
    J = BETWEEN[G].jacobians(x1, x2, z=z)["res_D_y"]
    close(uncertainty.posterior(J, S), S, 1e-13)
    drawn = (x1 @ uncertainty.sample(z, S, rng(), N)).matrix()
    assert misfit(ref.log(G, np.linalg.inv(x2.matrix()) @ drawn), S) < bound(N)
    assert misfit(ref.log(G, drawn @ np.linalg.inv(x2.matrix())), S) > 20 * bound(N)


@groups
def test_3_x2_fixed_is_a_step_of_minus_ad_z_n(G):
    """Statement 3: x2 = x1 z Exp(n) with x2 fixed gives x1 = (x2 z^-1) Exp(-Ad_z n), exactly, for any n."""
    x2, z, _ = elements(G)
    X2, Z = x2.matrix(), z.matrix()
    for n in rng().normal(size=(5, G.form.dim)):
        x1 = X2 @ np.linalg.inv(Z @ ref.exp(G, n))
        close(X2 @ np.linalg.inv(Z) @ ref.exp(G, -z.adjoint() @ n), x1, 1e-13)


@poses
def test_3_x2_fixed_the_open_question(G):
    """Statement 3: x1 is N(0, Ad_z S Ad_z^T) in its own body frame; S is off by a factor above 10."""
    x2, z = elements(G)[0], G.exp(MEASURED[G])
    S = spd(G.form.dim, rng(), SIGMAS[G])
    x1 = x2 @ z.inverse()
    seen = uncertainty.of_inverse(z, S)
    close(seen, ref.adjoint(G, z.matrix()) @ S @ ref.adjoint(G, z.matrix()).T, 4e-15)
    # the factor's marginal: x2 held by a prior that is a million times tighter
    at = BETWEEN[G].jacobians(x1, x2, z=z)
    n = G.form.dim
    A = np.block([[at["res_D_x"], at["res_D_y"]], [np.zeros((n, n)), np.eye(n)]])
    marginal = uncertainty.posterior(A, uncertainty.block_diagonal(S, 1e-12 * S))[:n, :n]
    close(marginal, seen, 1e-10)
    assert np.max(eigvalsh(marginal, S)) > 10  # ratio of variances in the direction where it is largest
    # and by sampling: draw x2's relative pose, solve for x1
    X1 = x2.matrix() @ np.linalg.inv(z.matrix() @ ref.exp(G, draw(S, rng(), N)))
    steps = ref.log(G, np.linalg.inv(x1.matrix()) @ X1)
    assert misfit(steps, seen) < bound(N)
    assert misfit(steps, S) > 20 * bound(N)


# --- 4 ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("G", "rotation"), [(SE3, [0, 1, 2]), (SE2, [2])], ids=["SE3", "SE2"])
def test_4_order_of_the_covariance_is_that_of_the_tangent(G, rotation):
    """Statement 4: Pose3 rotation first, Pose2 translation first: in samples, residuals and Jacobians."""
    n = G.form.dim
    for k in range(n):
        variances = np.full(n, 1e-16)
        variances[k] = 0.25
        M = uncertainty.sample(G.identity(), np.diag(variances), rng(), 200).matrix()
        space = 2 if G is SE2 else 3
        turned = np.max(np.abs(M[:, :space, :space] - np.eye(space)))
        moved = np.max(np.abs(M[:, :space, space]))
        if k in rotation:
            assert turned > 0.1
            assert moved < 1e-6
        else:
            assert moved > 0.1
            assert turned < 1e-6
        d = np.zeros(n)
        d[k] = 0.3
        close(PRIOR[G](batch(G, ref.exp(G, d)), z=G.identity()), d, 1e-15)


@pytest.mark.parametrize("G", [SE2, SE3], ids=lambda G: G.__name__)
def test_4_reordering_to_and_fro(G):
    """Statement 4: the other order is a permutation of rows and columns, of unequal blocks in the plane."""
    names = {SE2: ["x", "y", "a"], SE3: ["a", "b", "c", "x", "y", "z"]}[G]
    turn, move = [[k for k in names if k in s] for s in ("abc", "xyz")]
    S = spd(len(names), rng())
    table = {(i, j): S[names.index(i), names.index(j)] for i in names for j in names}
    for order, wanted in (("rotation-first", turn + move), ("translation-first", move + turn)):
        got = uncertainty.to_order(G, S, order)
        assert np.array_equal(got, [[table[i, j] for j in wanted] for i in wanted])
        assert np.array_equal(uncertainty.from_order(G, got, order), S)
        assert np.array_equal(uncertainty.to_order(G, np.stack([S, 2 * S]), order)[1], 2 * got)


# --- 5 ------------------------------------------------------------------------------------------------------


@poses
def test_5_posterior_lives_in_the_body_frame_of_the_estimate(G):
    """Statement 5: (A^T S^-1 A)^-1 is the covariance of n in x_true = xhat Exp(n): many problems solved."""
    n, count = G.form.dim, 4000
    truth, anchor = G.exp(MEASURED[G]), elements(G)[1]
    relative = anchor.between(truth)
    S = uncertainty.block_diagonal(
        1e-2 * spd(n, rng(), SIGMAS[G]), 1e-2 * spd(n, np.random.default_rng(3), np.array(SIGMAS[G])[::-1])
    )
    noise = draw(S, rng(), count)
    z1 = batch(G, truth.matrix() @ ref.exp(G, -noise[:, :n]))
    z2 = batch(G, relative.matrix() @ ref.exp(G, -noise[:, n:]))

    def linearise(x):
        prior, between = PRIOR[G].jacobians(x, z=z1), BETWEEN[G].jacobians(anchor, x, z=z2)
        h = np.concatenate([prior["res"], between["res"]], axis=-1)
        return h, np.concatenate([prior["res_D_x"], between["res_D_y"]], axis=-2)

    x, information = truth, np.linalg.inv(S)
    for _ in range(4):
        h, A = linearise(x)
        gradient = np.swapaxes(A, -1, -2) @ information
        step = -np.linalg.solve(gradient @ A, gradient @ h[..., None])[..., 0]
        x = x.retract(type(G.identity().log()).from_storage(step))
    assert np.max(np.abs(step)) < 1e-12
    predicted = uncertainty.posterior(np.vstack([np.eye(n), np.eye(n)]), S)
    body = ref.log(G, np.linalg.inv(x.matrix()) @ truth.matrix())
    assert misfit(body, predicted) < bound(count)
    assert misfit(ref.log(G, truth.matrix() @ np.linalg.inv(x.matrix())), predicted) > 10 * bound(count)
    # at each estimate the linearised one differs from it by the residual only
    h, A = linearise(x)
    close(uncertainty.posterior(A, S)[0] / np.max(predicted), predicted / np.max(predicted), 0.02)
    close(uncertainty.posterior(A, sqrt_info=uncertainty.sqrt_info(S)), uncertainty.posterior(A, S), 1e-15)


def test_5_posterior_is_the_inverse_of_the_information():
    """Statement 5: against (A^T S^-1 A)^-1 multiplied out in fifty digits, for a badly scaled problem."""
    A = rng().normal(size=(9, 4)) * [1e4, 1.0, 1e-3, 1.0]
    S = spd(9, rng(), np.geomspace(1e-3, 10, 9))
    with mpmath.workdps(50):
        exact = mpmath.inverse(
            mpmath.matrix(A.tolist()).T
            * mpmath.inverse(mpmath.matrix(S.tolist()))
            * mpmath.matrix(A.tolist())
        )
        want = np.array([[float(exact[i, j]) for j in range(4)] for i in range(4)])
    scale = np.sqrt(np.diag(want))
    close(uncertainty.posterior(A, S) / np.outer(scale, scale), want / np.outer(scale, scale), 1e-12)
