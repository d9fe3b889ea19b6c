"""Statements 6 to 11 of the seed documents' facts ("Frames and adjoints"); each test cites its number."""

import numpy as np
import pytest
import uncertainty_reference as ref
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation
from uncertainty_reference import bound, close, draw, misfit, spd

from liegen import uncertainty
from liegen.library import (
    between_r3,
    between_se2,
    between_se3,
    between_so2,
    between_so3,
    prior_se2,
    prior_se3,
    projection_cal3_s2,
)
from liegen.manifolds import R3, SE2, SE3, SO2, SO3, Cal3_S2

BETWEEN = {R3: between_r3, SO2: between_so2, SE2: between_se2, SO3: between_so3, SE3: between_se3}
N = 20_000
groups = pytest.mark.parametrize("G", ref.GROUPS, ids=lambda G: G.__name__)
curved = pytest.mark.parametrize("G", [SE2, SO3, SE3], ids=lambda G: G.__name__)
poses = pytest.mark.parametrize("G", [SE2, SE3], ids=lambda G: G.__name__)
#: A step that turns by 1 rad and moves by 6 m; standard deviations of 0.02 rad and 0.05 m.
STEP = {SE2: [4.0, -4.5, 1.0], SE3: [0.6, -0.5, 0.6, 4.0, -3.0, 3.3]}
SIGMAS = {SE2: [0.05, 0.05, 0.02], SE3: [0.02] * 3 + [0.05] * 3}


def rng():
    return np.random.default_rng(ref.SEED)


def elements(G, *, scale=0.7, count=3):
    source = np.random.default_rng(ref.SEED + 1)
    return [G.exp(d) for d in source.normal(size=(count, G.form.dim)) * scale]


def inverse(M):
    return np.linalg.inv(M)


# --- 6 ------------------------------------------------------------------------------------------------------


@poses
def test_6_inner_indices_cancel(G):
    """Statement 6: T_WB^-1 = T_BW, T_AB T_BC = T_AC, on the coordinates of one point; T_AB T_CB is wrong."""
    space = 2 if G is SE2 else 3
    T_WA, T_WB, T_WC = elements(G)
    p_C = rng().normal(size=space)

    def in_frame(T, p_W):
        """Coordinates of a world point along the axes of a body: their definition."""
        M = T.matrix()
        return [M[:space, k] @ (p_W - M[:space, space]) for k in range(space)]

    p_W = T_WC.matrix()[:space] @ [*p_C, 1.0]
    T_AB, T_BC = T_WA.between(T_WB), T_WB.between(T_WC)
    close(in_frame(T_WC, p_W), p_C, 1e-14)
    close(T_WB.inverse() @ p_W, in_frame(T_WB, p_W), 1e-14)
    close(T_AB @ (T_BC @ p_C), in_frame(T_WA, p_W), 1e-14)
    close((T_AB @ T_BC) @ p_C, in_frame(T_WA, p_W), 1e-14)
    close((T_AB @ T_BC).matrix(), T_WA.between(T_WC).matrix(), 1e-14)
    T_CB = T_WC.between(T_WB)
    assert np.max(np.abs(np.asarray((T_AB @ T_CB) @ p_C) - in_frame(T_WA, p_W))) > 0.1


# --- 7 ------------------------------------------------------------------------------------------------------


@poses
def test_7_right_and_left_hand_conventions_are_one_motion(G):
    """Statement 7: T_W,i+1 = T_W,i dT and T_i+1,W = dT^-1 T_i,W, with dT = T_i,i+1."""
    T_Wi, T_Wj, _ = elements(G)
    dT = T_Wi.between(T_Wj)
    close((T_Wi @ dT).matrix(), T_Wj.matrix(), 1e-14)
    close((dT.inverse() @ T_Wi.inverse()).matrix(), inverse(T_Wj.matrix()), 1e-14)
    assert np.max(np.abs((dT @ T_Wi).matrix() - T_Wj.matrix())) > 0.1
    assert np.max(np.abs((T_Wi.inverse() @ dT.inverse()).matrix() - inverse(T_Wj.matrix()))) > 0.1


