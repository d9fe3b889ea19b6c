"""Sim(2): closed forms on (cos, sin, x, y, scale), tangent (x, y, angle, log scale).

With complex numbers an element is p -> e^z p + t, z = lambda + i angle, the group of affine maps of a line:
exp is (e^z, phi_1(z) rho), and ad is [[z, -rho], [0, 0]], so that its functions are divided differences.
phi_1 and phi_2 come as the coefficients A I + B W + C W^2, W = i angle, that Sim(3) has too.
"""

from __future__ import annotations

from collections.abc import Sequence

from liegen.algebra import Scalar
from liegen.algebra.linear import Chain, Matrix, Vector, beside, column, eye, matvec, negate, stacked
from liegen.coefficients import (
    similarity,
    similarity_derivatives,
    similarity_inverse,
    similarity_logarithm,
)

from .form import Coords, Source
from .similarity_form import SimilarityForm
from .so2_form import SO2Form


def _complex(angle: Scalar, a: Scalar, b: Scalar, c: Scalar) -> Matrix:
    """The complex number a + b W + c W^2 as a matrix."""
    real, imaginary = a - c * (angle * angle), b * angle
    return ((real, -imaginary), (imaginary, real))


def _rows(linear: Matrix, h: Vector) -> Matrix:
    """[[linear, i h, h], [0, I]]: the pattern of Jacobians and adjoints."""
    return stacked(beside(linear, column((-h[1], h[0])), column(h)), eye(4)[2:])


class Sim2Form(SimilarityForm):
    """Similarities of the plane."""

    name = "Sim2"
    storage = ("c", "s", "x", "y", "scale")
    tangent = ("x [m]", "y [m]", "angle [rad]", "log scale")
    note = (
        "Sim2: stored (cos, sin), translation (x, y), scale; x p = scale R p + translation; "
        "tangent: x [m], y [m], angle [rad], log of the scale; x.retract(d) = x exp(d)"
    )
    rotation = SO2Form()
    rotation_first = False

    def exp(self, d: Coords) -> Vector:
        V = _complex(d[2], *similarity(d[3], d[2] * d[2]))
        return (*self.rotation.exp(d[2:3]), *matvec(V, d[:2]), self.exp_scale(d))

    def log(self, a: Coords) -> Vector:
        (angle,), lam = self.rotation.log(a[:2]), self.log_scale(a)
        return (*matvec(self._V_inv(angle, lam), a[2:4]), angle, lam)

    def _V_inv(self, angle: Scalar, lam: Scalar) -> Matrix:
        a, b, c = similarity_inverse(lam, angle * angle)
        return _complex(angle, a, -b, c)

    def adjoint(self, a: Coords) -> Chain:
        """[[s R, -J t, -t], [0, I]], J the quarter turn."""
        return (_rows(self.linear(a), negate(a[2:4])),)

    def Jl(self, d: Coords) -> Matrix:
        """[[phi_1, -i phi_2 rho, -phi_2 rho], [0, I]]."""
        angle, lam = d[2:]
        return _rows(_complex(angle, *similarity(lam, angle * angle)), self._bend(d))

    def _bend(self, d: Coords) -> Vector:
        """-phi_2 rho."""
        angle, lam = d[2:]
        a, b, c, _, _ = similarity_derivatives(lam, angle * angle)
        return negate(matvec(_complex(angle, a, b, c), d[:2]))

    def Jl_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I - ad/2 + k(ad)."""
        return self._inverse(d, -0.5)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I + ad/2 + k(ad): both inverses share k(ad)."""
        return self._inverse(d, 0.5)

    def _inverse(self, d: Coords, half: Scalar) -> Matrix:
        """[[1 + half z + k(z), -(half + k(z)/z) rho], [0, I]] with k(z) = (z/2) coth(z/2) - 1."""
        angle, lam = d[2:]
        s = angle * angle
        _, D0, K, T, C, G, _, _ = similarity_logarithm(lam, s)
        linear = _complex(angle, 1 + half * lam + lam * lam * D0, half + lam * T, C)
        slope = _complex(angle, half + lam * (K - 2 * s * G), T - K + 2 * s * G, 0)
        return _rows(linear, negate(matvec(slope, d[:2])))

    def draw_tangent(self, source: Source, angle: float, offset: float | None) -> Sequence[float]:
        turn = self.rotation.draw_tangent(source, angle, offset)
        return (*source.vector(2, offset), *turn, self.draw_log_scale(source, angle, offset))
