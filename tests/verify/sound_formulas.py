"""The same formulas written well, and others with kinks, cuts and holes that are documented."""

from __future__ import annotations

from liegen import (
    R1,
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Function,
    abs,
    acos,
    atan2,
    cross,
    dot,
    factor,
    function,
    log,
    maximum,
    norm,
    require,
    singular,
    sqrt,
    where,
)


@factor
def root(T: SE3, p: R3, *, z: R1):
    return norm(T.transform_to(p)) - z


@factor
def root_apart(T: SE3, p: R3, *, z: R1):
    d = T.transform_to(p)
    require(dot(d, d) > 0, "point at the origin")
    return sqrt(dot(d, d)) - z


@factor
def azimuth(T: SE3, p: R3, *, z: R1):
    d = T.transform_to(p)
    require(norm(d[:2]) > 0, "point on the axis")
    return atan2(d[1], d[0]) - z


@factor
def yaw(x: SO3, *, z: R1):
    v = x @ R3(1.0, 0.0, 0.0)
    require(norm(v[:2]) > 0, "looking up or down")
    return atan2(v[1], v[0]) - z


@factor
def pixel(T: SE3, p: R3, *, z: R2):
    q = T.transform_to(p)
    require(q[2] > 0, "point behind the camera")
    return q[:2] / q[2] - z


@factor
def unit_vector(p: R3, q: R3, *, z: R3):
    d = p - q
    require(norm(d) > 1e-6, "points too near")
    return d / norm(d) - z


@factor
def between_directions(a: S2, b: S2, *, z: R1):
    return atan2(norm(cross(a.vector, b.vector)), dot(a.vector, b.vector)) - z


@factor
def cosine(a: R3, b: R3, *, z: R1):
    require(abs(dot(a, b)) < 1, "no cosine")
    return acos(dot(a, b)) - z


@factor
def log_range(T: SE3, p: R3, *, z: R1):
    require(T.range(p) > 0, "point at the origin")
    return log(T.range(p)) - z


@factor
def log_of_given(x: R1, *, z: R1):
    require(z > 0, "z is not positive")
    return x - log(z)


@factor
def never_zero(x: R1, y: R2, *, z: R1):
    return sqrt(1 + x * x) / (2 + norm(y)) - log(1 + dot(y, y)) - z


@factor
def inverse_square(x: R1, *, p: R3, a: R3):
    require(dot(p - a, p - a) > 0, "at the centre")
    return x / dot(p - a, p - a)


@factor
def geodesic(x: SO3, y: SO3, *, z: R1):
    return norm(x.local(y)) - z


@factor
def scaled_local(x: SO3, y: SO3, *, z: R3):
    return 0.1 * x.local(y) - z


@factor
def plane_bearing(x: SE2, p: R2, *, z: SO2):
    return z.local(x.bearing(p))


@factor
def direction_of_pose(x: SE3, y: SE3, *, z: S2):
    return z.local(S2.direction(x.between(y).translation))


@factor
def huber(x: R1, *, z: R1):
    e = x - z
    return where(abs(e) < 1.0, 0.5 * e * e, abs(e) - 0.5)


@factor
def dead_zone(x: R1, *, z: R1):
    e = x - z
    return where(abs(e) < 1.0, 0.0, e)


@factor
def guarded(T: SE3, p: R3, *, z: R1):
    return norm(T.transform_to(p)) / maximum(norm(p), 0.5) - z


@function
def length_of(v: R3) -> R1:
    return norm(v)


@factor
def in_a_helper(T: SE3, p: R3, *, z: R1):
    return length_of(T @ p) - z


@factor
def declared_here(T: SE3, p: R3, *, z: R1):
    d = T.transform_to(p)
    singular("point on the axis", norm(d[:2]))
    return atan2(d[1], d[0]) - z


@factor
def declared_everywhere(T: SE3, p: R3, *, z: R1):
    d = T.transform_to(p)
    singular("point on the axis")
    return atan2(d[1], d[0]) - z


SOUND = {f.name: f for f in list(globals().values()) if isinstance(f, Function) and f.name != "length_of"}
