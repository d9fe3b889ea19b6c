"""Frames: read from names and annotations, checked where a factor is written, reported for the noise."""

import string
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liegen
from liegen import (
    R1,
    R2,
    R3,
    R4,
    R6,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Cal3_S2,
    Cal3DS2,
    Sim3,
    cross,
    dot,
    factor,
    frames,
    function,
    norm,
    outputs,
    require,
    stack,
    where,
)
from liegen.emit.header import kernel_header
from liegen.emit.target import Options
from liegen.errors import DefinitionError
from liegen.explain import explanation
from liegen.trace import print_name, read_name

# names

TOKENS = st.builds(
    lambda head, tail: head + tail,
    st.sampled_from(string.ascii_uppercase),
    st.text(string.ascii_lowercase + string.digits, max_size=6),
)
STEMS = st.from_regex(r"[a-zA-Z][a-z0-9]*(_[a-z][a-z0-9]*)?", fullmatch=True)


@given(STEMS, st.lists(TOKENS, max_size=4).map(tuple))
def test_a_printed_name_reads_back(stem, tokens):
    name = print_name(stem, tokens)
    assert name.isidentifier()
    assert read_name(name) == (stem, tokens)


@pytest.mark.parametrize(
    ("name", "stem", "tokens"),
    [
        ("T_WB", "T", ("W", "B")),
        ("T_WB1", "T", ("W", "B1")),
        ("T_WBi", "T", ("W", "Bi")),
        ("T_World_Cam", "T", ("World", "Cam")),
        ("T_WorldCam", "T", ("World", "Cam")),
        ("p1_W", "p1", ("W",)),
        ("point_in_W", "point_in", ("W",)),
        ("T", "T", ()),
        ("W", "W", ()),
        ("lever", "lever", ()),
        ("lever_arm", "lever_arm", ()),
        ("T_Wb_x", "T_Wb_x", ()),
        ("x_1", "x_1", ()),
        ("_W", "", ("W",)),
    ],
)
def test_names(name, stem, tokens):
    assert read_name(name) == (stem, tokens)


# rules: a body, and what must be true of it

ARGUMENTS = {
    "T_AB": SE3, "T_BC": SE3, "T_AC": SE3, "T_CB": SE3, "T_DC": SE3, "P_AB": SE2, "P_BC": SE2, "P_CB": SE2,
    "R_AB": SO3, "R_BC": SO3, "R_CB": SO3, "Q_AB": SO2, "Q_BC": SO2, "q_AB": SO3, "p_A": R3, "p2_A": R3,
    "p_B": R3, "p_C": R3, "v_A": R3, "v2_A": R3, "v_B": R3, "d_A": R3, "d_B": R3, "t_AB": R3, "l_A": R2,
    "l_B": R2, "u_B": R2, "xi_A": R6, "xi_B": R6, "n_A": S2, "n_B": S2, "m_A": S2, "b_A": SO2, "b_B": SO2,
    "K_IC": Cal3_S2, "D_IC": Cal3DS2, "z_I": R2, "z_J": R2, "x": SE3, "y": SE3, "r": SO3, "q": R3, "w": R3,
    "n": S2,
    "K": Cal3_S2, "s": R1, "xi": R6, "c": R4,
}  # fmt: skip
NAMESPACE = {"cross": cross, "dot": dot, "norm": norm, "stack": stack, "where": where, "liegen": liegen}
NAMESPACE |= {m.__name__: m for m in (R1, R2, R3, SE2, SE3, SO2, SO3, S2)}


