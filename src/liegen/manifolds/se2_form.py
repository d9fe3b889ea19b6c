"""SE(2): closed forms on (cos, sin, x, y), tangent (x, y, angle)."""

from __future__ import annotations

from liegen.algebra import Scalar
from liegen.algebra.linear import Chain, Matrix, Vector, matmul, matvec, sub, transpose
from liegen.coefficients import inverse_jacobian, stumpff

from .form import Compute, Coords, PoseForm, Rule
from .relative import relative_rule
from .so2_form import SO2Form


class SE2Form(PoseForm):
    """Poses of the plane.

    With ad = [[a J, u], [0, 0]], J = [[0, -1], [1, 0]], u = (rho_y, -rho_x), the cube of ad is -a^2 ad, so
    the series of Jr and of its inverse end after ad^2 = [[-a^2 I, a rho], [0, 0]].
    """

    name = "SE2"
    storage = ("c", "s", "x", "y")
    tangent = ("x [m]", "y [m]", "angle [rad]")
    note = "SE2: stored (cos, sin, x, y); tangent: x [m], y [m], angle [rad]; x.retract(d) = x exp(d)"
    rotation = SO2Form()
    rotation_first = False

    def exp(self, d: Coords) -> Vector:
        x, y, a = d
        _, c1, c2, _ = stumpff(a * a, 3)
        b = a * c2
        return (*self.rotation.exp((a,)), c1 * x - b * y, b * x + c1 * y)

    def log(self, a: Coords) -> Vector:
        (angle,) = self.rotation.log(a[:2])
        x, y = matvec(self._V_inv(angle), a[2:])
        return (x, y, angle)

    def _V_inv(self, angle: Scalar) -> Matrix:
        """Inverse of V with exp(rho, a) = (exp(a), V rho): (a/2) cot(a/2) I - (a/2) J."""
        s, half = angle * angle, angle * 0.5
        D, _ = inverse_jacobian(s)
        k = 1 - s * D
        return ((k, half), (-half, k))

    def local_between(self) -> tuple[Compute, Rule]:
        """The position part V^-1 R_z^T (t_c - t_z) is V^-T R_c^T (t_c - t_z).

        The Jacobian by x has that product.
        """

        def value(z: Coords, x: Coords, y: Coords) -> Vector:
            c = self.between(x, y)
            (angle,) = self.rotation.local(z[:2], c[:2])
            turned = matmul(transpose(self._V_inv(angle)), transpose(self.rotation.matrix(c[:2])))
            return (*matvec(turned, sub(c[2:], z[2:])), angle)

        return value, relative_rule(self)

    def adjoint(self, a: Coords) -> Chain:
        c, s, x, y = a
        return (((c, -s, y), (s, c, -x), (0, 0, 1)),)

    def adjoint_inverse(self, a: Coords) -> Chain:
        """Ad^-1 = [[R^T, 0], [0, 1]] [[I, (-y, x)], [0, 1]]."""
        c, s, x, y = a
        return (((c, s, 0), (-s, c, 0), (0, 0, 1)), ((1, 0, -y), (0, 1, x), (0, 0, 1)))

    def Jr(self, d: Coords) -> Matrix:
        """I - c2 ad + c3 ad^2."""
        x, y, a = d
        s = a * a
        _, c1, c2, c3 = stumpff(s, 3)
        b, e = a * c2, a * c3
        return ((c1, b, e * x - c2 * y), (-b, c1, e * y + c2 * x), (0, 0, 1))

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I + ad / 2 + D ad^2."""
        x, y, a = d
        s, half = a * a, a * 0.5
        D, _ = inverse_jacobian(s, principal=principal)
        k, e = 1 - s * D, D * a
        return ((k, -half, e * x + y * 0.5), (half, k, e * y - x * 0.5), (0, 0, 1))
