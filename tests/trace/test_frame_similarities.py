"""Frames of similarities."""

from __future__ import annotations

import pytest

from liegen import R3, DefinitionError, Sim3, factor, stack


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
