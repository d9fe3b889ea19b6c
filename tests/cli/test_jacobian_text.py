"""The Jacobian formulas that `explain` and the headers show: their text, and that the text is true."""

import numpy as np
import pytest
from read_formulas import Reader

from liegen import (
    R1,
    R2,
    R3,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Sim2,
    Sim3,
    abs,
    acos,
    asin,
    atan2,
    cos,
    cross,
    dot,
    exp,
    factor,
    function,
    library,
    log,
    maximum,
    minimum,
    norm,
    outputs,
    sin,
    sqrt,
    stack,
    tan,
    where,
)
from liegen.samples import CASES, Draw, default_sampler
from liegen.trace import formula, jacobian_formulas
from liegen.trace.jacobian_text import legend

MATRIX = np.array([[1.0, 0.0, 2.0], [0.5, -1.0, 0.0]])


def test_between_reads_as_in_the_literature():
    assert jacobian_formulas(library.between_se3.graph) == (
        "a = x.between(y)",
        "res_D_x = -Jr^-1(res) Ad(a^-1)",
        "res_D_y = Jr^-1(res)",
    )
    assert library.between_se3.kernel.jacobian_formulas == jacobian_formulas(library.between_se3.graph)


def test_identity_and_signs_vanish_in_products():
    assert jacobian_formulas(library.between_r3.graph) == ("res_D_x = -I", "res_D_y = I")
    assert jacobian_formulas(library.range_se3_r3.graph)[1:] == (
        "res_D_x = -unit(a)^T R(x) [0, I]",
        "res_D_y = unit(a)^T",
    )


def test_the_legend_names_what_occurs_and_nothing_else():
    shown = legend(jacobian_formulas(library.between_se3.graph))
    assert [line.split(":")[0] for line in shown] == ["Ad(x)", "Jr(d), Jr^-1(d)"]


@factor
def group_operations(x: SE3, y: SE3, *, z: SE3):
    c = x.inverse().compose(y).retract(0.3 * y.log())
    return z.local(c.between(SE3.exp(0.5 * x.local(y))))


@factor
def group_operations_2d(x: SE2, y: SE2, *, z: SE2):
    c = x.inverse().compose(y).retract(0.3 * y.log())
    return z.local(c.between(SE2.exp(0.5 * x.local(y))))


@factor
def pose_pieces(x: SE3, q: SO3, p: R3):
    moved = x.transform_from(q @ p) + q.unrotate(p) + x.transform_to(p) + x.translation
    return moved + SE3(q, p).transform_from(p)


@factor
def pose_pieces_2d(x: SE2, q: SO2, p: R2):
    moved = x.transform_from(q @ p) + q.unrotate(p) + x.transform_to(p) + x.translation
    return moved + SE2(q, p).transform_from(p)


@factor
def similarity_pieces(x: Sim3, q: SO3, p: R3):
    moved = x.transform_from(q @ p) + x.transform_to(p) + x.translation
    return x.scale * moved + Sim3(q, p, p[0]).transform_from(p)


@factor
def similarity_pieces_2d(x: Sim2, q: SO2, p: R2):
    moved = x.transform_from(q @ p) + x.transform_to(p) + x.translation
    return x.scale * moved + Sim2(q, p, p[0]).transform_from(p)


@factor
def rotation_of_similarity(x: Sim3, *, z: SO3):
    return z.local(x.rotation)


@factor
def rotation_of_similarity_2d(x: Sim2, *, z: SO2):
    return z.local(x.rotation)


@factor
def rotation_of_pose(x: SE3, *, z: SO3):
    return z.local(x.rotation)


@factor
def rotation_of_pose_2d(x: SE2, *, z: SO2):
    return z.local(x.rotation)


@factor
def directions(x: SE3, p: R3):
    return S2.direction(x.transform_to(p)).vector


@factor
def bearing_2d(x: SE2, p: R2, *, z: SO2):
    return z.local(x.bearing(p))


@factor
def vectors(v: R3, w: R3, k: R1, *, z: R2):
    u = k * v + v * w - v / k + (-w) / v
    return stack(dot(u, w), cross(v, w), norm(w - v), u[0:2], u[2] * w[0] / k) + stack(
        where(k > 0.1, v, w), minimum(v, w), 0, 0
    )


@factor
def constant_matrix(v: R3, w: R3):
    return MATRIX @ cross(v, w) + MATRIX @ (v - w) - MATRIX @ (2 * v)


@factor
def chosen(v: R3, k: R1):
    return where((k > 5) | ~(k <= 4), -v, 2 * v) - where((k > 0.1) & (v[0] < v[1] + k), v, -(v * 2))


@factor
def scalars(v: R3, s: R1):
    u = sin(v) + cos(v) - tan(v) + exp(v) + abs(v) + maximum(v, 0.1)
    t = asin(s / 9) + acos(s / 9) + sqrt(1 + s * s) + log(2 + s * s) + atan2(s, 2 + v[0])
    return u * t + atan2(v[1], s)


@function
def chained(x: SE3, v: R3):
    """An output that feeds another."""
    p = x @ v
    return outputs(p=p, d=norm(p), T=x.retract(stack(p, v)))


