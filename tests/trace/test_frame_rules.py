"""What each operation asks of frames: what fits, what is refused and with which words."""

from pathlib import Path

import pytest
from frame_tools import ARGUMENTS, made

from liegen import (
    SE3,
    factor,
)
from liegen.errors import DefinitionError

ACCEPTED = {
    # body: the frame of its tangent, or of the vector
    "T_AB @ T_BC": "C",
    "T_AB.inverse() @ T_AC": "C",
    "T_AB @ T_CB.inverse()": "C",
    "T_AB.between(T_AC)": "C",
    "T_AB.local(T_AC)": "B",
    "(T_AB @ T_BC).local(T_AC)": "C",
    "T_AB.log()": "A",
    "T_AB.inverse().log()": "B",
    "T_AB @ SE3.exp(xi_B)": "the new frame",
    "T_AB.retract(xi_B)": "the new frame",
    "T_AB.retract(s * xi_B).local(T_AC)": "C",
    "T_AB.retract(stack(v_B, v_B))": "the new frame",
    "SE3.exp(xi_A) @ T_AB": "B",
    "T_AB @ p_B": "A",
    "T_AB.transform_to(p_A)": "B",
    "T_AB @ p_B - p_A": "A",
    "T_AB.rotation @ p_B + T_AB.translation - p_A": "A",
    "T_AB.rotation.unrotate(p_A - T_AB.translation)": "B",
    "T_BC.transform_to(T_AB.rotation.unrotate(p_A - T_AB.translation))": "C",
    "T_AB.rotation @ v_B": "A",
    "T_AB.rotation.unrotate(v_A)": "B",
    "R_AB @ v_B - v_A": "A",
    "R_AB @ p_B + t_AB - p_A": "A",
    "R_AB @ (p_B - p_B)": "A",
    "R_AB.unrotate(v_A)": "B",
    "R_AB @ R_BC": "C",
    "R_AB.local(q_AB)": "B",
    "R_AB.log()": "A",
    "R_AB.retract(s * v_B)": "the new frame",
    "SE3(R_AB, t_AB)": "B",
    "SE3(R_AB, v_A * s)": "B",
    "p_A - p2_A": "A",
    "p_A + v_A * s": "A",
    "p_A + v_A * s - p2_A": "A",
    "v_A + v2_A": "A",
    "v_A - v2_A": "A",
    "d_A - p_A": "A",
    "s / v_A - p_A": "A",  # the reciprocal of a free vector is none
    "(p_A + p2_A) / 2 - p_A": "A",
    "p_A.local(p2_A)": "A",
    "p_A.between(p2_A)": "A",
    "p_A.retract(v_A)": "A",
    "R3.exp(v_A) - v2_A": "A",
    "-v_A": "A",
    "-(p_A - p2_A)": "A",
    "cross(v_A, p_A)": "A",
    "liegen.minimum(p_A, p2_A)": "A",
    "where(s > 0, p_A, p2_A)": "A",
    "p_A[:2] - l_A": "A",
    "xi_A[:3] + v_A": "A",
    "T_AB.bearing(p_A)": "B",
    "T_AB.bearing(T_AC)": "B",
    "S2.direction(p_A - p2_A)": "A",
    "n_A.vector - v_A": "A",
    "n_A.local(m_A)": "A",
    "n_A.retract(stack(s, s))": "A",
    "n_B.local(T_AB.bearing(p_A))": "B",
    "R_AB @ n_B.vector": "A",
    "P_AB @ P_BC": "C",
    "P_AB @ l_B": "A",
    "P_AB.rotation @ u_B": "A",
    "Q_AB @ Q_BC": "C",
    "Q_AB @ u_B": "A",
    "K_IC.uncalibrate(p_C[:2] / p_C[2])": "I",
    "K_IC.uncalibrate(T_AC.transform_to(p_A)[:2]) - z_I": "I",
    "D_IC.uncalibrate(p_C[:2] / p_C[2]) - z_I": "I",
    # the matrix of a rotation
    "R_AB.matrix() @ v_B": "A",
    "R_AB.matrix() @ p_B + t_AB - p_A": "A",
    "R_AB.matrix().T @ v_A": "B",
    "v_A @ R_AB.matrix()": "B",
    "(R_AB.matrix() @ R_BC.matrix()).transpose() @ v_A": "C",
    # functions of vectors
    "v_A / norm(v_A)": "A",
    "v_A * dot(v_A, p_A) - cross(p_A, cross(v_A, p_A))": "A",
    "-(2 * v_A) / s + v2_A": "A",
    "stack(p_A, v_B)[:3] - p2_A": "A",
    "-stack(v_A, v_B)[3:] + v_B": "B",
    "T_AB.local(T_AC)[:3] - v_B": "B",
    # extended poses
    "X_AB.inverse() @ X_AC": "C",
    "X_AB.between(X_AC)": "C",
    "X_AB.local(X_AC)": "B",
    "X_AB.retract(zeta_B)": "the new frame",
    "NavState.exp(zeta_A) @ X_AB": "B",
    "X_AB.log()": "A",
    "X_AB.position - p_A": "A",
    "X_AB.velocity - v_A": "A",
    "X_AB.rotation @ v_B - X_AB.velocity": "A",
    "X_AB.pose.transform_to(p_A)": "B",
    "NavState(R_AB, p_A, v_A)": "B",
    "X.position - p_A": "A",
    "E_AB @ E_BC": "C",
    "E_AB @ E_CB.inverse()": "C",
    "G_AB @ G_BC": "C",
    "G_AB.position + G_AB.velocity * G_AB.time - p_A": "A",
    "Gal3(R_AB, t_AB, v_A, s).pose": "B",
    # names without frames fit anything, and learn from where they stand
    "x @ T_AB": "B",
    "T_AB @ x @ T_DC": "C",
    "T_AB @ q - p_A": "A",
    "x.transform_to(p_A) - p_B": "B",
    "(x @ p_B - p_A) + (x @ p_C - p_A) + (x @ p_A - v_B)": "A",
    "T_AB.retract(xi)": "the new frame",
    "p_A + 1.0": "A",
    "p_A - [1.0, 2.0, 3.0]": "A",
    "x.local(T_AB)": "B",
    "(q - w) + x.translation - y.rotation @ (q - w)": "the frame of q",
    "x.transform_to(q - w)": "the body frame of x",
    "x.log()[3:] - q": "the frame of q",
}


