"""NavState: the group SE_2(3) with the componentwise chart of GTSAM 4.3 (``NavState::retract``).

The chart is x times (Exp(w), d_p, d_v): orientation, position and velocity move on their own, each seen from
the body. At d = 0 it agrees with the exponential chart to first order.
"""

from __future__ import annotations

from liegen.algebra.linear import (
    Matrix,
    Vector,
    beside,
    block_diagonal,
    eye,
    negate,
    skew,
    stacked,
    transpose,
    zeros,
)

from .form import Blocks, Coords, Rule
from .se23_form import SE23Form


class NavStateForm(SE23Form):
    """Extended poses that move by components."""

    name = "NavState"
    note = (
        "NavState: stored quaternion (x, y, z, w), position (x, y, z), velocity (x, y, z); tangent: rotation "
        "[rad], position [m], velocity [m/s], in the body; x.retract(d) = (R Exp(w), p + R d_p, v + R d_v)"
    )
    exponential = False

    def _moved(self, d: Coords) -> Vector:
        return (*self.rotation.exp(d[:3]), *d[3:])

    def retract(self, x: Coords, d: Coords) -> Vector:
        """(R Exp(w), p + R d_p, v + R d_v)."""
        return self.compose(x, self._moved(d))

    def local(self, x: Coords, y: Coords) -> Vector:
        """(Log(R_x^T R_y), R_x^T (p_y - p_x), R_x^T (v_y - v_x))."""
        c = self.between(x, y)
        return (*self.rotation.log(c[:4]), *c[4:])

    def retract_blocks(self) -> Rule:
        """d/dx = Ad(m)^-1, m = (Exp(w), d_p, d_v); d/dd: the rotation by Jr, the rest turned by Exp(w)^T."""

        def blocks(_: Coords, _x: Coords, d: Coords) -> Blocks:
            moved = self._moved(d)
            Et = transpose(self.rotation.matrix(moved[:4]))
            return self.adjoint_inverse(moved), (block_diagonal(self.rotation.Jr(d[:3]), Et, Et),)

        return blocks

    def local_blocks(self) -> Rule:
        """d/dy: the rotation by Jr^-1, the rest turned by R_x^T R_y; d/dx: the frame of x turns and moves."""

        def blocks(r: Coords, x: Coords, y: Coords) -> Blocks:
            phi, z = r[:3], zeros(3, 3)
            C = self.rotation.matrix(self.rotation.between(x[:4], y[:4]))
            minus: Matrix = tuple(negate(row) for row in eye(3))
            turned = tuple(negate(row) for row in self.rotation.Jl_inv(phi, principal=True))
            by_x = stacked(
                beside(turned, z, z), beside(skew(r[3:6]), minus, z), beside(skew(r[6:]), z, minus)
            )
            return (by_x,), (block_diagonal(self.rotation.Jr_inv(phi, principal=True), C, C),)

        return blocks