def made(body, untyped=(), **options):
    """A function of what the body names, with a scalar as its only variable."""
    used = [name for name in ARGUMENTS if name in compile(body, "body", "eval").co_names]
    space = dict(NAMESPACE)
    signature = ", ".join(["k: R1", *(["*"] if used else []), *(f"{u}: manifolds['{u}']" for u in used)])
    manifolds = {k: Annotated[m, frames()] if k in untyped else m for k, m in ARGUMENTS.items()}
    source = f"def made({signature}):\n    return outputs(r={body}, k=k)\n"
    exec(source, space | {"manifolds": manifolds, "outputs": outputs}, space)
    return function(**options)(space["made"])


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
    "T_AB @ p_C + 0 * (T_BC @ p_C)": (
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
    with pytest.raises(DefinitionError, match=r"test_frames.py:\d+: chain: ") as error:

        @factor
        def chain(T_AB: SE3, T_CB: SE3, *, z_AC: SE3):
            product = T_AB @ T_CB  # here
            return z_AC.local(product)

    line = int(str(error.value).split(":")[1])
    assert "# here" in Path(__file__).read_text(encoding="utf-8").splitlines()[line - 1]


# chains of any length

CHAIN = st.lists(st.sampled_from("ABCDE"), min_size=3, max_size=6)


@settings(max_examples=40, deadline=None)
@given(CHAIN, st.lists(st.booleans(), min_size=6, max_size=6), st.integers(0, 5))
def test_inner_indices_cancel_along_any_chain(path, turned, wrong):
    steps = list(pairwise(path))
    flipped = {k for k, turn in enumerate(turned[: len(steps)]) if turn}
    names = [f"T{k}_{b}{a}" if k in flipped else f"T{k}_{a}{b}" for k, (a, b) in enumerate(steps)]

    def chained(inverted):
        space = {"SE3": SE3}
        product = " @ ".join(f"{n}.inverse()" if k in inverted else n for k, n in enumerate(names))
        exec(f"def chained({', '.join(f'{n}: SE3' for n in names)}):\n    return {product}", space)
        return function(space["chained"])

    assert chained(flipped).frames.rows == {"out": path[-1]}
    k = wrong % len(steps)
    (a, b), mistaken = steps[k], flipped ^ {k}
    if a == b:
        assert chained(mistaken).frames.rows == {"out": path[-1]}
    else:
        with pytest.raises(DefinitionError, match="frame of"):
            chained(mistaken)


# the documents' identities


def test_inner_indices_cancel():
    """Identity 6: T_AB T_BC = T_AC, T_WB^-1 = T_BW."""

    @factor
    def identity(T_AB: SE3, T_BC: SE3, *, T_AC: SE3):
        return T_AC.local(T_AB @ T_BC)

    assert identity.frames.residual == "C"
    with pytest.raises(DefinitionError, match="the inner frame of T_AB is B, the outer frame of T_CA is C"):

        @factor
        def mistaken(T_AB: SE3, T_CA: SE3, *, T_AC: SE3):
            return T_AC.local(T_AB @ T_CA)

    @factor
    def inverse(T_WB: SE3, *, T_BW: SE3):
        return T_BW.local(T_WB.inverse())

    assert inverse.frames.noise == "W"


def test_projection():
    """Identity 7: pixels = K (T_WC)^-1 p_W."""

    @factor
    def projection(T_WC: SE3, p_W: R3, *, K_IC: Cal3_S2, z_I: R2):
        q = T_WC.inverse() @ p_W
        require(q[2] > 0, "point behind the camera")
        return K_IC.uncalibrate(q[:2] / q[2]) - z_I

    assert projection.frames.noise == "I"
    assert projection.frames.columns == {"T_WC": "C", "p_W": "W"}
    with pytest.raises(DefinitionError, match=r"; write T_CW.transform_from\(p_W\)"):

        @factor
        def mistaken(T_CW: SE3, p_W: R3, *, K: Cal3_S2, z: R2):
            q = T_CW.transform_to(p_W)
            return K.uncalibrate(q[:2] / q[2]) - z


# what is inferred


@factor
def between(T_WA: SE3, T_WB: SE3, *, z: SE3):
    return z.local(T_WA.between(T_WB))


def test_between_answers_the_documents_question():
    assert between.frames.noise == between.frames.residual == "B"
    assert between.frames.columns == {"T_WA": "A", "T_WB": "B"}
    assert between.frames.arguments["z"] == ("A", "B")
    text = explanation(between)
    assert "z: pose of B in A (inferred)" in text
    assert "res: tangent vector in B; noise in B" in text
    assert "res_D_T_WA: columns in A" in text
    assert "with T_WA fixed, T_WB has covariance S in frame B" in text
    assert "with T_WB fixed, T_WA has covariance Ad(z) S Ad(z)^T in frame A" in text


def test_the_frame_of_the_columns_is_that_of_the_noise_that_explains_them():
    """res_D_T_WA S_A res_D_T_WA^T with S_A = Ad_z S Ad_z^T is S again at zero residual: columns are in A."""
    rng = np.random.default_rng(5)
    x, z = SE3.exp(rng.normal(size=6)), SE3.exp(rng.normal(size=6))
    J = between.jacobians(x, x @ z, z=z)["res_D_T_WA"]
    L = rng.normal(size=(6, 6))
    S = L @ L.T
    np.testing.assert_allclose(J @ (z.adjoint() @ S @ z.adjoint().T) @ J.T, S, rtol=1e-12, atol=1e-12)


def test_untyped_names_are_described():
    @factor
    def untyped(x: SE3, y: SE3, p: R3, *, z: SE3, s: R3):
        return stack(z.local(x.between(y)), p - s)

    report = untyped.frames
    assert not report.typed
    assert report.arguments == {}
    assert report.rows == {"res": "the body frame of z (rows 0:6), the frame of p (rows 6:9)"}
    assert report.columns == {
        "x": "the body frame of x", "y": "the body frame of y", "p": "the frame of p"
    }  # fmt: skip
    assert untyped.kernel.frames == ()


def test_stacked_residuals_have_a_frame_for_each_part():
    @factor
    def two(T_AB: SE3, *, p_A: R3, v_A: R3, v_B: R3, z: R1):
        return stack(T_AB.translation - p_A, T_AB.rotation.unrotate(v_A) - v_B, z)

    assert two.frames.residual == "A (rows 0:3), B (rows 3:6)"


def test_directions_have_a_basis():
    @factor
    def seen(T_AB: SE3, n_B: S2, *, p_A: R3):
        return n_B.local(T_AB.bearing(p_A))

    assert seen.frames.lines[-3:] == (
        "res: tangent vector in B, in the tangent basis at n_B; noise in that basis",
        "res_D_T_AB: columns in B",
        "res_D_n_B: columns in B, in the tangent basis at n_B",
    )


def test_functions_report_every_output():
    @function
    def step(R_WB: SO3, v_W: R3, p_W: R3, *, w_B: R3, a_B: R3, dt: R1):
        a_W = R_WB @ a_B
        return outputs(R=R_WB @ SO3.exp(w_B * dt), v=v_W + a_W * dt, p=p_W + v_W * dt + a_W * dt * dt / 2)

    assert step.frames.rows == {"v": "W", "p": "W"}
    assert "v_D_R_WB: columns in B" in step.frames.lines
    assert "p: point in W; noise in W" in step.frames.lines
    assert "v: free vector in W; noise in W" in step.frames.lines


# annotations, switches, inlining


def test_annotations_declare_frames():
    @factor
    def annotated(
        x: Annotated[SE3, frames("map", "robot")],
        y: Annotated[R3, frames("map", point=True)],
        T_XY: Annotated[SE3, frames("robot", "lidar")],
        z_Q: Annotated[R3, frames()],
    ):
        return (x @ T_XY).transform_to(y) - z_Q

    assert annotated.frames.residual == "lidar"
    assert annotated.frames.arguments["T_XY"] == ("robot", "lidar")
    assert annotated.frames.arguments["z_Q"] == ("lidar",)
    with pytest.raises(DefinitionError, match=r"x is robot, .* of y is lidar; write x @ y.inverse\(\)"):

        @factor
        def mistaken(x: Annotated[SE3, frames("map", "robot")], y: Annotated[SE3, frames("lidar", "robot")]):
            return (x @ y).log()

    with pytest.raises(DefinitionError, match="y is a free vector in robot"):

        @factor
        def moved(x: Annotated[SE3, frames("map", "robot")], y: Annotated[R3, frames("robot", point=False)]):
            return x @ y


@pytest.mark.parametrize(
    ("annotation", "says"),
    [
        (Annotated[SE3, frames("W")], "argument 'x': SE3 has 2 frames, frames('W') names 1"),
        (Annotated[S2, frames("W", "B")], "argument 'x': S2 has 1 frame, frames('W', 'B') names 2"),
        (Annotated[R1, frames("W")], "argument 'x': R1 has no frames, frames('W') names 1"),
        (Annotated[float, frames("W")], "argument 'x' is annotated with float, which is no manifold"),
    ],
)
def test_wrong_annotations(annotation, says):
    def wrong(x):
        return x

    wrong.__annotations__["x"] = annotation
    with pytest.raises(DefinitionError) as error:
        factor(wrong)
    assert says in str(error.value)
    assert "test_frames.py" in str(error.value)


def test_a_frame_needs_a_name():
    with pytest.raises(DefinitionError, match="a frame needs a name"):
        frames("W", "")


def test_frames_can_be_turned_off():
    @factor(frames=False)
    def left_right(p_L: R3, p_R: R3, *, T_AB: SE3):
        return T_AB @ p_L - p_R

    assert left_right.frames.lines == ()
    assert left_right.fix("p_R").frames.lines == ()

    @factor
    def around(T_WC: SE3, p_C: R3, *, p_W: R3):
        return left_right(p_W, p_W, T_AB=T_WC) + (T_WC @ p_C - p_W)

    assert around.frames.residual == "W"  # of p_W, the other summand tells nothing
    np.testing.assert_allclose(
        np.asarray(left_right([1, 2, 3.0], [0, 0, 1.0], T_AB=SE3.identity())), [1, 2, 2], atol=1e-15
    )


@function
def moved(T_AB: SE3, p_B: R3):
    return T_AB @ p_B


@function
def turned(R_AB: SO3, v_B: R3):
    return R_AB @ v_B


def test_inlined_factors_keep_frames():
    @factor
    def outer(T_WC: SE3, *, p_C: R3, p_W: R3):
        return moved(T_WC, p_C) - p_W

    assert outer.frames.residual == "W"
    with pytest.raises(DefinitionError, match=r"T_WC.transform_from\(p_C\) is in W, p_D is in D"):

        @factor
        def result(T_WC: SE3, *, p_C: R3, p_D: R3):
            return moved(T_WC, p_C) - p_D

    with pytest.raises(DefinitionError) as error:

        @factor
        def arguments(T_WC: SE3, *, p_D: R3, p_W: R3):
            return moved(T_WC, p_D) - p_W  # called

    text = str(error.value)
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    assert "# called" in lines[int(text.split(":")[1]) - 1]
    assert ": arguments: in moved (test_frames.py:" in text
    assert "the inner frame of T_WC is C, the frame of p_D is D" in text


def test_a_call_asks_for_the_kinds_and_frames_that_were_declared():
    with pytest.raises(
        DefinitionError, match="turned: argument 'v_B' is a free vector in B, it is given a point"
    ):

        @factor
        def kind(R_WC: SO3, *, p_C: R3):
            return turned(R_WC, p_C)

    @function
    def first(T_AB: SE3, T_AC: SE3):
        return outputs(a=T_AB.rotation, b=T_AC.rotation)

    with pytest.raises(
        DefinitionError, match="first: argument 'T_AC' is given with frame X where its A is W"
    ):

        @factor
        def frame(T_WB: SE3, T_XC: SE3):
            both = first(T_WB, T_XC)
            return stack(both.a.log(), both.b.log())

    @factor
    def untyped(x: SE3, y: SE3):
        both = first(x, y)
        return stack(both.a.log(), both.b.log(), moved(x, moved(y, [1.0, 2.0, 3.0])))

    assert not untyped.frames.typed

    @factor
    def learned(x: SE3, T_XC: SE3, *, p_B: R3, p_W: R3):
        both = first(x, T_XC)  # x seems to be in W, T_XC is not: no declared names disagree
        return stack(both.a.log(), both.b.log(), x @ p_B - p_W)

    assert learned.frames.columns == {"x": "B", "T_XC": "C"}


def test_bound_arguments_are_constants():
    bound = between.bind(T_WA=SE3.identity(), name="bound")
    assert bound.frames.residual == "B"
    assert "T_WA" not in bound.frames.arguments
    fixed = between.fix("T_WA", name="fixed")
    assert fixed.frames.columns == {"T_WB": "B"}


# where it is printed


def test_headers_state_frames_of_typed_factors_only():
    def header(f):
        return kernel_header(f.kernel, Options(package="p", regenerate="liegen generate"))

    typed = header(between)
    start = typed.index("Frames:")
    assert typed[start + 1 : start + 1 + len(between.frames.lines)] == tuple(
        f"  {line}" for line in between.frames.lines
    )
    from liegen.library import between_se3

    assert "Frames:" not in header(between_se3)
    assert between_se3.frames.noise == "the body frame of z"


# the documentation

DOCUMENT = (Path(__file__).resolve().parents[2] / "docs" / "frames.md").read_text(encoding="utf-8")


def test_the_document_shows_what_is_printed():
    code, printed = DOCUMENT.partition("```python\n")[2], DOCUMENT.partition("```text\n")[2]
    space = {"factor": factor, "SE3": SE3}
    exec(code.partition("```")[0], space)
    assert printed.partition("```")[0] in explanation(space["between"])


@pytest.mark.parametrize("body", ["(T_AB @ T_CB).log()", "T_WC @ p_W"])
def test_the_document_shows_the_messages(body):
    names = {"T_AB": SE3, "T_CB": SE3, "T_WC": SE3, "p_W": R3}
    used = [name for name in names if name in body]
    space = {"names": names}
    exec(f"def f({', '.join(f'{n}: names[{n!r}]' for n in used)}):\n    return {body}", space)
    with pytest.raises(DefinitionError) as error:
        function(space["f"])
    message = str(error.value).partition("f: ")[2]
    assert any(line.endswith(message) for line in DOCUMENT.splitlines())


# similarities


def test_similarities_take_frames_as_poses_do():
    @factor
    def closing(S_WA: Sim3, S_WB: Sim3, p_A: R3, *, S_AB: Sim3):
        return stack(S_AB.local(S_WA.between(S_WB)), S_WB.transform_to(S_WA @ p_A))

    report = closing.graph.frames
    assert "S_WA: similarity from A to W" in report.lines
    assert [line for line in report.lines if line.startswith("res_D_")] == [
        "res_D_S_WA: columns in A", "res_D_S_WB: columns in B", "res_D_p_A: columns in A",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "cure"),
    [
        (lambda S_WA, S_WB, p_A, v_A: S_WA.compose(S_WB).log(), "write S_WA.inverse() @ S_WB"),
        (lambda S_WA, S_WB, p_A, v_A: S_WA.transform_to(p_A), "write S_WA.transform_from(p_A)"),
        (lambda S_WA, S_WB, p_A, v_A: S_WA.transform_from(v_A), "is a free vector in A"),
        (lambda S_WA, S_WB, p_A, v_A: p_A + S_WA.translation, "S_WA.transform_from(p_A)"),
    ],
)
def test_mistaken_frames_of_similarities_are_refused(wrong, cure):
    def mistaken(S_WA: Sim3, *, S_WB: Sim3, p_A: R3, v_A: R3):
        return wrong(S_WA, S_WB, p_A, v_A)

    with pytest.raises(DefinitionError) as refused:
        _ = factor(mistaken).graph
    assert cure in str(refused.value)
