"""SE(3): closed forms on (quaternion, translation), tangent (rotation, translation).

SE(3) is SO(3) over dual numbers: its Jacobians are [[M, 0], [C, M]], where M is the Jacobian of the rotation
part and C the derivative of M in the direction of the translation part.
"""

from __future__ import annotations

from liegen.algebra import Scalar
from liegen.algebra.linear import (
    Chain,
    Matrix,
    Vector,
    add,
    beside,
    dot,
    eye,
    matvec,
    negate,
    scale,
    skew,
    stacked,
    times,
    transpose,
    zeros,
)
from liegen.coefficients import inverse_jacobian, stumpff

from .form import Coords, PoseForm
from .so3_form import SO3Form, series


def _dual(phi: Coords, rho: Coords, a: Scalar, b: Scalar, da: Scalar, db: Scalar) -> Matrix:
    """Derivative of ``series(phi, a, b)`` in the direction ``rho``.

    With da, db for twice the slopes of a, b by s = |phi|^2 it is
    a [rho]x + da (phi.rho) [phi]x + b (phi rho^T + rho phi^T) - 2 b (phi.rho) I
    + db (phi.rho) (phi phi^T - s I).
    """
    m = dot(phi, rho)
    slope = db * m
    k = b * m * 2 + slope * dot(phi, phi)
    (x, y, z), (u, v, w) = phi, rho
    bx, by, bz = b * x, b * y, b * z
    ex, ey, ez = slope * x, slope * y, slope * z
    xy, xz, yz = bx * v + by * u + ex * y, bx * w + bz * u + ex * z, by * w + bz * v + ey * z
    ax, ay, az = add(scale(a, rho), scale(times(da, m), phi))
    return (
        (bx * u * 2 + ex * x - k, xy - az, xz + ay),
        (xy + az, by * v * 2 + ey * y - k, yz - ax),
        (xz - ay, yz + ax, bz * w * 2 + ez * z - k),
    )


def _lower(diagonal: Matrix, corner: Matrix) -> Matrix:
    """[[M, 0], [C, M]]."""
    return stacked(beside(diagonal, zeros(3, 3)), beside(corner, diagonal))


class SE3Form(PoseForm):
    """Poses of space."""

    name = "SE3"
    storage = ("qx", "qy", "qz", "qw", "x", "y", "z")
    tangent = ("rx [rad]", "ry [rad]", "rz [rad]", "x [m]", "y [m]", "z [m]")
    note = (
        "SE3: stored quaternion (x, y, z, w), translation (x, y, z); "
        "tangent: rotation [rad], translation [m]; x.retract(d) = x exp(d)"
    )
    rotation = SO3Form()
    rotation_first = True

    def exp(self, d: Coords) -> Vector:
        """(exp(phi), V rho) with V = Jl(phi) = I + c2 [phi]x + c3 [phi]x^2 (micro Lie, eq. 172)."""
        phi, rho = d[:3], d[3:]
        c = stumpff(dot(phi, phi), 5)
        return (*self.rotation.exp(phi), *matvec(series(phi, c[2], c[3]), rho))

    def log(self, a: Coords) -> Vector:
        """(phi, Jl^-1(phi) t); Jl^-1 is the transpose of Jr^-1, which the Jacobians need too."""
        phi = self.rotation.log(a[:4])
        return (*phi, *matvec(transpose(self.rotation.Jr_inv(phi, principal=True)), a[4:]))

    def adjoint(self, a: Coords) -> Chain:
        """[[R, 0], [[t]x R, R]] as a product (micro Lie, eq. 175)."""
        R, z = self.rotation.matrix(a[:4]), zeros(3, 3)
        return (_lower(eye(3), skew(a[4:])), stacked(beside(R, z), beside(z, R)))

    def adjoint_inverse(self, a: Coords) -> Chain:
        Rt, z = transpose(self.rotation.matrix(a[:4])), zeros(3, 3)
        return (stacked(beside(Rt, z), beside(z, Rt)), _lower(eye(3), skew(negate(a[4:]))))

    def Jr(self, d: Coords) -> Matrix:
        """The slopes of -c2 and c3 follow from c_k' = (k c_{k+2} - c_{k+1}) / 2."""
        phi, rho = d[:3], d[3:]
        _, _, c2, c3, c4, c5 = stumpff(dot(phi, phi), 5)
        M = series(phi, -c2, c3)
        return _lower(M, _dual(phi, rho, -c2, c3, c3 - 2 * c4, 3 * c5 - c4))

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """M = I + [phi]x / 2 + D [phi]x^2; E = 2 dD/ds."""
        phi, rho = d[:3], d[3:]
        D, E = inverse_jacobian(dot(phi, phi), principal=principal)
        return _lower(series(phi, 0.5, D), _dual(phi, rho, 0.5, D, 0, E))
