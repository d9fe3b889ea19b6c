"""The contract of every group and manifold. A new group adds one line to GROUPS and its generators."""

import itertools

import casadi as ca
import mpmath
import numpy as np
import pytest
import sympy
from scipy.linalg import expm

from liegen.manifolds import (
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SE23,
    SO2,
    SO3,
    Cal3_S2,
    Cal3Bundler,
    Cal3DS2,
    Gal3,
    NavState,
    Product,
    Sim2,
    Sim3,
)


class Posed(Product):
    """A product of groups is a group."""

    pose: SE3
    vel: R3
    offset: R2


def unit(n, *entries):
    m = np.zeros((n, n))
    for i, j, v in entries:
        m[i, j] = v
    return m


# hat(e_k) of each tangent coordinate, from the definition of the matrix group
SPIN = [[(2, 1, 1), (1, 2, -1)], [(0, 2, 1), (2, 0, -1)], [(1, 0, 1), (0, 1, -1)]]
GROUPS = {
    R2: [unit(3, (k, 2, 1)) for k in range(2)],
    R3: [unit(4, (k, 3, 1)) for k in range(3)],
    SO2: [unit(2, (1, 0, 1), (0, 1, -1))],
    SE2: [unit(3, (0, 2, 1)), unit(3, (1, 2, 1)), unit(3, (1, 0, 1), (0, 1, -1))],
    SO3: [unit(3, *s) for s in SPIN],
    SE3: [unit(4, *s) for s in SPIN] + [unit(4, (k, 3, 1)) for k in range(3)],
    SE23: [unit(5, *s) for s in SPIN] + [unit(5, (k, c, 1)) for c in (3, 4) for k in range(3)],
}
GROUPS[NavState] = GROUPS[SE23]
GROUPS[Gal3] = [
    *(unit(5, *s) for s in SPIN),
    *(unit(5, (k, c, 1)) for c in (4, 3) for k in range(3)),
    unit(5, (3, 4, 1)),
]
GROUPS[Sim2] = [*GROUPS[SE2], unit(3, (0, 0, 1), (1, 1, 1))]
GROUPS[Sim3] = [*GROUPS[SE3], unit(4, *((k, k, 1) for k in range(3)))]
GROUPS[Posed] = [
    np.pad(E, (start, 11 - start - len(E)))
    for part, start in ((SE3, 0), (R3, 4), (R2, 8))
    for E in GROUPS[part]
]
#: The tangent's rotation coordinates, and the number of stored numbers that make a unit rotation.
SPINS = {SO2: ([0], 2), SE2: ([2], 2), Sim2: ([2], 2)}
SPINS |= dict.fromkeys((SO3, SE3, SE23, NavState, Gal3, Sim3, Posed), ([0, 1, 2], 4))
ANGLES = (0.0, 1e-160, 1e-12, 1e-6, 1e-3, 0.3, 1.0, 1.7320508, 2.9, np.pi - 1e-3, np.pi - 1e-9)

group = pytest.mark.parametrize("G", GROUPS, ids=lambda G: G.__name__)


def hat(G, d):
    return sum(x * E for x, E in zip(d, GROUPS[G], strict=True))


def tangents(G, seed=0, angles=ANGLES):
    rng = np.random.default_rng(seed)
    for angle in angles:
        d = rng.normal(size=G.form.dim) * 2
        k, _ = SPINS.get(G, ([], 0))
        if k:
            d[k] *= angle / np.linalg.norm(d[k])
        yield d


def elements(G, seed=0, n=8):
    rng = np.random.default_rng(seed)
    return [G.exp(d) for d in rng.normal(size=(n, G.form.dim))]


def close(a, b, tolerance=4e-15):
    a, b = np.asarray(a, float), np.asarray(b, float)
    assert np.max(np.abs(a - b)) <= tolerance * max(1.0, np.max(np.abs(b))), (a, b)


@group
def test_exp_is_the_matrix_exponential(G):
    for d in tangents(G):
        with mpmath.workdps(30):
            exact = np.array(mpmath.expm(mpmath.matrix(hat(G, d))).tolist(), float)
        close(G.exp(d).matrix(), exact, 4e-15)


@group
def test_products_are_products_of_matrices(G):
    for a, b in itertools.pairwise(elements(G)):
        close(a.compose(b).matrix(), a.matrix() @ b.matrix(), 1e-14)
        close(a.inverse().matrix(), np.linalg.inv(a.matrix()), 1e-13)
        close(a.between(b).matrix(), np.linalg.inv(a.matrix()) @ b.matrix(), 1e-13)
        close(a.compose(G.identity()).matrix(), a.matrix())
    assert G.identity().matrix() == pytest.approx(np.eye(len(GROUPS[G][0])), abs=0)


@group
def test_log_inverts_exp(G):
    for d in tangents(G):
        close(G.exp(d).log(), d, 1e-14)


@group
def test_adjoint_moves_a_tangent_vector_through_the_element(G):
    for a, d in zip(elements(G), tangents(G), strict=False):
        M = a.matrix()
        close(hat(G, a.adjoint() @ d), M @ hat(G, d) @ np.linalg.inv(M), 1e-13)