@pytest.mark.parametrize("body", ACCEPTED)
def test_what_fits_is_accepted(body):
    rows = made(body).frames.rows
    assert rows.get("r", "the new frame") == ACCEPTED[body]


@pytest.mark.parametrize(
    "body",
    ["dot(v_A, p_A)", "norm(T_AB @ p_B - p_A)", "T_AB.range(T_AC)", "T_AB.range(p_A)", "p_A.range(p2_A)",
     "s * s", "p_A[2] - p_B[2]", "stack(s, s, s, s) - c", "b_B.local(P_AB.bearing(l_A))"],
)  # fmt: skip
def test_numbers_are_in_no_frame(body):
    assert "r" not in made(body).frames.rows


REJECTED = {
    # body: both frames with what they are of, the repair (or nothing)
    "T_AB @ T_CB": ("the inner frame of T_AB is B, the outer frame of T_CB is C", "T_AB @ T_CB.inverse()"),
    "T_AB @ T_AC": ("the inner frame of T_AB is B, the outer frame of T_AC is A", "T_AB.inverse() @ T_AC"),
    "T_BC @ T_AB": ("the inner frame of T_BC is C, the outer frame of T_AB is A", "T_AB @ T_BC"),
    "T_AB @ T_DC": ("the inner frame of T_AB is B, the outer frame of T_DC is D", None),
    "T_AB.between(T_BC)": (
        "the outer frame of T_AB is A, the outer frame of T_BC is B",
        "T_AB.inverse().between(T_BC)",
    ),
    "T_AC.between(T_CB)": (
        "the outer frame of T_AC is A, the outer frame of T_CB is C",
        "T_AC.inverse().between(T_CB)",
    ),
    "T_CB.local(T_AC)": (
        "the outer frame of T_CB is C, the outer frame of T_AC is A",
        "T_CB.local(T_AC.inverse())",
    ),
    "T_AB.local(T_CB)": (
        "the outer frame of T_AB is A, the outer frame of T_CB is C",
        "T_AB.inverse().local(T_CB.inverse())",
    ),
    "T_AB @ p_A": ("the inner frame of T_AB is B, the frame of p_A is A", "T_AB.transform_to(p_A)"),
    "T_AB.transform_to(p_B)": (
        "the outer frame of T_AB is A, the frame of p_B is B",
        "T_AB.transform_from(p_B)",
    ),
    "T_AB @ p_C + 0 * (T_AB @ T_BC @ p_C)": (
        "the inner frame of T_AB is B, the frame of p_C is C",
        "T_BC.transform_from(p_C)",
    ),
    "T_AB @ v_B": ("v_B is a free vector in B", "T_AB.rotation @ v_B"),
    "T_AB.transform_to(v_A)": ("v_A is a free vector in A", "T_AB.rotation.unrotate(v_A)"),
    "T_AB.transform_to(p_A - p2_A)": ("is a free vector in A", "T_AB.rotation.unrotate((p_A - p2_A))"),
    "P_AB @ P_AB.local(P_AB)[:2]": ("is a free vector in B", "P_AB.rotation @ P_AB.local(P_AB)[0:2]"),
    "D_IC.uncalibrate(l_A)": ("the inner frame of D_IC is C, the frame of l_A is A", None),
    "R_AB @ v_A": ("the inner frame of R_AB is B, the frame of v_A is A", "R_AB.unrotate(v_A)"),
    "R_AB.unrotate(v_B)": ("the outer frame of R_AB is A, the frame of v_B is B", "R_AB @ v_B"),
    "R_AB @ R_CB": ("the inner frame of R_AB is B, the outer frame of R_CB is C", "R_AB @ R_CB.inverse()"),
    "SE3(R_AB, p_B)": ("the outer frame of R_AB is A, the frame of p_B is B", "SE3(R_AB, R_AB @ p_B)"),
    "T_AB.retract(xi_A)": ("the body frame of T_AB is B, the frame of xi_A is A", "SE3.exp(xi_A) @ T_AB"),
    "R_AB.retract(v_A)": ("the body frame of R_AB is B, the frame of v_A is A", "SO3.exp(v_A) @ R_AB"),
    "T_AB @ SE3.exp(xi_A)": (
        "the inner frame of T_AB is B, the outer frame of SE3.exp(xi_A) is A",
        "SE3.exp(xi_A) @ T_AB",
    ),
    "p_A - p_B": ("p_A is in A, p_B is in B", None),
    "T_AB @ p_B - p_B": ("T_AB.transform_from(p_B) is in A, p_B is in B", "T_AB.transform_from(p_B)"),
    "R_AB @ v_B - v_B": ("R_AB @ v_B) is in A, v_B is in B", "R_AB @ v_B"),
    "T_AB.rotation @ p_B - p_A": ("a free vector and p_A a point, both in A", None),
    "v_A - p_A": ("v_A is a free vector and p_A a point, both in A", None),
    "p_A.local(v_A)": ("v_A is a free vector and p_A a point, both in A", None),
    "v_A + v_B": ("v_A is in A, v_B is in B", None),
    "dot(v_A, v_B)": ("v_A is in A, v_B is in B", None),
    "cross(v_A, v_B)": ("v_A is in A, v_B is in B", None),
    "v_A * v_B": ("v_A is in A, v_B is in B", None),
    "liegen.maximum(v_A, v_B)": ("v_A is in A, v_B is in B", None),
    "where(s > 0, v_A, v_B)": ("v_A is in A, v_B is in B", None),
    "p_A.between(p_B)": ("p_A is in A, p_B is in B", None),
    "p_A.retract(v_B)": ("p_A is in A, v_B is in B", None),
    "p_A.range(p_B)": ("p_B is in B, p_A is in A", None),
    "p_A[:2] - l_B": ("p_A[0:2] is in A, l_B is in B", None),
    "T_AB.range(p_B)": ("p_B is in B, T_AB.translation is in A", "T_AB.transform_from(p_B)"),
    "T_AB.bearing(p_B)": (
        "the outer frame of T_AB is A, the frame of p_B is B",
        "T_AB.transform_from(p_B)",
    ),
    "n_A.local(n_B)": ("n_A is in A, n_B is in B", None),
    "n_A.local(T_AB.bearing(p_A))": ("n_A is in A, S2.direction(T_AB.transform_to(p_A)) is in B", None),
    "n_A.vector - v_B": ("n_A.vector is in A, v_B is in B", None),
    "P_AB @ P_CB": ("the inner frame of P_AB is B, the outer frame of P_CB is C", "P_AB @ P_CB.inverse()"),
    "P_AB @ u_B": ("u_B is a free vector in B", "P_AB.rotation @ u_B"),
    "b_A.local(P_AB.bearing(l_A))": ("the outer frame of b_A is A", None),
    "R_AB.matrix() @ v_A": (
        "the inner frame of R_AB is B, the frame of v_A is A",
        "R_AB.unrotate(v_A)",
    ),
    "R_AB.matrix().T @ v_B": ("the outer frame of R_AB is A, the frame of v_B is B", "R_AB @ v_B"),
    "R_AB.matrix() @ R_CB.matrix() @ p_C": (
        "the inner frame of R_AB is B, the outer frame of R_CB is C",
        "R_AB @ R_CB.inverse()",
    ),
    "v_A / norm(v_A) - v_B": ("v_A / norm(v_A)) is in A, v_B is in B", None),
    "dot(v_A, v_A) * v_B + v_A": ("is in B, v_A is in A", None),
    "stack(p_A, v_B)[:3] - v_B": ("stack(p_A, v_B)[0:3] is in A, v_B is in B", None),
    "X_AB @ X_CB": ("the inner frame of X_AB is B, the outer frame of X_CB is C", "X_AB @ X_CB.inverse()"),
    "X_AB.local(X_CB)": (
        "the outer frame of X_AB is A, the outer frame of X_CB is C",
        "X_AB.inverse().local(X_CB.inverse())",
    ),
    "X_AB.retract(zeta_A)": (
        "the body frame of X_AB is B, the frame of zeta_A is A",
        "NavState.exp(zeta_A) @ X_AB",
    ),
    "X_AB.position - p_B": ("X_AB.position is in A, p_B is in B", "X_AB.pose.transform_from(p_B)"),
    "X_AB.velocity - v_B": ("X_AB.velocity is in A, v_B is in B", "X_AB.rotation @ v_B"),
    "X_AB.velocity - X_AB.position": ("a free vector and X_AB.position a point, both in A", None),
    "NavState(R_AB, p_B, v_A)": (
        "the outer frame of R_AB is A, the frame of p_B is B",
        "NavState(R_AB, R_AB @ p_B, v_A)",
    ),
    "Gal3(R_AB, p_A, v_B, s)": (
        "the outer frame of R_AB is A, the frame of v_B is B",
        "Gal3(R_AB, p_A, R_AB @ v_B, s)",
    ),
    "E_AB @ E_CB": ("the inner frame of E_AB is B, the outer frame of E_CB is C", "E_AB @ E_CB.inverse()"),
    "G_AB @ G_CB": ("the inner frame of G_AB is B, the outer frame of G_CB is C", "G_AB @ G_CB.inverse()"),
    "G_AB.velocity - v_B": ("G_AB.velocity is in A, v_B is in B", "G_AB.rotation @ v_B"),
    "K_IC.uncalibrate(p_A[:2] / p_A[2])": ("the inner frame of K_IC is C", None),
    "K_IC.uncalibrate(p_C[:2] / p_C[2]) - z_J": ("is in I, z_J is in J", None),
}  # fmt: skip


