"""Frames of the parts of products: named in the class, renamed by arguments, checked part by part."""

from pathlib import Path
from typing import Annotated

import pytest

from liegen import (
    R1,
    R2,
    R3,
    R6,
    R9,
    SE3,
    Cal3_S2,
    Product,
    factor,
    frames,
    function,
    outputs,
    stack,
)
from liegen.errors import DefinitionError
from liegen.trace.frame_declared import class_frames, placed_frames


class State(Product):
    """W is of all, B is placed by the pose."""

    T_WB: SE3
    v_W: R3
    b_B: R6


class Rig(Product):
    T_BC: SE3
    K_IC: Cal3_S2


class Robot(Product):
    """A product of products; the suffix of a part renames what it begins with."""

    T_WB: SE3
    left: Rig
    right_C2: Rig


class Plain(Product):
    pose: SE3
    vel: R3


class Annotations(Product):
    place: Annotated[SE3, frames("map", "robot")]
    speed: Annotated[R3, frames("map", point=False)]
    gain: R3


def test_the_frames_that_a_class_names():
    assert class_frames(State) == ("W", "B")
    assert placed_frames(State) == ("B",)
    assert class_frames(Robot) == ("W", "B", "C", "I", "C2")
    assert placed_frames(Robot) == ("B", "C", "C2")
    assert class_frames(Plain) == ()
    assert class_frames(Annotations) == ("map", "robot")


def test_parts_have_the_frames_of_their_names():
    @factor
    def f(x: State, *, p_B: R3, p_W: R3):
        return x.T_WB @ p_B + x.v_W - p_W

    assert f.frames.residual == "W"
    assert f.frames.arguments["x.T_WB"] == ("W", "B")
    assert f.frames.arguments["x.b_B"] == ("B",)
    assert f.frames.columns == {"x": "B (columns 0:6), W (columns 6:9), B (columns 9:15)"}
    assert "x.v_W: free vector in W" in f.frames.lines


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("x.T_WB.transform_to(p_B)", "the outer frame of x.T_WB is W, the frame of p_B is B; "
                                     "write x.T_WB.transform_from(p_B)"),
        ("x.v_W - x.b_B[:3]", "x.v_W is in W, x.b_B[0:3] is in B; write x.T_WB.rotation.unrotate(x.v_W)"),
        ("x.T_WB @ x.v_W", "the inner frame of x.T_WB is B, the frame of x.v_W is W"),
        ("State(T_WB=x.T_WB, v_W=p_B, b_B=x.b_B).v_W",
         "part 'v_W' is given with frame B where its W is W by the others"),
        ("State(T_WB=x.T_WB, v_W=p_W, b_B=x.b_B).v_W",
         "part 'v_W' is a free vector in W, it is given a point"),
        ("x.retract(stack(xi_B, p_B, xi_B)).v_W", "x.v_W is in W, stack(xi_B, p_B, xi_B)[6:9] is in B"),
        ("x.local(y_V)[:3]", "the outer frame of x.T_WB is W, the outer frame of y_V.T_WB is V"),
    ],
)  # fmt: skip
def test_parts_that_do_not_fit(body, says):
    space = {"State": State, "SE3": SE3, "R3": R3, "R6": R6, "stack": stack}
    source = (
        f"def f(x: State, y_V: Other, *, p_B: R3, p_W: R3, xi_B: R6):\n    return outputs(r={body}, y=y_V)"
    )
    exec(source, space | {"outputs": outputs, "Other": Annotated[State, frames("V", "D")]}, space)
    with pytest.raises(DefinitionError) as error:
        function(space["f"])
    assert str(error.value).startswith("<string>:2: f: ")
    assert says in str(error.value)
    assert not function(frames=False)(space["f"]).frames.typed


def test_an_argument_renames_by_the_first_letters():
    @factor
    def f(x_B1: State, y_B2: State, *, T_B1B2: SE3):
        return T_B1B2.local(x_B1.T_WB.between(y_B2.T_WB))

    assert f.frames.residual == "B2"
    assert f.frames.arguments["y_B2.b_B"] == ("B2",)
    assert f.frames.columns["x_B1"].startswith("B1 (columns 0:6), W (columns 6:9)")
    with pytest.raises(DefinitionError, match=r"of T_B2B1 is B2, the outer frame of .* is B1"):

        @factor
        def mistaken(x_B1: State, y_B2: State, *, T_B2B1: SE3):
            return T_B2B1.local(x_B1.T_WB.between(y_B2.T_WB))