@group
def test_jacobians_of_exp_against_differences_of_the_matrix_exponential(G):
    """exp(d + e) = exp(d) exp(Jr e) = exp(Jl e) exp(d), by complex steps through scipy's expm."""
    for d in tangents(G, angles=(0.0, 1e-9, 1e-3, 0.5, 2.0, 3.1, 4.5)):
        right, left = np.zeros((2, G.form.dim, G.form.dim))
        M = np.linalg.inv(expm(hat(G, d)))
        for k in range(G.form.dim):
            step = np.zeros(G.form.dim, complex)
            step[k] = 1e-30j
            slope = expm(hat(G, d + step)).imag / 1e-30
            right[:, k], left[:, k] = vee(G, M @ slope), vee(G, slope @ M)
        close(G.Jr(d), right, 2e-13)
        close(G.Jl(d), left, 2e-13)
        close(G.Jr_inv(d), np.linalg.inv(right), 2e-12)
        close(G.Jl_inv(d), np.linalg.inv(left), 2e-12)


def vee(G, m):
    basis = np.stack([E.ravel() for E in GROUPS[G]], axis=1)
    return np.linalg.lstsq(basis, m.ravel(), rcond=None)[0]


@group
def test_local_inverts_retract_and_is_left_invariant(G):
    for a, d in zip(elements(G), tangents(G), strict=False):
        b = a.retract(d)
        close(a.local(b), d, 3e-14)
        close(G.identity().local(a.between(b)), d, 3e-14)
        close(a.compose(G.identity().retract(d)).matrix(), b.matrix(), 1e-14)


@group
def test_one_definition_runs_on_every_scalar(G):
    """Floats, batches, mpmath at 50 digits and CasADi give one value."""
    ds = list(tangents(G, angles=(0.0, 1e-3, 1.0, 2.5)))
    other = elements(G, seed=3, n=1)[0]
    batch = np.asarray(G.exp(np.array(ds[1])).compose(other).log())

    def chain(d):
        return G.form.log(G.form.compose(G.form.exp(d), other.coords))

    names = [ca.SX.sym(f"d{k}") for k in range(G.form.dim)]
    compiled = ca.Function("f", names, [ca.vertcat(*chain(names))])
    stacked = chain(tuple(np.array(ds).T))
    for k, d in enumerate(ds):
        single = [float(x) for x in chain(tuple(d))]
        with mpmath.workdps(50):
            exact = [float(x) for x in chain([mpmath.mpf(x) for x in d])]
        close(single, exact, 2e-14)
        close(compiled.call(list(d))[0].full().ravel() if G.form.dim == 1 else
              np.ravel(np.array(ca.vertcat(*compiled.call(list(d))))), exact, 2e-14)  # fmt: skip
        close([np.broadcast_to(x, (len(ds),))[k] for x in stacked], exact, 2e-14)
    close(batch, [float(x) for x in chain(tuple(ds[1]))])


@group
def test_mpmath_keeps_fifty_digits(G):
    with mpmath.workdps(50):
        for d in tangents(G, angles=(1e-160, 1e-20, 1e-3, 1.0, 3.1)):
            exact = [mpmath.mpf(x) for x in d]
            back = G.form.log(G.form.exp(exact))
            assert max(abs(a - b) for a, b in zip(back, exact, strict=True)) < mpmath.mpf(10) ** -46


@group
def test_jacobians_are_inverses_to_fifty_digits(G):
    with mpmath.workdps(50):
        for d in tangents(G, angles=(0.0, 1e-160, 1e-20, 1e-9, 1e-3, 1.0, 3.1)):
            exact = [mpmath.mpf(x) for x in d]
            product = mpmath.matrix(G.form.Jr(exact)) * mpmath.matrix(G.form.Jr_inv(exact))
            assert mpmath.mnorm(product - mpmath.eye(G.form.dim)) < mpmath.mpf(10) ** -45


@pytest.mark.parametrize("G", SPINS, ids=lambda G: G.__name__)
def test_identities_proved_in_sympy(G):
    """R^T R = s^2 I, Ad(ab) = Ad(a) Ad(b), a a^-1 = 1, for all elements: polynomials modulo |q|^2 = 1."""

    def element(name):
        return sympy.symbols([f"{name}{s}" for s in G.form.storage], real=True)

    a, b = element("a"), element("b")
    n = SPINS[G][1]
    units = [sum(x * x for x in q[:n]) - 1 for q in (a, b)]
    scale = a[-1] if G in (Sim2, Sim3) else 1
    cleared = (a[-1] * b[-1]) ** 2 if G in (Sim2, Sim3) else 1  # of the scales that inverses divide by

    def zero(matrix):
        return all(sympy.reduced(sympy.expand(x * cleared), units, *a, *b)[1] == 0 for x in matrix)

    def ad(x):
        return sympy.Matrix(G.form.adjoint_matrix(x))

    k = 2 if n == 2 else 3
    R = sympy.Matrix(G.form.matrix(a))[:k, :k]
    assert zero(R.T * R - scale**2 * sympy.eye(k))
    assert zero(ad(G.form.compose(a, b)) - ad(a) * ad(b))
    assert zero(ad(G.form.inverse(a)) * ad(a) - sympy.eye(G.form.dim))
    product = sympy.Matrix(G.form.matrix(G.form.compose(a, G.form.inverse(a))))
    assert zero(product - sympy.eye(product.rows))


