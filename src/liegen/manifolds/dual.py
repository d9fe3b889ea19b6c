"""SO(3) over dual numbers: Jacobians and adjoints of a rotation together with vectors that it turns.

With one vector this is SE(3), with two SE_2(3). The Jacobians are [[M, 0, ...], [C_1, M, ...], ...]: M is
that of the rotation, C_k the derivative of M in the direction of the k-th vector.
"""

from __future__ import annotations

from liegen.algebra import Scalar
from liegen.algebra.factors import Letter, Turn
from liegen.algebra.linear import (
    Chain,
    Matrix,
    add,
    beside,
    dot,
    eye,
    negate,
    scale,
    skew,
    stacked,
    times,
    zeros,
)
from liegen.coefficients import inverse_jacobian, stumpff

from .form import Coords
from .so3_form import series


def slope_of_series(phi: Coords, rho: Coords, a: Scalar, b: Scalar, da: Scalar, db: Scalar) -> Matrix:
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


def lower(diagonal: Matrix, *corners: Matrix) -> Matrix:
    """[[M, 0, 0], [C_1, M, 0], [C_2, 0, M]] for as many corners as there are."""
    n = len(corners)
    rows = [
        beside(C, *(zeros(3, 3),) * k, diagonal, *(zeros(3, 3),) * (n - 1 - k)) for k, C in enumerate(corners)
    ]
    return stacked(beside(diagonal, *(zeros(3, 3),) * n), *rows)


def adjoint(R: Letter, *vectors: Coords) -> Chain:
    """[[R, 0], [[t]x R, R]] as a product, for each vector t."""
    return (lower(eye(3), *map(skew, vectors)), _turn(R, 1 + len(vectors)))


def adjoint_inverse(R: Letter, *vectors: Coords) -> Chain:
    """The inverse of ``adjoint``: diag(R^T) times [[I, 0], [-[t]x, I]]."""
    return (_turn(R.inverted, 1 + len(vectors)), lower(eye(3), *(skew(negate(t)) for t in vectors)))


def _turn(R: Letter, blocks: int) -> Turn:
    return Turn(((R,),) * blocks, (3,) * blocks)


def Jr(phi: Coords, *vectors: Coords) -> Matrix:
    """Right Jacobian. The slopes of -c2 and c3 follow from c_k' = (k c_{k+2} - c_{k+1}) / 2."""
    _, _, c2, c3, c4, c5 = stumpff(dot(phi, phi), 5)
    corners = (slope_of_series(phi, rho, -c2, c3, c3 - 2 * c4, 3 * c5 - c4) for rho in vectors)
    return lower(series(phi, -c2, c3), *corners)


def Jr_inv(phi: Coords, *vectors: Coords, principal: bool = False) -> Matrix:
    """Its inverse: M = I + [phi]x / 2 + D [phi]x^2; E = 2 dD/ds."""
    D, E = inverse_jacobian(dot(phi, phi), principal=principal)
    return lower(series(phi, 0.5, D), *(slope_of_series(phi, rho, 0.5, D, 0, E) for rho in vectors))
