"""Statement 12 of the seed documents' facts: retractions and charts beside the exponential."""

import numpy as np
import pytest
import uncertainty_reference as ref
from scipy.linalg import block_diag
from uncertainty_reference import bound, close, draw, misfit, spd

from liegen import uncertainty
from liegen.library import between_se2, between_se3, prior_se2, prior_se3
from liegen.manifolds import SE2, SE3

BETWEEN = {SE2: between_se2, SE3: between_se3}
poses = pytest.mark.parametrize("G", [SE2, SE3], ids=lambda G: G.__name__)
#: A pose turned by 1 rad, so that the world's axes are not the body's.
TURNED = {SE2: [4.0, -4.5, 1.0], SE3: [0.6, -0.5, 0.6, 4.0, -3.0, 3.3]}


def rng():
    return np.random.default_rng(ref.SEED)


def elements(G, *, scale=0.7, count=3):
    source = np.random.default_rng(ref.SEED + 1)
    return [G.exp(d) for d in source.normal(size=(count, G.form.dim)) * scale]


def inverse(M):
    return np.linalg.inv(M)


def parts(G, x):
    k = 2 if G is SE2 else 3
    return k, x[:k, :k], x[:k, k]


def joined(R, t):
    k = len(t)
    M = np.eye(k + 1)
    M[:k, :k], M[:k, k] = R, t
    return M


def split(G, d):
    """(translation, rotation padded to a tangent vector)."""
    d = np.asarray(d, float)
    return (d[:2], np.array([0, 0, d[2]])) if G is SE2 else (d[3:], np.concatenate([d[:3], np.zeros(3)]))


def by_exp(G, x, d):
    return x @ ref.exp(G, d)


def by_cayley(G, x, d):
    D = ref.hat(G, d) / 2
    one = np.eye(len(D))
    return x @ np.linalg.solve(one - D, one + D)


def by_parts(G, x, d):
    """Rotation and translation apart, the translation along the body's axes."""
    rho, phi = split(G, d)
    _, R, t = parts(G, x)
    return joined(R @ parts(G, ref.exp(G, phi))[1], t + R @ rho)


def in_world(G, x, d):
    """The translation along the world's axes."""
    rho, phi = split(G, d)
    _, R, t = parts(G, x)
    return joined(R @ parts(G, ref.exp(G, phi))[1], t + rho)


def half_angle(G, x, d):
    """The rotation's coordinates are half angles, as the vector part of a quaternion."""
    rho, phi = split(G, d)
    _, R, t = parts(G, x)
    return joined(R @ parts(G, ref.exp(G, 2 * phi))[1], t + R @ rho)


def on_the_left(G, x, d):
    return ref.exp(G, d) @ x


def body_step(G, retract, x, d):
    """The tangent vector, in the body frame of x, of a step of another chart."""
    return ref.log(G, inverse(x) @ retract(G, x, d))


def columns(f, n, h=1e-5):
    """Fourth-order central differences, about 1e-11."""
    J = []
    for e in np.eye(n) * h:
        J.append((8 * (f(e) - f(-e)) - (f(2 * e) - f(-2 * e))) / (12 * h))
    return np.stack(J, axis=-1)


@poses
@pytest.mark.parametrize("retract", [by_exp, by_cayley, by_parts], ids=lambda f: f.__name__)
def test_12_retractions_with_one_first_order_map_have_one_jacobian(G, retract):
    """Statement 12: exp, Cayley and the body-decoupled retraction give liegen's columns of a residual."""
    x, y, z = elements(G)
    X, n = x.matrix(), G.form.dim
    close(columns(lambda d: body_step(G, retract, X, d), n), np.eye(n), 1e-9)

    def residual(d):
        return ref.log(G, inverse(z.matrix()) @ inverse(retract(G, X, d)) @ y.matrix())

    close(columns(residual, n), BETWEEN[G].jacobians(x, y, z=z)["res_D_x"], 1e-9)


@poses
def test_12_they_differ_at_second_order_at_the_earliest(G):
    """Statement 12: the body-decoupled retraction leaves exp at second order, Cayley at third."""
    X, d = elements(G)[0].matrix(), np.linspace(0.5, 1.0, G.form.dim)

    def gap(retract, size):
        return np.linalg.norm(body_step(G, retract, X, size * d) - size * d)

    for retract, order in ((by_parts, 2), (by_cayley, 3)):
        assert gap(retract, 1e-2) / gap(retract, 5e-3) == pytest.approx(2**order, rel=0.02)
        assert gap(retract, 0.5) > 1e-3


@poses
@pytest.mark.parametrize("retract", [in_world, half_angle, on_the_left], ids=lambda f: f.__name__)
def test_12_charts_with_another_first_order_map_change_the_columns(G, retract):
    """Statement 12: the columns are J M(x): M = diag(I, R^T), diag(2 I, I) by parts, Ad_{x^-1}."""
    x, (y, z) = G.exp(TURNED[G]), elements(G, count=2)
    X, n = x.matrix(), G.form.dim
    R = parts(G, X)[1]
    turn, move = (np.eye(1), np.eye(2)) if G is SE2 else (np.eye(3), np.eye(3))
    blocks = {"in_world": (turn, R.T), "half_angle": (2 * turn, move)}.get(retract.__name__)
    M = block_diag(*blocks[:: 1 if G is SE3 else -1]) if blocks else ref.adjoint(G, inverse(X))
    close(columns(lambda d: body_step(G, retract, X, d), n), M, 1e-9)

    def residual(d):
        return ref.log(G, inverse(z.matrix()) @ inverse(retract(G, X, d)) @ y.matrix())

    J = BETWEEN[G].jacobians(x, y, z=z)["res_D_x"]
    found = columns(residual, n)
    close(found, J @ M, 1e-9)
    assert np.max(np.abs(found - J)) > 0.1
    # a covariance of that chart's steps becomes liegen's by the same map
    S = spd(n, rng(), np.full(n, 1e-3))
    steps = draw(S, rng(), 1000)
    body = np.stack([body_step(G, retract, X, d) for d in steps])
    assert misfit(body, uncertainty.propagate(M, S)) < bound(1000)
    assert misfit(body, S) > 3 * bound(1000)


@poses
def test_12_residuals_of_another_local_differ_at_first_order(G):
    """Statement 12: with the body-decoupled local the Jacobian leaves Jr^-1(h) in proportion to h."""
    z, direction = elements(G)[0], np.linspace(-1.0, 1.5, G.form.dim)
    prior = {SE2: prior_se2, SE3: prior_se3}[G]
    Z = z.matrix()
    _, Rz, tz = parts(G, Z)

    def local(M):
        _, R, t = parts(G, M)
        phi = ref.log(G, joined(Rz.T @ R, 0 * t))
        rho = Rz.T @ (t - tz)
        return np.concatenate([rho, phi[2:]]) if G is SE2 else np.concatenate([phi[:3], rho])

    def gap(size):
        x = z.compose(G.exp(size * direction))
        X = x.matrix()
        other = columns(lambda d: local(X @ ref.exp(G, d)), G.form.dim)
        return np.max(np.abs(other - prior.jacobians(x, z=z)["res_D_x"]))

    assert gap(0.0) < 1e-9
    assert gap(0.02) / gap(0.01) == pytest.approx(2, rel=0.05)
    assert gap(0.01) > 2e-3
