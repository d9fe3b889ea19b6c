"""Frames in names and in annotations."""

import string
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st

from liegen import (
    R1,
    R3,
    S2,
    SE3,
    factor,
    frames,
)
from liegen.errors import DefinitionError
from liegen.trace import print_name, read_name

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
    assert "test_frame_names.py" in str(error.value)


def test_a_frame_needs_a_name():
    with pytest.raises(DefinitionError, match="a frame needs a name"):
        frames("W", "")
