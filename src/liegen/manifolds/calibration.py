"""Camera calibrations as GTSAM names them. ``uncalibrate`` maps normalised image coordinates to pixels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from liegen.algebra.linear import Vector as Coordinates

from .additive_form import AdditiveForm
from .form import Coords
from .group import Manifold
from .node import Operation, apply
from .vector import R2, VectorLike, as_vector


def _radial(k1: Any, k2: Any, x: Any, y: Any) -> Any:
    """1 + k1 r^2 + k2 r^4."""
    r2 = x * x + y * y
    return 1 + (k1 + k2 * r2) * r2


def _affine(K: Coords, p: Coords) -> Coordinates:
    fx, fy, s, u0, v0 = K[:5]
    x, y = p
    return (fx * x + s * y + u0, fy * y + v0)


def _brown(K: Coords, p: Coords) -> Coordinates:
    k1, k2, p1, p2 = K[5:9]
    x, y = p
    xx, xy, yy = x * x, x * y, y * y
    g, r2 = _radial(k1, k2, x, y), xx + yy
    return (
        g * x + 2 * p1 * xy + p2 * (r2 + 2 * xx),
        g * y + 2 * p2 * xy + p1 * (r2 + 2 * yy),
    )


def _bundler_distort(K: Coords, p: Coords) -> Coordinates:
    g = _radial(K[1], K[2], p[0], p[1])
    return (g * p[0], g * p[1])


def _bundler_pixels(K: Coords, p: Coords) -> Coordinates:
    return (K[3] + K[0] * p[0], K[4] + K[0] * p[1])


Step = Callable[[Coords, Coords], Coordinates]


class Calibration(Manifold):
    """Parameters of a camera along +z. ``steps`` lead from normalised coordinates to pixels.

    Each step is differentiated on its own: a distortion multiplied into the intrinsics costs a fifth more.
    """

    __slots__ = ()
    steps: ClassVar[tuple[tuple[str, Step], ...]]

    def uncalibrate(self, p: VectorLike) -> R2:
        """Pixels of the normalised image point ``p`` = (x/z, y/z)."""
        point: Any = as_vector(p, 2, f"{self.form.name}.uncalibrate")
        for name, step in self.steps:
            operation = Operation(name, R2, step, None, f"{{0}}.{name}({{1}})", (self.form.name,))
            point = apply(operation, R2, self, point)
        return point


class _Cal3S2Form(AdditiveForm):
    name = "Cal3_S2"
    storage = ("fx", "fy", "s", "u0", "v0")
    tangent = ("fx [px]", "fy [px]", "s [px]", "u0 [px]", "v0 [px]")
    note = "Cal3_S2: stored fx, fy, s, u0, v0 [px]; tangent: the same, added"
    usual = ((300.0, 300.0, -1.0, 300.0, 200.0), (600.0, 600.0, 1.0, 340.0, 280.0))


class Cal3_S2(Calibration):
    """Pinhole with skew: u = fx x + s y + u0, v = fy y + v0."""

    __slots__ = ()
    form = _Cal3S2Form()
    steps = (("uncalibrate", _affine),)


class _Cal3DS2Form(AdditiveForm):
    name = "Cal3DS2"
    storage = ("fx", "fy", "s", "u0", "v0", "k1", "k2", "p1", "p2")
    tangent = ("fx [px]", "fy [px]", "s [px]", "u0 [px]", "v0 [px]", "k1", "k2", "p1", "p2")
    note = "Cal3DS2: stored fx, fy, s, u0, v0 [px], k1, k2, p1, p2; tangent: the same, added"
    usual = (
        (300.0, 300.0, -1.0, 300.0, 200.0, -0.2, -0.05, -1e-2, -1e-2),
        (600.0, 600.0, 1.0, 340.0, 280.0, 0.2, 0.05, 1e-2, 1e-2),
    )


class Cal3DS2(Calibration):
    """Pinhole with skew after Brown's radial and tangential distortion."""

    __slots__ = ()
    form = _Cal3DS2Form()
    steps = (("distort", _brown), ("uncalibrate", _affine))


class _Cal3BundlerForm(AdditiveForm):
    name = "Cal3Bundler"
    storage = ("f", "k1", "k2", "u0", "v0")
    tangent = ("f [px]", "k1", "k2")
    note = "Cal3Bundler: stored f [px], k1, k2, u0, v0 [px]; tangent: f, k1, k2, added; u0, v0 fixed"
    usual = ((300.0, -0.2, -0.05, 0.0, 0.0), (600.0, 0.2, 0.05, 100.0, 100.0))


class Cal3Bundler(Calibration):
    """One focal length and radial distortion: u = u0 + f g x, g = 1 + k1 r^2 + k2 r^4."""

    __slots__ = ()
    form = _Cal3BundlerForm()
    steps = (("distort", _bundler_distort), ("uncalibrate", _bundler_pixels))
