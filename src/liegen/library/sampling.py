"""Samplers of the library's factors: the residual has the case's rotation and offset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from liegen.manifolds import R1, SE3, Calibration, Group, Manifold, Value
from liegen.samples import Case, Draw, Sampler


def prior(manifold: type[Manifold]) -> Sampler:
    """z anywhere, x the case's tangent away from it."""

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        z = draw.element(manifold, case.spread)
        return {"x": z.retract(draw.tangent(manifold, case)), "z": z}

    return sample


def between(group: type[Group]) -> Sampler:
    """x and y anywhere (equal where the case is the identity), z the case's tangent away from x^-1 y.

    Far from the origin either y is near x and the residual small, or both are apart and the residual large:
    a small difference of large relative poses has lost its digits already, which is the case ``apart``.
    """

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        far = case.spread > 1.0 and not case.apart
        near = far and draw.uniform(0, 1) < 0.5
        x = draw.element(group, case.spread)
        y = x.retract(draw.tangent(group, case)) if near else draw.element(group, case.spread)
        y = x if case.name == "identity" else y
        z = x.between(y).retract(-draw.tangent(group, case))
        return {"x": x, "y": y, "z": draw.element(group, case.spread) if far and not near else z}

    return sample


def _pair(draw: Draw, case: Case, first: type[Manifold], second: type[Manifold]) -> dict[str, Any]:
    """Two elements whose positions are the case's offset apart."""
    x, y = draw.element(first, case.spread), draw.element(second, case.spread)
    if case.offset is not None:
        n = 2 if "2" in first.form.name else 3
        # around the origin, where tiny offsets do not vanish in the coordinates
        centre = np.zeros(n) if 0 < case.offset < 1e-9 else draw.vector(n, spread=case.spread)
        x, y = _moved(x, centre), _moved(y, centre + draw.vector(n, case.offset))
    return {"x": x, "y": y}


def _moved(x: Any, position: Any) -> Any:
    kept = list(x.coords[: x.form.size - len(position)])
    return x.from_storage([*kept, *position])


def distance(first: type[Manifold], second: type[Manifold]) -> Sampler:
    """Two positions, and a measured distance of the same size."""

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        pair = _pair(draw, case, first, second)
        return {**pair, "z": R1.from_storage(draw.vector(1, spread=case.spread))}

    return sample


def direction(pose: type[Any], second: type[Manifold]) -> Sampler:
    """A pose, a position apart from it, and a measured bearing the case's angle away from the true one."""

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        apart = Case(case.name, offset=draw.uniform(0.5, 5.0) * case.spread, spread=case.spread)
        pair = _pair(draw, apart, pose, second)
        bearing = pair["x"].bearing(pair["y"])
        return {**pair, "z": bearing.retract(draw.tangent(pose.bearing_class, case))}

    return sample


def camera(calibration: type[Calibration]) -> Sampler:
    """A camera, a point in its field of view 0.5 to 10 spreads away, and a pixel near its image."""

    def sample(draw: Draw, case: Case) -> Mapping[str, Value]:
        x = SE3.identity() if case.name == "identity" else draw.element(SE3, case.spread)
        depth = draw.uniform(0.5, 10.0) * case.spread
        ray = np.array([draw.uniform(-0.7, 0.7), draw.uniform(-0.5, 0.5), 1.0])
        K = draw.element(calibration)
        z = K.uncalibrate(ray[:2]) + draw.vector(2, spread=0.0 if case.offset == 0.0 else 5.0)
        return {"x": x, "p": x.transform_from(ray * depth), "K": K, "z": z}

    return sample
