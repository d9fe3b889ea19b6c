"""SE(3): closed forms on (quaternion, translation), tangent (rotation, translation).

SE(3) is SO(3) over dual numbers: its Jacobians are [[M, 0], [C, M]], where M is the Jacobian of the rotation
part and C the derivative of M in the direction of the translation part.
"""

from __future__ import annotations

from liegen.algebra.linear import Chain, Matrix, Vector, dot, matvec, sub, transpose
from liegen.coefficients import stumpff

from . import dual
from .form import Compute, Coords, PoseForm, Rule
from .relative import relative_rule
from .so3_form import SO3Form, series


class SE3Form(PoseForm):
    """Poses of space."""

    name = "SE3"
    storage = ("qx", "qy", "qz", "qw", "x", "y", "z")
    tangent = ("rx [rad]", "ry [rad]", "rz [rad]", "x [m]", "y [m]", "z [m]")
    note = (
        "SE3: stored quaternion (x, y, z, w), translation (x, y, z); "
        "tangent: rotation [rad], translation [m]; x.retract(d) = x exp(d)"
    )
    quaternions = (0,)
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

    def local_between(self) -> tuple[Compute, Rule]:
        """The translation part is Jr^-1(phi) R_c^T (t_c - t_z): the Jacobian by x needs this rotation matrix.

        To multiply by the product of both matrices, which it needs as well, would save 18 operations more,
        but everything else waits for that: 5 % slower in C.
        """

        def value(z: Coords, x: Coords, y: Coords) -> Vector:
            c = self.between(x, y)
            phi = self.rotation.local(z[:4], c[:4])
            d = matvec(transpose(self.rotation.matrix(c[:4])), sub(c[4:], z[4:]))
            return (*phi, *matvec(self.rotation.Jr_inv(phi, principal=True), d))

        return value, relative_rule(self)

    def adjoint(self, a: Coords) -> Chain:
        """[[R, 0], [[t]x R, R]] as a product (micro Lie, eq. 175)."""
        return dual.adjoint(self.rotation.matrix(a[:4]), a[4:])

    def adjoint_inverse(self, a: Coords) -> Chain:
        return dual.adjoint_inverse(self.rotation.matrix(a[:4]), a[4:])

    def Jr(self, d: Coords) -> Matrix:
        return dual.Jr(d[:3], d[3:])

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        return dual.Jr_inv(d[:3], d[3:], principal=principal)