@pytest.mark.parametrize("body", REJECTED)
def test_what_does_not_fit_is_refused_with_frames_line_factor_and_repair(body):
    says, repair = REJECTED[body]
    with pytest.raises(DefinitionError) as error:
        made(body)
    text = str(error.value)
    assert text.startswith("<string>:2: made: ")
    assert says in text
    if repair is None:
        assert "write " not in text
        assert "frames=False" in text or "give a point a name such as p_W" in text
    else:
        assert text.endswith(f"; write {repair}")
        made(repair)  # what is proposed is accepted
    assert not made(body, frames=False).frames.typed


@pytest.mark.parametrize("body", REJECTED)
def test_untyped_names_never_produce_errors(body):
    names = [name for name in ARGUMENTS if name in compile(body, "body", "eval").co_names]
    assert not made(body, untyped=names).frames.typed
    typed = [name for name in names if "_" in name]
    # a pose without declared frames moves no free vector either
    alone = {"T_AB @ v_B", "T_AB.transform_to(v_A)", "P_AB @ u_B", "T_AB.transform_to(p_A - p2_A)"}
    for name in typed if len(typed) == 2 and body not in alone else []:
        assert made(body, untyped=[name]).frames.typed


def test_the_line_is_the_users():
    with pytest.raises(DefinitionError, match=r"test_frame_rules.py:\d+: chain: ") as error:

        @factor
        def chain(T_AB: SE3, T_CB: SE3, *, z_AC: SE3):
            product = T_AB @ T_CB  # here
            return z_AC.local(product)

    line = int(str(error.value).split(":")[1])
    assert "# here" in Path(__file__).read_text(encoding="utf-8").splitlines()[line - 1]


def test_a_tangent_vector_is_moved_by_the_rotation_alone():
    with pytest.raises(
        DefinitionError, match=r"write T_AB\.rotation @ T_AB\.rotation\.local\(T_AC\.rotation\)"
    ):
        made("T_AB.rotation.local(T_AC.rotation) - T_AB.rotation.log()")
