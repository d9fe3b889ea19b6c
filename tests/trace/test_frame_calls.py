"""Frames of factors that are called inside others, and the switch that turns the check off."""

from pathlib import Path

import numpy as np
import pytest

from liegen import (
    R3,
    SE3,
    SO3,
    factor,
    function,
    outputs,
    stack,
)
from liegen.errors import DefinitionError


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
    assert ": arguments: in moved (test_frame_calls.py:" in text
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
