"""Formulas that are not finite at a point of their own, as people write them.

The docstring holds what the message must say: how the operation is written, and the cure.
"""

from __future__ import annotations

import numpy as np

from liegen import (
    R1,
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SO3,
    Function,
    Product,
    acos,
    asin,
    atan2,
    dot,
    exp,
    factor,
    function,
    log,
    norm,
    outputs,
    require,
    sin,
    sqrt,
    where,
)


@factor
def root(T: SE3, p: R3, *, z: R1):
    """sqrt(dot(a, a)) | a = T.transform_to(p) | write norm(a), or require(dot(a, a) > 0, "...")"""
    d = T.transform_to(p)
    return sqrt(dot(d, d)) - z


@factor
def azimuth(T: SE3, p: R3, *, z: R1):
    """atan2(a[1], a[0]) | require(norm(stack(a[1], a[0])) > 0"""
    d = T.transform_to(p)
    return atan2(d[1], d[0]) - z


@factor
def angle_over_radius(T: SE3, p: R3, *, z: R1):
    """atan2(b, a[2]) / b | b = norm(a[0:2]) | require(abs(b) > 0"""
    q = T.transform_to(p)
    r = norm(q[:2])
    return atan2(r, q[2]) / r - z


@factor
def pixel(T: SE3, p: R3, *, z: R2):
    """a[0:2] / a[2] | require(abs(a[2]) > 0"""
    q = T.transform_to(p)
    return q[:2] / q[2] - z


@factor
def behind(T: SE3, p: R3, *, z: R2):
    """a[0:2] / a[2] | require(abs(a[2]) > 0"""
    q = T.transform_to(p)
    require(q[2] >= 0, "point behind the camera")
    return q[:2] / q[2] - z


@factor
def unit_vector(p: R3, q: R3, *, z: R3):
    """(p - q) / norm(p - q) | require(abs(norm(p - q)) > 0"""
    d = p - q
    return d / norm(d) - z


@factor
def between_directions(a: S2, b: S2, *, z: R1):
    """acos(dot(a.vector, b.vector)) | atan2(norm(cross(a, b)), dot(a, b)) | require(abs("""
    return acos(dot(a.vector, b.vector)) - z


@factor
def elevation(T: SE3, p: R3, *, z: R1):
    """a[2] / norm(a) | require(abs(norm(a)) > 0"""
    d = T.transform_to(p)
    return asin(d[2] / norm(d)) - z


@factor
def pitch(x: SO3, *, z: R1):
    """asin(-(x @ R3(1, 0, 0))[2]) | require(abs(-(x @ R3(1, 0, 0))[2]) < 1"""
    return asin(-(x @ R3(1.0, 0.0, 0.0))[2]) - z


@factor
def yaw(x: SO3, *, z: R1):
    """atan2(a[1], a[0]) | has no bound | require(norm(stack(a[1], a[0])) > 0"""
    v = x @ R3(1.0, 0.0, 0.0)
    return atan2(v[1], v[0]) - z


@factor
def trace_angle(x: SO3, y: SO3, *, z: R1):
    """acos( | x.between(y) | require(abs("""
    r = x.between(y)
    columns = [r @ e for e in np.eye(3)]
    return acos((columns[0][0] + columns[1][1] + columns[2][2] - 1) / 2) - z


@factor
def log_range(T: SE3, p: R3, *, z: R1):
    """log(norm(p - T.translation)) | require(norm(p - T.translation) > 0"""
    return log(T.range(p)) - z


@factor
def log_of_given(x: R1, *, z: R1):
    """log(z) | where z is 0 | require(z > 0"""
    return x - log(z)


@factor
def power(x: R2, *, z: R1):
    """log(x[0] * x[0] + x[1] * x[1]) | require(x[0] * x[0] + x[1] * x[1] > 0"""
    return exp(0.25 * log(x[0] ** 2 + x[1] ** 2)) - z


@factor
def square_of_square(x: R1, *, z: R1):
    """sqrt(x * x) | write abs(x)"""
    return sqrt(x * x) - z


@factor
def inverse_square(x: R1, *, p: R3, a: R3):
    """x / dot(p - a, p - a) | require(abs(dot(p - a, p - a)) > 0"""
    return x / dot(p - a, p - a)


@factor
def sum_of_lengths(x: R2, y: R2, *, z: R1):
    """sqrt(norm(x) + norm(y)) | require(norm(x) + norm(y) > 0"""
    return sqrt(norm(x) + norm(y)) - z


@factor
def polar(T: SE3, p: R3, *, z: R1):
    """atan2(norm(a[0:2]), a[2]) | a = T.transform_to(p)"""
    d = T.transform_to(p)
    return atan2(norm(d[:2]), d[2]) - z


@factor
def rotation_axis(x: SO3, y: SO3, *, z: R3):
    """x.local(y) / norm(x.local(y)) | where norm(x.local(y)) is 0"""
    w = x.local(y)
    return w / norm(w) - z


@factor
def rotation_angle(x: SO3, *, z: R1):
    """sqrt(dot(x.log(), x.log())) | write norm(x.log())"""
    w = x.log()
    return sqrt(dot(w, w)) - z


@factor
def half_tangent(x: SE2, y: SE2, *, z: R1):
    """a[1] / (norm(a) + a[0]) | a = x.between(y).translation"""
    d = x.between(y).translation
    return d[1] / (norm(d) + d[0]) - z


@factor
def ratio_of_sines(x: R1, *, z: R1):
    """sin(x) / x | where x is 0"""
    return sin(x) / x - z


@factor
def through_a_product(T: SE3, S: SE3, p: R3, *, z: R1):
    """sqrt(dot( | T.compose(S)"""
    q = (T @ S) @ p
    return p[0] * sqrt(dot(q, q)) - z


@factor
def either_arm(p: R3, *, k: R1, z: R1):
    """sqrt(dot(p, p)) | write norm(p)"""
    return where(k > 0, sqrt(dot(p, p)), 2.0 * sqrt(dot(p, p))) - z


@function
def length_of(v: R3) -> R1:
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@factor
def in_a_helper(T: SE3, p: R3, *, z: R1):
    """sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) | a = T.transform_from(p)"""
    return length_of(T @ p) - z


class Camera(Product):
    pose: SE3
    f: R1


@function
def projected(camera: Camera, p: R3):
    """a[0:2] / a[2] | a = camera.pose.transform_to(p)"""
    q = camera.pose.transform_to(p)
    return outputs(uv=camera.f * (q[:2] / q[2]), depth=q[2])


NAIVE = {f.name: f for f in list(globals().values()) if isinstance(f, Function) and f.name != "length_of"}
