"""Matrix groups from their definitions, with SciPy and mpmath only: nothing of liegen's closed forms."""

import math

import mpmath
import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from liegen.manifolds import R3, SE2, SE3, SO2, SO3

SEED = 20210214


def unit(n, *entries):
    m = np.zeros((n, n))
    for i, j, v in entries:
        m[i, j] = v
    return m


SPIN = [[(2, 1, 1), (1, 2, -1)], [(0, 2, 1), (2, 0, -1)], [(1, 0, 1), (0, 1, -1)]]
#: hat(e_k) for each coordinate of the tangent, in liegen's order
BASIS = {
    R3: np.array([unit(4, (k, 3, 1)) for k in range(3)]),
    SO2: np.array([unit(2, (1, 0, 1), (0, 1, -1))]),
    SE2: np.array([unit(3, (0, 2, 1)), unit(3, (1, 2, 1)), unit(3, (1, 0, 1), (0, 1, -1))]),
    SO3: np.array([unit(3, *s) for s in SPIN]),
    SE3: np.array([unit(4, *s) for s in SPIN] + [unit(4, (k, 3, 1)) for k in range(3)]),
}
GROUPS = list(BASIS)


def hat(G, d):
    return np.einsum("...k,kij->...ij", np.asarray(d, float), BASIS[G])


def exp(G, d):
    """Matrices (..., m, m) of the exponentials of d (..., n): SciPy's, a faster series for many."""
    M = hat(G, d)
    return series(M) if M.size > 10_000 else expm(M)


def series(M):
    """exp(M) of many small matrices: Taylor to M^18, squared six times."""
    M = M / 64
    total, term = np.zeros_like(M) + np.eye(M.shape[-1]), np.zeros_like(M) + np.eye(M.shape[-1])
    for k in range(1, 19):
        term = term @ M / k
        total = total + term
    for _ in range(6):
        total = total @ total
    return total


def vee(G, m):
    """Coordinates of matrices in the Lie algebra."""
    flat = BASIS[G].reshape(len(BASIS[G]), -1)
    return np.asarray(m).reshape(*m.shape[:-2], -1) @ np.linalg.pinv(flat)


def log(G, M):
    """Logarithms (..., n) for rotations below pi: SciPy's rotation vector, V as a power series."""
    M = np.asarray(M)
    if G is R3:
        return M[..., :3, 3]
    planar = G in (SO2, SE2)
    k = 2 if planar else 3
    R = M[..., :k, :k]
    phi = np.arctan2(R[..., 1, 0], R[..., 0, 0])[..., None] if planar else rotation_vector(R)
    if G in (SO2, SO3):
        return phi
    W = hat(SO2 if planar else SO3, phi)
    V, term = np.zeros_like(W) + np.eye(k), np.zeros_like(W) + np.eye(k)
    for j in range(2, 40):
        term = term @ W / j
        V = V + term
    rho = np.linalg.solve(V, M[..., :k, k:])[..., 0]
    return np.concatenate([rho, phi] if planar else [phi, rho], axis=-1)


def rotation_vector(R):
    return Rotation.from_matrix(R.reshape(-1, 3, 3)).as_rotvec().reshape(*R.shape[:-2], 3)


def adjoint(G, M):
    """Ad_M, from its definition: hat(Ad d) = M hat(d) M^-1."""
    return np.stack([vee(G, M @ E @ np.linalg.inv(M)) for E in BASIS[G]], axis=-1)


def mp_exp(G, d):
    total = mpmath.zeros(len(BASIS[G][0]))
    for x, E in zip(d, BASIS[G], strict=True):
        total += mpmath.mpf(x) * mpmath.matrix(E.tolist())
    return mpmath.expm(total, method="taylor")


def mp_log(G, M):
    L = mpmath.logm(M)
    places = [next((i, j) for i in range(len(E)) for j in range(len(E)) if E[i, j] == 1) for E in BASIS[G]]
    return [mpmath.re(L[i, j]) for i, j in places]


def slopes(f, n, h=1e-10):
    """d f(d)/dd at 0 (m x n) by central differences; f takes a list and gives a list, in mpmath."""
    columns = []
    for k in range(n):
        step = [mpmath.mpf(0)] * n
        step[k] = mpmath.mpf(h)
        plus = f(step)
        step[k] = -mpmath.mpf(h)
        minus = f(step)
        columns.append([float((a - b) / (2 * mpmath.mpf(h))) for a, b in zip(plus, minus, strict=True)])
    return np.array(columns).T


def spd(n, rng, sigmas=None):
    """A covariance with strong correlations and the given standard deviations."""
    Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    C = Q @ np.diag(np.geomspace(0.2, 3.0, n)) @ Q.T
    s = np.asarray(sigmas if sigmas is not None else np.ones(n)) / np.sqrt(np.diag(C))
    S = s[:, None] * C * s
    return (S + S.T) / 2


def draw(S, rng, size):
    """n ~ N(0, S) by eigenvectors, not by a triangular root."""
    values, vectors = np.linalg.eigh(S)
    return rng.standard_normal((size, len(S))) @ (vectors * np.sqrt(values)).T


def misfit(samples, S):
    """Largest |log| of the eigenvalues of S^-1 times the second moment: 0 when they agree."""
    values, vectors = np.linalg.eigh(S)
    w = samples @ (vectors / np.sqrt(values))
    return float(np.max(np.abs(np.log(np.linalg.eigvalsh(w.T @ w / len(w))))))


def bound(size):
    """For ``misfit``: eigenvalues of 6 whitened coordinates spread by 2 sqrt(6 / size); half more."""
    return 3 * math.sqrt(6 / size)


def close(a, b, tolerance):
    a, b = np.asarray(a, float), np.asarray(b, float)
    assert a.shape == b.shape, (a.shape, b.shape)
    gap = np.max(np.abs(a - b)) / max(1.0, np.max(np.abs(b)))
    assert gap <= tolerance, (gap, a, b)