@factor
def half_square(p: R3, *, a: R1, z: R1):
    return dot(p, p) / (2 * a) - z


@factor
def repeated_poses(x: SE3, y: SE3, *, k: R1):
    return 2 * x.local(y) + 3 * x.local(y) - k * x.local(y)


@factor
def sum_of_one(p: R3, q: R3):
    return p + p + p - q - q


@factor
def zero(p: R3, q: R3, *, w: R1):
    return w * p - w * p + q


@factor
def products_of_numbers(p: R1, q: R1):
    return p * q * p + sin(p) * q - 2.0 * (3.0 * p) + q * (-0.25 * p) / 3 + sqrt(p) + sqrt(p)


@factor
def same_crosses(p: R3, q: R3):
    return cross(p, q) + cross(p, q) - (-p)


@factor
def fourth_power(p: R2):
    return dot(p, p) * dot(p, p)


@factor
def third_of_fourth_power(p: R1):
    return p * p * p * p / 3


@factor
def other_order(v: R3, s: R1, t: R1):
    return s * (t * v) + t * (s * v) - 0.5 * v - (v / 4)


@factor
def two_matrices(v: R3):
    return MATRIX @ v + (2 * MATRIX) @ v


@factor
def entries(v: R3, w: R3):
    return v * w - w * v + v * w + v / w + 2 * v / w


@factor
def below_zero(v: R3, k: R1):
    return where(k > 0.1, 2 * v, -v) + where(k > 0.1, 2 * v, -v)


@pytest.mark.parametrize(
    ("f", "lines"),
    [
        (half_square, ["res_D_p = (1 / a) p^T"]),
        (repeated_poses, ["a = x.local(y)", "res_D_x = -5 Jl^-1(a) + k Jl^-1(a)",
                          "res_D_y = 5 Jr^-1(a) - k Jr^-1(a)"]),
        (sum_of_one, ["res_D_p = 3 I", "res_D_q = -2 I"]),
        (zero, ["res_D_p = 0", "res_D_q = I"]),
        (same_crosses, ["res_D_p = -2 [q]x + I", "res_D_q = 2 [p]x"]),
        (fourth_power, ["a = dot(p, p)", "res_D_p = 4 a p^T"]),
        (other_order, ["a = t * v", "b = s * v", "res_D_v = 2 s t - 0.75 I", "res_D_s = a + t v",
                       "res_D_t = s v + b"]),
        (two_matrices, ["res_D_v = M + M"]),
    ],
    ids=lambda x: getattr(x, "name", ""),
)  # fmt: skip
def test_like_terms_are_added(f, lines):
    assert list(jacobian_formulas(f.graph)) == lines


#: Factors and the group of their Jr, Jl, Ad.
CASES_OF_GROUP = [
    (group_operations, SE3), (group_operations_2d, SE2), (pose_pieces, SE3), (pose_pieces_2d, SE2),
    (similarity_pieces, Sim3), (similarity_pieces_2d, Sim2), (rotation_of_similarity, SO3),
    (rotation_of_similarity_2d, SO2), (rotation_of_pose, SO3), (rotation_of_pose_2d, SO2), (directions, SE3),
    (bearing_2d, SE2), (vectors, SE3), (constant_matrix, SE3), (chosen, SE3), (scalars, SE3), (chained, SE3),
    (library.between_so3, SO3), (library.between_se2, SE2), (library.range_se2, SE2), (library.range_se3,
    SE3), (library.prior_so3, SO3), (half_square, SE3), (repeated_poses, SE3), (sum_of_one, SE3), (zero, SE3),
    (products_of_numbers, SE3), (same_crosses, SE3), (fourth_power, SE3), (third_of_fourth_power, SE3),
    (other_order, SE3), (entries, SE3), (below_zero, SE3),
]  # fmt: skip


@pytest.mark.parametrize(("f", "group"), CASES_OF_GROUP, ids=lambda c: getattr(c, "name", ""))
def test_the_text_is_the_jacobian(f, group):
    parameters = {p.name: p.manifold for p in f.graph.parameters}
    values = dict(default_sampler(parameters)(Draw(np.random.default_rng(7)), CASES[0]))
    variables = {p.name: p.manifold.form.dim for p in f.graph.parameters if p.variable}
    given = {k: v for k, v in values.items() if k not in variables}
    exact = f.jacobians(*(values[k] for k in variables), **given)
    reader = Reader(values, group, MATRIX)
    for line in formula(f.graph):
        reader.line(line)
    for line in jacobian_formulas(f.graph):
        name, variable = (*line.split(" = ")[0].split("_D_"), "")[:2]
        if not variable:
            reader.line(line)
            continue
        rows = np.size(reader.values[name].coords) if name not in dict(f.graph.outputs) else None
        rows = rows or exact[f"{name}_D_{variable}"].shape[0]
        read = reader.line(line, rows, variables[variable])
        if f"{name}_D_{variable}" in exact:
            np.testing.assert_allclose(
                read, exact[f"{name}_D_{variable}"], rtol=1e-10, atol=1e-10, err_msg=line
            )