def test_7_projection_uses_the_inverse_of_the_camera_pose():
    """Statement 7: pixels = K (T_WC)^-1 p_W, with K to pixels; T_WC itself gives other pixels."""
    fx, fy, s, u0, v0 = 410.0, 400.0, 0.7, 320.0, 240.0
    K = np.array([[fx, s, u0], [0, fy, v0], [0, 0, 1]])
    T_WC = SE3.exp([0.3, -0.2, 0.4, 0.5, -0.3, 0.2])
    for p_C in ([0.4, -0.7, 3.0], [-1.0, 0.2, 5.0]):
        p_W = (T_WC.matrix() @ [*p_C, 1.0])[:3]
        homogeneous = K @ (inverse(T_WC.matrix()) @ [*p_W, 1.0])[:3]
        pixels = homogeneous[:2] / homogeneous[2]
        given = {"K": Cal3_S2.from_storage([fx, fy, s, u0, v0]), "z": pixels - [1.5, -2.0]}
        close(projection_cal3_s2(T_WC, p_W, **given), [1.5, -2.0], 1e-12)
        assert np.max(np.abs(np.asarray(projection_cal3_s2(T_WC.inverse(), p_W, **given)) - [1.5, -2.0])) > 10


# --- 8 ------------------------------------------------------------------------------------------------------


@groups
def test_8_the_adjoint_moves_a_twist_through_an_element(G):
    """Statement 8: T Exp(xi) = Exp(Ad_T xi) T for large xi; Ad_ab = Ad_a Ad_b; Ad_{a^-1} = Ad_a^-1."""
    a, b, c = elements(G)
    xi = np.asarray(c.log())
    A = a.matrix()
    close(A @ ref.exp(G, xi), ref.exp(G, a.adjoint() @ xi) @ A, 1e-13)
    close(a.adjoint(), ref.adjoint(G, A), 1e-14)
    product = a.compose(b).adjoint()
    close(product, ref.adjoint(G, A) @ ref.adjoint(G, b.matrix()), 1e-14)
    close(a.inverse().adjoint(), np.linalg.inv(ref.adjoint(G, A)), 1e-13)
    if G not in (R3, SO2):
        assert np.max(np.abs(product - b.adjoint() @ a.adjoint())) > 0.1


def test_8_adjoint_of_se3_rotation_first():
    """Statement 8: [[R, 0], [[t]x R, R]]."""
    R, t = Rotation.from_rotvec([0.5, -1.0, 0.3]), np.array([1.0, -2.0, 3.0])
    T = SE3.from_storage([*R.as_quat(), *t])
    M = R.as_matrix()
    want = np.zeros((6, 6))
    want[:3, :3] = want[3:, 3:] = M
    want[3:, :3] = np.cross(t, M.T).T  # columns t x R e_k
    close(T.adjoint(), want, 4e-15)


def test_8_adjoint_of_se2_translation_first():
    """Statement 8: [[R, (t_y, -t_x)], [0, 1]]."""
    c, s, x, y = np.cos(0.7), np.sin(0.7), 2.0, -3.0
    close(SE2.from_storage([c, s, x, y]).adjoint(), [[c, -s, y], [s, c, -x], [0, 0, 1]], 4e-16)


# --- 9 ------------------------------------------------------------------------------------------------------


@groups
def test_9_odometry_residual_is_the_noise(G):
    """Statement 9: T_i+1 = T_i dT Exp(n) gives the residual n; noise in B_i gives Ad(dT^-1) n."""
    Ti, dT, _ = elements(G)
    for n in rng().normal(size=(4, G.form.dim)) * 0.5:
        after = G.exp(n)
        close(BETWEEN[G](Ti, Ti.compose(dT).compose(after), z=dT), n, 1e-13)
        in_i = BETWEEN[G](Ti, Ti.compose(after).compose(dT), z=dT)
        close(in_i, dT.inverse().adjoint() @ n, 1e-13)
        if G not in (R3, SO2):
            assert np.max(np.abs(np.asarray(in_i) - n)) > 0.05


@poses
def test_9_odometry_noise_is_in_the_frame_of_the_next_body(G):
    """Statement 9: sampled with n in B_i+1 the residuals have the covariance S, with n in B_i by far not."""
    S = spd(G.form.dim, rng(), SIGMAS[G])
    Ti, dT = elements(G)[0].matrix(), ref.exp(G, STEP[G])
    n = ref.exp(G, draw(S, rng(), N))

    def residuals(T_next):
        return ref.log(G, inverse(dT) @ inverse(Ti) @ T_next)

    assert misfit(residuals(Ti @ dT @ n), S) < bound(N)
    slip = residuals(Ti @ n @ dT)
    assert misfit(slip, S) > 20 * bound(N)
    assert misfit(slip, uncertainty.world_to_body(G.exp(STEP[G]), S)) < bound(N)


# --- 10 -----------------------------------------------------------------------------------------------------