def test_zero_is_not_proved_for_a_wrong_identity():
    """The proof above can fail: Ad(ab) is not Ad(b) Ad(a)."""
    a = sympy.symbols("a:4")
    R = sympy.Matrix(SO3.form.matrix(a))
    assert sympy.reduced(sympy.expand((R * R - sympy.eye(3))[0]), [sum(x * x for x in a) - 1], *a)[1] != 0


@pytest.mark.parametrize("angle", [np.pi, np.pi - 1e-12])
def test_log_at_half_a_turn_follows_the_stored_sign(angle):
    q = SO3.from_storage([np.sin(angle / 2), 0.0, 0.0, np.cos(angle / 2)])
    close(q.log(), [angle, 0, 0])
    minus = SO3.holding([-c for c in q.coords])
    close(minus.log(), [angle, 0, 0])
    close(SO3.from_storage([-1.0, 0.0, 0.0, 0.0]).log(), [-np.pi, 0, 0])
    close(SO3.from_storage([-1.0, 0.0, 0.0, -0.0]).log(), [-np.pi, 0, 0])


def test_sphere_chart_and_basis():
    rng = np.random.default_rng(0)
    for _ in range(50):
        n = S2.direction(rng.normal(size=3))
        d = rng.normal(size=2)
        d *= rng.uniform(0, 3.1) / np.linalg.norm(d)
        m = n.retract(d)
        close(np.linalg.norm(m), 1.0)
        close(np.dot(np.asarray(n), np.asarray(m)), np.cos(np.linalg.norm(d)), 1e-14)
        close(n.local(m), d, 2e-14 / np.sin(np.linalg.norm(d)))
    # the axis with the smallest component; ties x, y, z (GTSAM's Unit3)
    from liegen.manifolds.s2_form import basis

    for n in ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.48, 0.6, 0.64]):
        axis = np.eye(3)[int(np.argmin(np.abs(n)))]
        b1 = np.cross(n, axis) / np.linalg.norm(np.cross(n, axis))
        close(basis(n), [b1, np.cross(n, b1)])


def test_sphere_antipode_is_half_a_turn():
    n = S2.direction([0.0, 0.0, 1.0])
    close(n.local(S2.direction([0.0, 0.0, -1.0])), [np.pi, 0.0])
    close(n.local(n), [0.0, 0.0])


@pytest.mark.parametrize("K", [Cal3_S2, Cal3DS2, Cal3Bundler], ids=lambda K: K.__name__)
def test_calibrations_move_by_addition(K):
    k = K.from_storage(np.arange(1.0, 1 + K.form.size))
    d = np.arange(K.form.dim) * 0.5 + 0.25
    close(k.local(k.retract(d)), d)
    assert k.retract(d).coords[K.form.dim :] == k.coords[K.form.dim :]


def test_calibrations_against_their_definition():
    x, y = 0.3, -0.2
    r2 = x * x + y * y
    fx, fy, s, u0, v0, k1, k2, p1, p2 = 400.0, 410.0, 0.5, 320.0, 240.0, 0.1, -0.02, 1e-3, -2e-3
    plain = Cal3_S2.from_storage([fx, fy, s, u0, v0])
    close(plain.uncalibrate([x, y]), [fx * x + s * y + u0, fy * y + v0])
    g = 1 + k1 * r2 + k2 * r2**2
    xd = g * x + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    yd = g * y + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    brown = Cal3DS2.from_storage([fx, fy, s, u0, v0, k1, k2, p1, p2])
    close(brown.uncalibrate([x, y]), [fx * xd + s * yd + u0, fy * yd + v0])
    bundler = Cal3Bundler.from_storage([fx, k1, k2, u0, v0])
    close(bundler.uncalibrate([x, y]), [u0 + fx * g * x, v0 + fx * g * y])


@pytest.mark.parametrize("P", [SE2, SE3], ids=lambda P: P.__name__)
def test_poses_move_points(P):
    n = 2 if P is SE2 else 3
    rng = np.random.default_rng(1)
    for T in elements(P):
        p = rng.normal(size=n)
        moved = (T.matrix() @ [*p, 1.0])[:n]
        close(T.transform_from(p), moved, 1e-14)
        close(T @ p, moved, 1e-14)
        close(T.transform_to(moved), p, 2e-14)
        close(T.rotation @ p, T.matrix()[:n, :n] @ p, 1e-14)
        close(T.rotation.unrotate(p), T.matrix()[:n, :n].T @ p, 1e-14)
        close(P(T.rotation, T.translation).matrix(), T.matrix())
        close(float(T.range(p)), np.linalg.norm(p - np.asarray(T.translation)), 1e-15)
        q = np.asarray(T.transform_to(p))
        close((T.bearing(p)).local(type(T.bearing(p)).direction(q)), np.zeros(n - 1))