def test_the_longest_frame_is_renamed_and_none_twice():
    @factor
    def f(x_C2: Robot, y_C21: Robot, z_B1B2: Robot):
        poses = [a.T_WB @ a.right_C2.T_BC for a in (x_C2, y_C21, z_B1B2)]
        return stack(poses[0].between(poses[1]).log(), poses[2].log())

    known = f.frames.arguments
    assert known["x_C2.right_C2.T_BC"] == ("B of x_C2", "C2 of x_C2")
    assert known["y_C21.right_C2.T_BC"] == ("B of y_C21", "C21")
    assert known["z_B1B2.T_WB"] == ("W", "B of z_B1B2")


def test_a_name_that_fits_no_frame_of_the_class_says_nothing():
    @factor
    def f(x_K: State, *, v_W: R3):
        return x_K.v_W - v_W

    assert f.frames.arguments["x_K.T_WB"] == ("W", "B")


def test_annotated_names_all_frames_in_order():
    @factor
    def f(x: Annotated[State, frames("V", "C")], *, p_C: R3):
        return x.T_WB @ p_C

    assert f.frames.residual == "V"
    with pytest.raises(DefinitionError, match=r"argument 'x': State has 2 frames \(W, B\), frames\('V'\)"):

        @factor
        def g(x: Annotated[State, frames("V")]):
            return x.v_W

    @factor
    def without(x: Annotated[State, frames()], *, p: R3):
        return x.T_WB.transform_to(x.v_W) - p

    assert not without.frames.typed


def test_two_arguments_of_a_class_have_bodies_of_their_own():
    @factor
    def f(x: State, y: State, *, z: SE3):
        return z.local(x.T_WB.between(y.T_WB))

    assert f.frames.residual == "B of y"
    assert f.frames.arguments["z"] == ("B of x", "B of y")
    assert f.frames.columns["x"].startswith("B of x (columns 0:6), W (columns 6:9)")
    with pytest.raises(DefinitionError, match=r"of z\.T_WB is W, the outer frame of .* is B of x"):

        @factor
        def relative(x: State, y: State, *, z: State):  # what z measures is no state in W
            return z.local(x.between(y))

    @factor
    def measured(x: State, y: State, *, z: Annotated[State, frames()]):
        return z.local(x.between(y))

    assert measured.frames.residual == "B of y (rows 0:6), W (rows 6:9), B of x (rows 9:15)"

    @factor
    def extrinsic(x: State, y: State, *, T_BC: SE3, z: SE3):  # B of both is that of T_BC
        return z.local((x.T_WB @ T_BC).between(y.T_WB @ T_BC))

    assert extrinsic.frames.residual == "C"


def test_suffix_of_a_product_without_frames_is_that_of_its_poses():
    @factor
    def f(x_WB: Plain, *, p_B: R3, v_W: R3):
        return stack(x_WB.pose @ p_B, x_WB.vel - v_W)

    assert f.frames.residual == "W"
    assert f.frames.columns == {"x_WB": "B (columns 0:6), W (columns 6:9)"}
    assert "x_WB.vel: vector in W (inferred)" in f.frames.lines
    with pytest.raises(DefinitionError, match=r"write x_WB.pose.transform_to\(p_W\)"):

        @factor
        def g(x_WB: Plain, *, p_W: R3):
            return x_WB.pose @ p_W

    @factor
    def untyped(x: Plain, y: Plain):
        return x.local(y)

    assert not untyped.frames.typed
    assert untyped.frames.residual == "the body frame of x.pose (rows 0:6), the frame of x.vel (rows 6:9)"


def test_annotated_parts():
    @factor
    def f(x: Annotations, *, p: Annotated[R3, frames("robot", point=True)]):
        return x.place @ p + x.speed

    assert f.frames.residual == "map"
    assert f.frames.arguments["x.place"] == ("map", "robot")

    class Wrong(Product):
        T: Annotated[SE3, frames("W")]

    with pytest.raises(DefinitionError, match="argument 'x': part 'T': SE3 has 2 frames"):

        @factor
        def g(x: Wrong):
            return x.T.log()