TWIST = {SE2: [4.0, 1.0, 1.0], SE3: [0.5, -0.6, 0.7, 4.0, 1.0, -1.5]}


@groups
def test_10_dead_reckoning_is_exact_for_a_constant_twist(G):
    """Statement 10: 50 steps of T <- T Exp(twist dt) are one exponential of 1 s."""
    twist = np.asarray(TWIST.get(G, [0.8, -0.5, 0.4][: G.form.dim]))
    start = elements(G)[0]
    track = uncertainty.dead_reckoning(start, np.tile(twist, (50, 1)), 0.02)
    assert track.covariances is None
    close(track.poses.matrix()[0], start.matrix(), 0)
    close(track.poses.matrix()[-1], start.matrix() @ ref.exp(G, twist), 1e-14)
    middle = start.matrix() @ ref.exp(G, twist * 0.02 * 17)
    close(track.poses.matrix()[17], middle, 1e-14)


@poses
def test_10_the_decoupled_retraction_is_centimetres_off(G):
    """Statement 10: T <- (R Exp(w dt), t + R v dt) is off by centimetres after 1 s in the same test."""
    twist, T = np.asarray(TWIST[G]), np.eye(3 if G is SE2 else 4)
    k = len(T) - 1
    turn = np.asarray(twist)
    turn = np.concatenate([np.zeros(2), turn[2:]]) if G is SE2 else np.concatenate([turn[:3], np.zeros(3)])
    v = twist[:2] if G is SE2 else twist[3:]
    for _ in range(50):
        t = T[:k, k] + T[:k, :k] @ v * 0.02
        T = T @ ref.exp(G, turn * 0.02)
        T[:k, k] = t
    off = np.linalg.norm(T[:k, k] - ref.exp(G, twist)[:k, k])
    assert 0.03 < off < 0.07
    exact = uncertainty.dead_reckoning(G.identity(), np.tile(twist, (50, 1)), 0.02).poses.matrix()[-1]
    assert np.linalg.norm(exact[:k, k] - ref.exp(G, twist)[:k, k]) < 1e-14 * 4


@poses
def test_10_dead_reckoning_propagates_the_covariance(G):
    """Statement 10: the covariance after varying twists, against integrating noisy velocities many times."""
    n, steps, dt = G.form.dim, 8, np.linspace(0.1, 0.3, 8)
    r = rng()
    twists = r.normal(size=(steps, n))
    start, noise = spd(n, r, 0.5 * np.array(SIGMAS[G])), spd(n, r, 2 * np.array(SIGMAS[G])[::-1])
    T = elements(G)[1]
    track = uncertainty.dead_reckoning(T, twists, dt, start=start, noise=noise)
    M = T.matrix() @ ref.exp(G, draw(start, r, N))
    for twist, t in zip(twists, dt, strict=True):
        M = M @ ref.exp(G, (twist + draw(noise, r, N)) * t)
    final = track.poses.matrix()[-1]
    errors = ref.log(G, inverse(final) @ M)
    assert misfit(errors, track.covariances[-1]) < bound(N)
    assert misfit(ref.log(G, M @ inverse(final)), track.covariances[-1]) > 20 * bound(N)
    # without the twist's noise
    plain = start
    for twist, t in zip(twists, dt, strict=True):
        A = ref.adjoint(G, inverse(ref.exp(G, twist * t)))
        plain = A @ plain @ A.T
    assert misfit(errors, plain) > 10 * bound(N)


@groups
def test_10_one_step_of_dead_reckoning_is_a_composition(G):
    """Statement 10: with dt = 1 s and noise Q the step is `of_compose` with Jr Q Jr^T."""
    S, Q, d = spd(G.form.dim, rng()), spd(G.form.dim, rng(), np.full(G.form.dim, 0.1)), elements(G)[0].log()
    track = uncertainty.dead_reckoning(G.identity(), [np.asarray(d)], 1.0, start=S, noise=Q)
    step = uncertainty.propagate(G.Jr(d), Q)
    close(track.covariances[1], uncertainty.of_compose(G.exp(d), S, step), 1e-14)
    known = uncertainty.dead_reckoning(G.identity(), [np.asarray(d)], 1.0, noise=Q)
    close(known.covariances[0], np.zeros_like(S), 0)
    close(known.covariances[1], step, 1e-15)


# --- 11 -----------------------------------------------------------------------------------------------------


