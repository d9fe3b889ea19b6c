"""Maps between coordinates and rotations, with their right Jacobians: exp, Cayley, vector of a quaternion.

With a rotation by the angle a about u, q = (sin(a/2) u, cos(a/2)). A perturbation q exp(e) changes the vector
part v by (w I + [v]x) e / 2 and w by -v.e / 2; the Jacobians below are this, solved for e.
Source: Shuster, "A survey of attitude representations" (1993):
quaternions and Rodrigues parameters.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from liegen.algebra import Scalar, lt, select, sqrt
from liegen.algebra.linear import (
    Matrix,
    Vector,
    column,
    diagonal,
    dot,
    matadd,
    matmul,
    matscale,
    negate,
    scale,
    skew,
)
from liegen.manifolds.form import Coords, RotationForm


@dataclass(frozen=True)
class RotationMap(ABC):
    """m(k d): ``form`` is the group of rotations, ``k`` the scale of the chart."""

    form: RotationForm
    k: int

    @property
    def down(self) -> Scalar:
        """1/k; structural where k is 1."""
        return 1 if self.k == 1 else 1 / self.k

    @property
    def half(self) -> Scalar:
        """k/2; structural where k is 2."""
        return 1 if self.k == 2 else self.k / 2

    @property
    def double(self) -> int:
        """2/k."""
        return 2 // self.k

    @abstractmethod
    def rotation(self, d: Coords) -> Vector:
        """m(k d)."""

    @abstractmethod
    def vector(self, c: Coords) -> Vector:
        """The coordinates of a rotation, of the shorter way round."""

    @abstractmethod
    def slope(self, d: Coords) -> Matrix:
        """Right Jacobian: m(k (d + e)) = m(k d) exp(slope e) to first order."""

    @abstractmethod
    def slope_inv(self, r: Coords, c: Coords) -> Matrix:
        """Inverse of ``slope`` at the coordinates r of the rotation c. Its transpose is that of the left."""


class ExpMap(RotationMap):
    """Rotation vector."""

    def rotation(self, d: Coords) -> Vector:
        """exp(k d)."""
        return self.form.exp(scale(self.k, d))

    def vector(self, c: Coords) -> Vector:
        """log(c) / k."""
        return scale(self.down, self.form.log(c))

    def slope(self, d: Coords) -> Matrix:
        """k Jr(k d)."""
        return matscale(self.k, self.form.Jr(scale(self.k, d)))

    def slope_inv(self, r: Coords, c: Coords) -> Matrix:
        """Jr^-1(k r) / k."""
        return matscale(self.down, self.form.Jr_inv(scale(self.k, r), principal=True))


class QuaternionVector(RotationMap):
    """2/k times the vector part v of the quaternion with w >= 0: 2/k sin(a/2) u."""

    def rotation(self, d: Coords) -> Vector:
        """(v, sqrt(1 - |v|^2)) with v = k/2 d; not a number for |v| > 1."""
        v = scale(self.half, d)
        return (*v, sqrt(1 - dot(v, v)))

    def vector(self, c: Coords) -> Vector:
        """2/k v of the quaternion with w >= 0."""
        *v, w = c
        return scale(_sign(w) * self.double, v)

    def slope(self, d: Coords) -> Matrix:
        """k (w I - [v]x + v v^T / w)."""
        *v, w = self.rotation(d)
        flat = matadd(diagonal((w, w, w)), skew(negate(v)))
        return matscale(self.k, matadd(flat, _outer(v, scale(1 / w, v))))

    def slope_inv(self, r: Coords, c: Coords) -> Matrix:
        """(w I + [v]x) / k with w >= 0."""
        w = c[3] * _sign(c[3])
        return matscale(self.down, matadd(diagonal((w, w, w)), skew(scale(self.half, r))))


class Cayley(RotationMap):
    """2/k times the Rodrigues vector a = v/w: 2/k tan(a/2) u; none at half a turn."""

    def rotation(self, d: Coords) -> Vector:
        """(a, 1) / sqrt(1 + |a|^2) with a = k/2 d."""
        a = scale(self.half, d)
        w = 1 / sqrt(1 + dot(a, a))
        return (*scale(w, a), w)

    def vector(self, c: Coords) -> Vector:
        """2/k v / w."""
        *v, w = c
        return scale(self.double / w, v)

    def slope(self, d: Coords) -> Matrix:
        """k (I - [a]x) / (1 + |a|^2)."""
        a = scale(self.half, d)
        return matscale(self.k / (1 + dot(a, a)), matadd(diagonal((1, 1, 1)), skew(negate(a))))

    def slope_inv(self, r: Coords, c: Coords) -> Matrix:
        """(I + [a]x + a a^T) / k."""
        a = scale(self.half, r)
        return matscale(self.down, matadd(matadd(diagonal((1, 1, 1)), skew(a)), _outer(a, a)))


def _sign(w: Scalar) -> Scalar:
    """1 for w >= 0 (and for -0), else -1."""
    return select(lt(w, 0), -1.0, 1.0)


def _outer(a: Coords, b: Coords) -> Matrix:
    return matmul(column(a), (tuple(b),))


MAPS: Mapping[str, Any] = {"exp": ExpMap, "cayley": Cayley, "quaternion-vector": QuaternionVector}
