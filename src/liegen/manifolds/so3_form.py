"""SO(3): closed forms on the unit quaternion (x, y, z, w)."""

from __future__ import annotations

from liegen.algebra import Scalar, lt, select
from liegen.algebra.linear import Chain, Matrix, Vector, cross, dot, negate, scale, skew
from liegen.coefficients import inverse_jacobian, log_factor, stumpff

from .form import Blocks, Compute, Coords, RotationForm, Rule
from .relative import relative_rule


def series(phi: Coords, a: Scalar, b: Scalar, one: Scalar = 1) -> Matrix:
    """I + a [phi]x + b [phi]x^2, with [phi]x^2 = phi phi^T - |phi|^2 I; ``one`` times I."""
    x, y, z = phi
    bx, by, bz = scale(b, phi)
    k = one - b * dot(phi, phi)
    ax, ay, az = scale(a, phi)
    xy, xz, yz = bx * y, bx * z, by * z
    return (
        (k + bx * x, xy - az, xz + ay),
        (xy + az, k + by * y, yz - ax),
        (xz - ay, yz + ax, k + bz * z),
    )


def _log_scale(a: Coords) -> Scalar:
    """The factor f, with the sign of w, of log(v, w) = f v."""
    w = a[3]
    sign = select(lt(w, 0), -1.0, 1.0)
    return log_factor(w * sign) * sign


class SO3Form(RotationForm):
    """Rotations of space."""

    name = "SO3"
    storage = ("qx", "qy", "qz", "qw")
    tangent = ("rx [rad]", "ry [rad]", "rz [rad]")
    note = "SO3: stored unit quaternion (x, y, z, w); tangent: rotation vector [rad]; x.retract(d) = x exp(d)"
    quaternions = (0,)
    space = 3

    def identity(self) -> Vector:
        return (0, 0, 0, 1)

    def compose(self, a: Coords, b: Coords) -> Vector:
        ax, ay, az, aw = a
        bx, by, bz, bw = b
        return (
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        )

    def inverse(self, a: Coords) -> Vector:
        return (-a[0], -a[1], -a[2], a[3])

    def exp(self, d: Coords) -> Vector:
        """(sin(t/2)/t d, cos(t/2)) with t = |d|."""
        c0, c1 = stumpff(dot(d, d) * 0.25, 1)
        return (*scale(c1 * 0.5, d), c0)

    def log(self, a: Coords) -> Vector:
        """The short way round: q and -q are one rotation. At w = 0 the stored sign of the vector decides."""
        return scale(_log_scale(a), a[:3])

    def adjoint(self, a: Coords) -> Chain:
        return (self.matrix(a),)

    def Jr(self, d: Coords) -> Matrix:
        """I - c2 [d]x + c3 [d]x^2 (micro Lie, eq. 143)."""
        _, _, c2, c3 = stumpff(dot(d, d), 3)
        return series(d, -c2, c3)

    def Jr_inv(self, d: Coords, *, principal: bool = False) -> Matrix:
        """I + [d]x / 2 + D [d]x^2 (micro Lie, eq. 144)."""
        D, _ = inverse_jacobian(dot(d, d), principal=principal)
        return series(d, 0.5, D)

    def part_way(self, r: Coords, a: Scalar) -> Chain:
        """Both factors are series in [r]x with [r]x^3 = -s [r]x, and so is their product."""
        s = dot(r, r)
        D, _ = inverse_jacobian(s, principal=True)
        _, _, c2, c3 = stumpff(dot(scale(a, r), scale(a, r)), 3)
        p, q = c2 * a, c3 * (a * a)
        skewed, squared = 0.5 - p + s * (p * D - 0.5 * q), D + q - 0.5 * p - s * (q * D)
        return (series(r, skewed * a, squared * a, a),)

    def local_between(self) -> tuple[Compute, Rule]:
        by_group = relative_rule(self)

        def value(z: Coords, x: Coords, y: Coords) -> Vector:
            return self.local(z, self.between(x, y))

        def blocks(r: Coords, z: Coords, x: Coords, y: Coords) -> Blocks:
            by_z, _, by_y = by_group(r, z, x, y)
            turned: Matrix = tuple(negate(row) for row in self._turned_back(r, z, self.between(x, y)))
            return by_z, (turned,), by_y

        return value, blocks

    def _turned_back(self, r: Coords, z: Coords, c: Coords) -> Matrix:
        """Jr^-1(r) R_c^T for r = log(b), b = z^-1 c = (v, w), with no rotation matrix.

        Jr^-1 is f/2 (w I + [v]x) + D r r^T with r = f v. In quaternions w I + [v]x is the vector part of
        u -> b u and R_c^T that of u -> c^-1 u c, so their product is u -> z^-1 u c, whose entries
        share their products with b; and R_c v is the vector part of c z^-1.
        """
        zx, zy, zz, zw = z
        cx, cy, cz, cw = c
        xx, yy, zz_, ww = zx * cx, zy * cy, zz * cz, zw * cw
        near, far = (ww + xx, ww - xx), (yy + zz_, yy - zz_)
        # for each axis: the symmetric and the skew part, and the vector part of c z^-1
        axes = (
            (zy * cz, zz * cy, zw * cx, zx * cw),
            (zz * cx, zx * cz, zw * cy, zy * cw),
            (zx * cy, zy * cx, zw * cz, zz * cw),
        )
        (yz, wx), (xz, wy), (xy, wz) = [(p + q, s + t) for p, q, s, t in axes]
        seen = [(s - t) + (p - q) for p, q, s, t in axes]
        K = (
            (near[0] - far[0], xy + wz, xz - wy),
            (xy - wz, near[1] + far[1], yz + wx),
            (xz + wy, yz - wx, near[1] - far[1]),
        )
        f = _log_scale(self.between(z, c))
        D, _ = inverse_jacobian(dot(r, r), principal=True)
        half, along, moved = f * 0.5, scale(D, r), scale(f, seen)
        return tuple(
            tuple(half * k + u * v for k, v in zip(row, moved, strict=True))
            for row, u in zip(K, along, strict=True)
        )

    def matrix(self, a: Coords) -> Matrix:
        x, y, z, w = a
        x2, y2, z2 = x * 2, y * 2, z * 2
        xx, yy, zz = x * x2, y * y2, z * z2
        xy, xz, yz = x * y2, x * z2, y * z2
        wx, wy, wz = w * x2, w * y2, w * z2
        return (
            (1 - (yy + zz), xy - wz, xz + wy),
            (xy + wz, 1 - (xx + zz), yz - wx),
            (xz - wy, yz + wx, 1 - (xx + yy)),
        )

    def rotate(self, a: Coords, v: Coords) -> Vector:
        """v + w u + q x u with u = 2 q x v."""
        *q, w = a
        u = scale(2, cross(q, v))
        return tuple(p + w * r + s for p, r, s in zip(v, u, cross(q, u), strict=True))

    def generator(self, v: Coords) -> Matrix:
        return skew(negate(v))