@poses
def test_11_update_of_a_variable_is_its_retract(G):
    """Statement 11: x <- x.retract(d), d from the linearised prior, lands on z."""
    prior = {SE2: prior_se2, SE3: prior_se3}[G]
    z = G.exp(STEP[G])
    right = left = z.compose(G.exp(np.full(G.form.dim, 0.4)))
    for _ in range(6):
        at, other = prior.jacobians(right, z=z), prior.jacobians(left, z=z)
        right = right.retract(-np.linalg.solve(at["res_D_x"], at["res"]))
        left = G.exp(-np.linalg.solve(other["res_D_x"], other["res"])).compose(left)
    assert np.max(np.abs(right.matrix() - z.matrix())) < 1e-14
    assert np.max(np.abs(left.matrix() - z.matrix())) > 1e-3


@poses
def test_11_covariance_of_the_inverse(G):
    """Statement 11: Ad_T S Ad_T^T, against inverted samples; S and Ad^-1 S Ad^-T miss by far."""
    T, S = G.exp(STEP[G]), spd(G.form.dim, rng(), SIGMAS[G])
    inverted = inverse(T.matrix() @ ref.exp(G, draw(S, rng(), N)))
    errors = ref.log(G, T.matrix() @ inverted)
    assert misfit(errors, uncertainty.of_inverse(T, S)) < bound(N)
    assert misfit(errors, S) > 20 * bound(N)
    assert misfit(errors, uncertainty.world_to_body(T, S)) > 20 * bound(N)
    close(uncertainty.of_inverse(T.inverse(), uncertainty.of_inverse(T, S)), S, 1e-14)


@poses
def test_11_covariance_of_a_composition(G):
    """Statement 11: Ad(T12^-1) S1 Ad(T12^-1)^T + S12, against composed samples, correlated or not."""
    n, r = G.form.dim, rng()
    T1, T12 = elements(G)[0], G.exp(STEP[G])
    S = spd(2 * n, r, SIGMAS[G] * 2)
    for whole in (S, block_diag(S[:n, :n], S[n:, n:])):
        e = draw(whole, r, N)
        T2 = T1.matrix() @ ref.exp(G, e[:, :n]) @ T12.matrix() @ ref.exp(G, e[:, n:])
        errors = ref.log(G, inverse(T1.matrix() @ T12.matrix()) @ T2)
        cross = whole[:n, n:] if whole is S else None
        assert misfit(errors, uncertainty.of_compose(T12, whole[:n, :n], whole[n:, n:], cross)) < bound(N)
        assert misfit(errors, whole[:n, :n] + whole[n:, n:]) > 10 * bound(N)
        wrong = uncertainty.of_compose(T12.inverse(), whole[:n, :n], whole[n:, n:], cross)
        assert misfit(errors, wrong) > 10 * bound(N)
    dropped = uncertainty.of_compose(T12, S[:n, :n], S[n:, n:])
    assert misfit(errors, dropped) < bound(N)


@poses
def test_11_relative_pose_needs_the_cross_terms(G):
    """Statement 11: the odometry's covariance comes back from two poses of a track, with cross terms only."""
    n, r = G.form.dim, rng()
    T1, T12 = elements(G)[0], G.exp(STEP[G])
    S1, S12 = spd(n, r, SIGMAS[G]), spd(n, r, np.array(SIGMAS[G]) / 2)
    # n2 = Ad(T12^-1) n1 + n12, to first order
    A = ref.adjoint(G, inverse(T12.matrix()))
    S2, cross = A @ S1 @ A.T + S12, S1 @ A.T
    whole = uncertainty.joint(S1, S2, cross)
    relative = uncertainty.of_between(T12, whole)
    close(relative / np.max(S12), S12 / np.max(S12), 1e-12)
    without = uncertainty.of_between(T12, uncertainty.joint(S1, S2))
    assert np.trace(without) > 7 * np.trace(relative)
    # and by sampling two poses with this joint distribution
    e = draw(whole, r, N)
    M1, M2 = T1.matrix() @ ref.exp(G, e[:, :n]), (T1.matrix() @ T12.matrix()) @ ref.exp(G, e[:, n:])
    errors = ref.log(G, inverse(T12.matrix()) @ inverse(M1) @ M2)
    assert misfit(errors, without) > 20 * bound(N)
    small = draw(1e-4 * whole, r, N)  # where second-order terms do not matter beside the difference
    M1, M2 = T1.matrix() @ ref.exp(G, small[:, :n]), (T1.matrix() @ T12.matrix()) @ ref.exp(G, small[:, n:])
    assert misfit(ref.log(G, inverse(T12.matrix()) @ inverse(M1) @ M2), 1e-4 * relative) < bound(N)
