"""In which frames residual, noise and columns are, and where it is printed."""

from pathlib import Path

import numpy as np
import pytest

from liegen import (
    R1,
    R3,
    S2,
    SE2,
    SE3,
    SO3,
    Chart,
    Product,
    factor,
    function,
    library,
    outputs,
    stack,
)
from liegen.emit.header import kernel_header
from liegen.emit.target import Options
from liegen.errors import DefinitionError
from liegen.explain import explanation


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
    assert untyped.kernel.frames == report.lines


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


def test_bound_arguments_are_constants():
    bound = between.bind(T_WA=SE3.identity(), name="bound")
    assert bound.frames.residual == "B"
    assert "T_WA" not in bound.frames.arguments
    fixed = between.fix("T_WA", name="fixed")
    assert fixed.frames.columns == {"T_WB": "B"}


def header(f):
    return kernel_header(f.kernel, Options(package="p", regenerate="liegen generate"))


@pytest.mark.parametrize("f", [between, library.between_se3, library.range_se3_r3], ids=lambda f: f.name)
def test_headers_state_the_frames_of_factors(f):
    lines = header(f)
    start = lines.index("Frames:")
    assert f.frames.lines
    assert lines[start + 1 : start + 1 + len(f.frames.lines)] == tuple(f"  {line}" for line in f.frames.lines)


def test_headers_of_functions_state_declared_frames_only():
    @function
    def moved(x: SE3, p: R3):
        return x @ p

    @function
    def seen(T_AB: SE3, p_B: R3):
        return T_AB @ p_B

    @factor(frames=False)
    def off(x: SE3, y: SE3):
        return x.local(y)

    assert "Frames:" not in header(moved)
    assert "Frames:" not in header(off)
    assert "  out: point in A; noise in A" in header(seen)


def test_another_chart_is_named_where_its_columns_are_elsewhere():
    lines = library.between_se3.in_chart("ceres").frames.lines
    assert "chart ceres: columns of x; order and scale are under Conventions" in lines
    assert "chart ceres: local, rows and noise; order and scale are under Conventions" in lines
    assert not any("body frame of y" in line for line in lines)
    assert library.prior_s2.in_chart("ceres").frames.lines == library.prior_s2.frames.lines


class Rig(Product):
    T_WB: SE3
    v_W: R3


@pytest.mark.parametrize(
    ("chart", "columns", "noise"),
    [
        ("gtsam", "B", "C"),
        ("sophus", "B", "C"),
        ("g2o", "B", "C"),
        ("ceres", "W", "B"),
        ("ros", "W", "B"),
        (Chart(side="left"), "W", "B"),
        ("symforce", "B (columns 0:3), W (columns 3:6)", "C (rows 0:3), B (rows 3:6)"),
        (Chart("left", translation="body"), "W (columns 0:3), B (columns 3:6)", "B (rows 0:3), C (rows 3:6)"),
    ],
)
def test_frames_are_those_of_the_chart(chart, columns, noise):
    """z.local(y) of a pose z of C in B: a chart on the left or in the world is along B's axes."""

    @factor
    def edge(T_WB: SE3, T_WC: SE3, *, z_BC: SE3):
        return z_BC.local(T_WB.between(T_WC))

    found = edge.in_chart(chart).frames
    assert found.columns["T_WB"] == columns
    assert found.noise == found.residual == noise


def test_frames_of_the_plane_and_of_products_in_a_chart():
    @factor
    def flat(T_WB: SE2, *, z_WB: SE2):
        return -z_WB.local(T_WB)

    @factor
    def rig(x: Rig, *, z: Rig):
        return z.local(x)

    found = flat.in_chart("ceres").frames
    assert found.columns == {"T_WB": "W (columns 0:2), B (columns 2:3)"}
    assert found.noise == "W (rows 0:2), B (rows 2:3)"
    assert rig.in_chart("ceres").frames.columns == {"x": "W"}
    assert rig.frames.columns == {"x": "B of x (columns 0:6), W (columns 6:9)"}


def test_the_frame_of_a_charts_columns_is_the_one_in_which_they_turn():
    """Turning all of W, the axes of ceres' columns, leaves columns along W turned by it."""
    Q, q = SE3.exp([0.3, -0.2, 0.5, 0, 0, 0]), SO3.exp([0.3, -0.2, 0.5])
    x, y = SE3.exp([0.1, 0.7, -0.4, 1, 2, 3]), SE3.exp([-0.5, 0.2, 0.3, 2, 0, 1])
    z = y.inverse() @ x
    turn = np.kron(np.eye(2), np.asarray(q.matrix()).reshape(3, 3))
    f = library.between_se3.in_chart("ceres")
    D, E = (f.jacobians(a, b, z=z)["res_D_x"] for a, b in ((x, y), (Q @ x, Q @ y)))
    np.testing.assert_allclose(E @ turn, D, rtol=0, atol=1e-13)
    assert np.abs(E - D).max() > 0.1


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
