"""A pose graph to solve without a file."""

from __future__ import annotations

import liegen_groups
import numpy as np
from g2o import Floats, Graph, read_lines
from g2o_lines import POSE3

SPHERE_SIGMA = np.array([0.03, 0.03, 0.03, 0.1, 0.1, 0.1])  # radians, metres


def made_sphere(rings: int = 20, per_ring: int = 25, seed: int = 1) -> Graph:
    """A sphere of radius 10 m; the initial poses are dead reckoning from the true first pose."""
    n = rings * per_ring
    rng = np.random.default_rng(seed)
    longitude = 2 * np.pi * np.arange(n) / per_ring
    latitude = np.radians(np.linspace(-80, 80, n))
    about_z = liegen_groups.se3_exp(longitude[:, None] * [0, 0, 1, 0, 0, 0])
    about_y = liegen_groups.se3_exp(latitude[:, None] * [0, -1, 0, 0, 0, 0])
    out = liegen_groups.se3_exp([0.0, 0, 0, 10, 0, 0])
    true = liegen_groups.se3_compose(liegen_groups.se3_compose(about_z, about_y), out)

    i = np.concatenate([np.arange(n - 1), np.arange(n - per_ring)])
    j = np.concatenate([np.arange(1, n), np.arange(per_ring, n)])
    noise = rng.normal(size=(len(i), 6)) * SPHERE_SIGMA
    # Noise is in the frame of the measurement, as the residual is: z = x_i^-1 x_j Exp(noise).
    z = liegen_groups.se3_retract(liegen_groups.se3_between(true[i], true[j]), noise)

    poses = [true[0]]
    for odometry in z[: n - 1]:
        poses.append(liegen_groups.se3_compose(poses[-1], odometry))
    information = np.diag(SPHERE_SIGMA[[3, 4, 5, 0, 1, 2]] ** -2.0)[np.triu_indices(6)]
    lines = [f"VERTEX_SE3:QUAT {k} {numbers(POSE3.to_file(x))}" for k, x in enumerate(poses)]
    lines += [
        f"EDGE_SE3:QUAT {a} {b} {numbers(POSE3.to_file(x))} {numbers(information)}"
        for a, b, x in zip(i, j, z, strict=True)
    ]
    return read_lines("sphere", [*lines, ""])


def numbers(values: Floats) -> str:
    return " ".join(f"{v:.17g}" for v in values)