def test_nested_products_and_cameras():
    @factor
    def f(x: Robot, *, p_W: R3, z_I: R2):
        q = (x.T_WB @ x.right_C2.T_BC).transform_to(p_W)
        return x.right_C2.K_IC.uncalibrate(q[:2] / q[2]) - z_I

    assert f.frames.residual == "I"
    assert f.frames.arguments["x.right_C2.T_BC"] == ("B", "C2")
    assert f.frames.columns == {"x": "B (columns 0:6), C (columns 6:12), C2 (columns 17:23)"}
    with pytest.raises(DefinitionError, match=r"of x\.left\.K_IC is C, the frame of .* is C2"):

        @factor
        def other_camera(x: Robot, *, p_W: R3, z_I: R2):
            q = (x.T_WB @ x.right_C2.T_BC).transform_to(p_W)
            return x.left.K_IC.uncalibrate(q[:2] / q[2]) - z_I


@function
def seen(x: State, p_B: R3):
    return x.T_WB @ p_B


@function
def step(x: State, y: State):
    return x.T_WB.between(y.T_WB)


def test_calls_with_products():
    @factor
    def f(a_B1: State, *, p_B1: R3, p_W: R3):
        return seen(a_B1, p_B1) - p_W

    assert f.frames.residual == "W"
    with pytest.raises(DefinitionError, match=r"of a_B1\.T_WB is B1, the frame of p_B2 is B2"):

        @factor
        def g(a_B1: State, *, p_B2: R3):
            return seen(a_B1, p_B2)

    @factor
    def both(a_B1: State, a_B2: State):
        return step(a_B1, a_B2).log()

    assert both.frames.residual == "B1"
    with pytest.raises(DefinitionError, match=r"argument 'y\.T_WB' is given with frame V where its W is W"):

        @function
        def apart(a_B1: State, a: Annotated[State, frames("V", "B2")]):
            return outputs(r=unrelated(a_B1, a), a=a_B1)


@function
def unrelated(x: State, y: State):
    return y.v_W + 0 * x.v_W[0]


class Moving(Product):
    """A bias is compared at two times: it is given no frame."""

    T_WB: SE3
    v_W: R3
    bias: R6


def test_group_operations_part_by_part():
    @function
    def f(x_B1: Moving, y_B2: Moving, *, d: R9):
        z = stack(d, 0 * d[:6])
        return outputs(
            d=x_B1.local(y_B2.inverse().inverse()),
            r=x_B1.retract(z).local(y_B2),
            l=x_B1.log(),
            e=x_B1.local(Moving.exp(y_B2.log())),
        )

    rows = f.frames.rows
    assert rows["d"] == "B1 (rows 0:6), W (rows 6:9), the frame of x_B1.bias (rows 9:15)"
    assert rows["r"] == "B2 (rows 0:6), W (rows 6:9), the frame of x_B1.bias (rows 9:15)"
    assert rows["l"] == "W (rows 0:9), the frame of x_B1.bias (rows 9:15)"
    assert rows["e"].startswith("B1 (rows 0:6), W (rows 6:9)")
    with pytest.raises(DefinitionError, match=r"x_B1\.b_B is in B1, y_B2\.b_B is in B2"):

        @factor
        def biases(x_B1: State, y_B2: State):
            return x_B1.local(y_B2)


DOCUMENT = (Path(__file__).resolve().parents[2] / "docs" / "frames.md").read_text(encoding="utf-8")


def test_the_class_of_the_document():
    space = {"Product": Product, "Annotated": Annotated, "frames": frames, "SE3": SE3, "R3": R3, "R1": R1}
    exec(DOCUMENT.partition("```py\n")[2].partition("```")[0], space)
    written = space["State"]
    assert class_frames(written) == ("W", "B", "L")
    assert placed_frames(written) == ("B", "L")
    stated = Annotated[written, frames("V", "B1", "L")]
    for annotation, name, found in (
        (written, "x", ("B", "L")), (written, "x_B1", ("B1", "L")), (stated, "x", ("B1", "L"))
    ):  # fmt: skip
        body = f"def f({name}: kind):\n    return {name}.lidar.log()"
        exec(body, space | {"kind": annotation}, space)
        assert factor(space["f"]).frames.arguments[f"{name}.lidar"] == found
    exec("def f(x: kind):\n    return x.T_WB @ x.v_W", space | {"kind": written}, space)
    with pytest.raises(DefinitionError, match=r"of x\.T_WB is B, the frame of x\.v_W is W"):
        factor(space["f"])
