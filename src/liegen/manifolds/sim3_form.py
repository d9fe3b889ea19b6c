"""Sim(3): closed forms on (quaternion, translation, scale), tangent (rotation, translation, log scale).

exp(phi, rho, lambda) = (exp(phi), V rho, e^lambda) with V = phi_1(lambda + W) = A I + B W + C W^2, W =
[phi]x. The left Jacobian is the derivative of exp, seen from the left: the translation t = V rho changes by
d(V rho), less what the rotation and the scale alone do to t. With W P = rho phi^T - (phi.rho) I for P =
[rho]x everything falls into [w]x + k I + u phi^T + phi v^T.
"""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra import Scalar
from liegen.algebra.linear import (
    Chain,
    Matrix,
    Vector,
    add,
    beside,
    block_diagonal,
    column,
    cross,
    diagonal,
    dot,
    eye,
    matadd,
    negate,
    scale,
    skew,
    stacked,
    sub,
    transpose,
    zeros,
)
from liegen.coefficients import (
    similarity,
    similarity_derivatives,
    similarity_inverse,
    similarity_logarithm,
    stumpff,
)

from .form import Coords, Source
from .similarity_form import SimilarityForm
from .so3_form import SO3Form, series


def _polynomial(phi: Coords, a: Scalar, b: Scalar, c: Scalar) -> Matrix:
    """a I + b W + c W^2."""
    k = a - c * dot(phi, phi)
    bx, cx = skew(scale(b, phi)), scale(c, phi)
    outer = tuple(scale(x, cx) for x in phi)
    return matadd(matadd(diagonal((k, k, k)), bx), outer)


def _applied(phi: Coords, a: Scalar, b: Scalar, c: Scalar, v: Coords) -> Vector:
    """(a I + b W + c W^2) v."""
    across = cross(phi, v)
    return add(scale(a, v), add(scale(b, across), scale(c, cross(phi, across))))


def _rows(turn: Matrix, bend: Matrix, linear: Matrix, drift: Coords) -> Matrix:
    """[[turn, 0, 0], [bend, linear, drift], [0, 0, 1]], the pattern of all Jacobians and adjoints."""
    z, none = zeros(3, 3), zeros(3, 1)
    return stacked(beside(turn, z, none), beside(bend, linear, column(drift)), eye(7)[6:])


class Sim3Form(SimilarityForm):
    """Similarities of space."""

    name = "Sim3"
    storage = ("qx", "qy", "qz", "qw", "x", "y", "z", "scale")
    tangent = ("rx [rad]", "ry [rad]", "rz [rad]", "x [m]", "y [m]", "z [m]", "log scale")
    note = (
        "Sim3: stored quaternion (x, y, z, w), translation (x, y, z), scale; x p = scale R p + translation; "
        "tangent: rotation [rad], translation [m], log of the scale; x.retract(d) = x exp(d)"
    )
    quaternions = (0,)
    rotation = SO3Form()
    rotation_first = True

    def exp(self, d: Coords) -> Vector:
        phi, rho, lam = d[:3], d[3:6], d[6]
        V = similarity(lam, dot(phi, phi))
        return (*self.rotation.exp(phi), *_applied(phi, *V, rho), self.exp_scale(d))

    def log(self, a: Coords) -> Vector:
        phi, lam = self.rotation.log(a[:4]), self.log_scale(a)
        u, v, w = similarity_inverse(lam, dot(phi, phi))
        return (*phi, *_applied(phi, u, -v, w, a[4:7]), lam)

    def adjoint(self, a: Coords) -> Chain:
        """[[R, 0, 0], [[t]x R, s R, -t], [0, 0, 1]]."""
        R, t = self.rotation.matrix(a[:4]), a[4:7]
        return (_rows(eye(3), skew(t), eye(3), negate(t)), block_diagonal(R, self.linear(a), ((1,),)))

    def adjoint_inverse(self, a: Coords) -> Chain:
        """[[R^T, 0, 0], [-R^T [t]x / s, R^T / s, R^T t / s], [0, 0, 1]]."""
        Rt, t = transpose(self.rotation.matrix(a[:4])), a[4:7]
        r = 1 / self.scale_of(a)
        turned = tuple(scale(r, row) for row in Rt)
        return (block_diagonal(Rt, turned, ((1,),)), _rows(eye(3), skew(negate(t)), eye(3), t))

    def Jl(self, d: Coords) -> Matrix:
        """[[Jl(phi), 0, 0], [d(V rho)/dphi + [t]x Jl(phi), V, -phi_2(lambda + W) rho], [0, 0, 1]]."""
        phi, lam = d[:3], d[6]
        s = dot(phi, phi)
        _, _, c2, c3, _, _ = stumpff(s, 5)
        V = _polynomial(phi, *similarity(lam, s))
        return _rows(series(phi, c2, c3), self._bend(d), V, negate(self._drift(d)))

    def _drift(self, d: Coords) -> Vector:
        """phi_2(lambda + W) rho."""
        phi, lam = d[:3], d[6]
        a, b, c, _, _ = similarity_derivatives(lam, dot(phi, phi))
        return _applied(phi, a, b, c, d[3:6])

    def _bend(self, d: Coords) -> Matrix:
        """[t - B rho - C phi x rho - c3 (t.phi) phi]x + k I + u phi^T + phi v^T with t.phi = A (phi.rho)."""
        phi, rho, lam = d[:3], d[3:6], d[6]
        s, m = dot(phi, phi), dot(phi, rho)
        A, B, C = similarity(lam, s)
        _, _, _, by_b, by_c = similarity_derivatives(lam, s)
        _, _, c2, c3, _, _ = stumpff(s, 5)
        across = cross(phi, rho)
        back = cross(phi, across)
        t = add(scale(A, rho), add(scale(B, across), scale(C, back)))
        w = add(sub(scale(A - B, rho), scale(c3 * A * m, phi)), add(scale(B - C, across), scale(C, back)))
        k = (C - c2 * A) * m
        u = sub(add(scale(by_b, across), scale(by_c, back)), scale(C, rho))
        v = sub(scale(c2, t), scale(c3, cross(phi, t)))
        outer = matadd(tuple(scale(x, phi) for x in u), tuple(scale(x, v) for x in phi))
        return matadd(matadd(skew(w), diagonal((k, k, k))), outer)

    def Jl_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I - ad/2 + k(ad)."""
        return self._inverse(d, -0.5)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I + ad/2 + k(ad): both inverses share k(ad)."""
        return self._inverse(d, 0.5)

    def _inverse(self, d: Coords, half: Scalar) -> Matrix:
        """I + half ad + k(ad) with ad = [[W, 0, 0], [P, lambda + W, -rho], [0, 0, 0]].

        k(ad) has k(W) and k(lambda + W) on its diagonal, -k(z)/z of lambda + W times rho at its right, and
        below the divided differences of k at the eigenvalues lambda + w_i of one and w_j of the other block,
        w being 0, i theta, -i theta: of P's part along phi at (z, i theta), of the part across at (z, 0),
        (lambda, i theta).
        """
        phi, rho, lam = d[:3], d[3:6], d[6]
        s, m = dot(phi, phi), dot(phi, rho)
        D, D0, K, T, C, G, H, F = similarity_logarithm(lam, s)
        across, sg = cross(phi, rho), s * G
        skewed = add(scale(half + lam * (K - sg), rho), scale(lam * (H + G) * m, phi))
        w = add(skewed, scale(T * 0.5 - K + sg, across))
        # phi u^T + u phi^T, half of the term along phi in each
        u = add(sub(scale(lam * G, across), scale(G * m, phi)), scale(T * 0.5 + sg, rho))
        outer = matadd(tuple(scale(x, u) for x in phi), tuple(scale(x, phi) for x in u))
        k = -(T * m)
        bend = matadd(matadd(skew(w), diagonal((k, k, k))), outer)
        linear = _polynomial(phi, 1 + half * lam + lam * lam * D0, half + lam * T, C)
        moved = add(scale(half + lam * (K - 2 * sg), rho), scale(T - K + 2 * sg, across))
        drift = negate(add(moved, scale(lam * (2 * G - F) * m, phi)))
        return _rows(series(phi, half, D), bend, linear, drift)

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        turn = self.rotation.draw_tangent(source, angle, offset)
        return (*turn, *source.vector(3, offset), self.draw_log_scale(source, angle, offset))
