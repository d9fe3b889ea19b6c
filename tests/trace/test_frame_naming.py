"""How names are read: liegen's own, those of GTSAM, SymForce, Kalibr, OpenVINS, ROS; and what is not read."""

import pytest

from liegen import R3, R6, S2, SE3, SO2, SO3, NavState, Sim3, factor
from liegen.errors import DefinitionError
from liegen.trace.frame_declared import as_read

READ = [
    # liegen's own
    ("T_WB", SE3, "W B"), ("T_WB1", SE3, "W B1"), ("T_W1B2", SE3, "W1 B2"), ("T_WBi", SE3, "W Bi"),
    ("T_W_B", SE3, "W B"), ("T_World_Cam", SE3, "World Cam"), ("T_WCam", SE3, "W Cam"), ("x_WB", SE3, "W B"),
    ("T_W_IMU", SE3, "W IMU"), ("T_IMU_CAM", SE3, "IMU CAM"), ("T_IMU0_Cam", SE3, "IMU0 Cam"),
    ("T_Map_BaseLink", SE3, "Map BaseLink"), ("R_WB", SO3, "W B"), ("X_WB", NavState, "W B"),
    ("S_WB", Sim3, "W B"), ("R_WB", SO2, "W B"), ("b_W", SO2, "W"), ("T_T_B", SE3, "T B"),
    ("T_B1B2", SE3, "B1 B2"), ("T_B2B1", SE3, "B2 B1"), ("R_S_B", SO3, "S B"),
    ("p_W", R3, "W"), ("p1_W", R3, "W"), ("point_in_W", R3, "W"), ("v_W", R3, "W"), ("z_B", R3, "B"),
    ("t_WB", R3, "W B"), ("t_World_Cam", R3, "World Cam"), ("p_WCam", R3, "W Cam"), ("xi_B", R6, "B"),
    ("p_BaseLink", R3, "BaseLink"), ("v_BaseFootprint", R3, "BaseFootprint"), ("p_ENU", R3, "ENU"),
    ("a_IMU", R3, "IMU"), ("p_CAM1", R3, "CAM1"), ("n_W", S2, "W"), ("n_BaseLink", S2, "BaseLink"),
    # SymForce, Kalibr
    ("world_T_body", SE3, "world body"), ("body_T_cam0", SE3, "body cam0"), ("W_T_B", SE3, "W B"),
    ("B_T_C", SE3, "B C"), ("W_R_B", SO3, "W B"), ("world_R_body", SO3, "world body"),
    ("Map_T_BaseLink", SE3, "Map BaseLink"), ("C_T_B", SE3, "C B"), ("W_p_B", R3, "W"), ("W_v_B", R3, "W"),
    ("I_r_IB", R3, "I"), ("B_v_WB", R3, "B"),
    # GTSAM
    ("wTb", SE3, "w b"), ("bTc", SE3, "b c"), ("w1Tb2", SE3, "w1 b2"), ("wTbi", SE3, "w bi"),
    ("nRb", SO3, "n b"), ("body_P_sensor", SE3, "body sensor"),
    # OpenVINS, MSCKF: R_GtoI takes vectors of G to I
    ("R_GtoI", SO3, "I G"), ("q_GtoI", SO3, "I G"), ("R_ItoC0", SO3, "C0 I"), ("T_ItoC", SE3, "C I"),
    ("p_IinG", R3, "G I"), ("v_IinG", R3, "G I"), ("p_FinG", R3, "G F"), ("g_inG", R3, "G"),
    ("T_IinG", SE3, "G I"), ("p_I_in_G", R3, "G I"), ("T_I_in_G", SE3, "G I"),
    # "from" is clear
    ("world_from_body", SE3, "world body"), ("T_world_from_body", SE3, "world body"),
    ("T_W_from_B", SE3, "W B"), ("W_from_B", SE3, "W B"),
    # ROS
    ("map_T_base_link", SE3, "map base_link"), ("base_link_T_laser", SE3, "base_link laser"),
]  # fmt: skip
NOT_READ = [
    ("T_WIMU", SE3, "not parted"), ("T_WorldCam", SE3, "one frame or two, as in T_World_Cam"),
    ("T_BaseLink", SE3, "one frame or two"), ("T_MainCam", SE3, "one frame or two"),
    ("T_WB_C", SE3, "one frame or two"), ("T_W_B_C", SE3, "3 frames"), ("T_W", SE3, "one frame, where two"),
    ("T_wb", SE3, "indices"), ("T_ij", SE3, "indices"), ("T_gt", SE3, "indices"), ("Twb", SE3, "indices"),
    ("T_cam_imu", SE3, "not parted"), ("T_map_base_link", SE3, "not parted"), ("TWB", SE3, "no underscore"),
    ("R_wc", SO3, "indices"), ("bodyTcam", SE3, "not parted"), ("T_01", SE3, "numbers"),
    ("cam_to_world", SE3, "differs between libraries"), ("T_W_to_B", SE3, "differs between libraries"),
    ("T_WorldToCam", SE3, "differs between libraries"), ("map_to_odom", SE3, "differs between libraries"),
    ("T_B2C", SE3, "B to C"), ("T_WB_prior", SE3, "at the end"), ("T_WB1_meas", SE3, "at the end"),
    ("T_GT", SE3, "true value"), ("p_GT", R3, "true value"), ("pose_T_B", SE3, "may be a frame"),
    ("X_T_B", SE3, "may be a frame"), ("world_T_B", SE3, "may be a frame"), ("R_T_B", SO3, "may be a frame"),
    ("delta_R_ij", SO3, "no frame"), ("delta_T_k", SE3, "no frame"), ("pose_from_gps", SE3, "no frame"),
    ("W_T_W", SE3, "both frames"), ("T_W", NavState, "one frame, where two"),
    ("b_A", R3, "bias"), ("b_G", R3, "bias"), ("b_Acc", R3, "bias"), ("ba_A", R3, "bias"),
    ("bias_G", R3, "bias"), ("sigma_A", R3, "bias"), ("p_w", R3, "indices"), ("world_t_body", R3, "indices"),
    ("p_LMX", R3, "not parted"), ("wP", R3, "no underscore"), ("nVb", R3, "no underscore"),
    ("n_WB", S2, "two frames"),
]  # fmt: skip
SILENT = [
    ("x", SE3), ("T", SE3), ("pose", SE3), ("T_base", SE3), ("x_1", SE3), ("prior", SE3), ("lever_arm", R3),
    ("z", R3), ("gyro_bias", R3), ("lastTransform", SE3), ("v", R3), ("omega_dt", R3),
]  # fmt: skip


@pytest.mark.parametrize(("name", "kind", "expected"), READ)
def test_read(name, kind, expected):
    reading = as_read(name, kind)
    assert reading.names == tuple(expected.split())
    assert not reading.note


@pytest.mark.parametrize(("name", "kind", "why"), NOT_READ)
def test_not_read_with_a_note(name, kind, why):
    reading = as_read(name, kind)
    assert reading.names == ()
    assert why in reading.note


@pytest.mark.parametrize(("name", "kind"), SILENT)
def test_names_that_say_nothing(name, kind):
    assert as_read(name, kind).names == ()
    assert as_read(name, kind).note == ""


def test_the_table_is_long():
    assert len(READ) + len(NOT_READ) >= 60


def test_frames_of_a_pose_between_letters():
    @factor
    def seen(W_T_B: SE3, B_T_C: SE3, p_W: R3, *, z: R3):
        return (W_T_B @ B_T_C).transform_to(p_W) - z

    assert seen.frames.arguments["W_T_B"] == ("W", "B")
    assert seen.frames.arguments["z"] == ("C",)
    assert "W_T_B: W, B (as in W_T_B)" in seen.frames.names


def test_frames_of_two_words():
    def seen(T_Map_BaseLink: SE3, p_BaseLaser: R3, *, q_Map: R3):
        return T_Map_BaseLink @ p_BaseLaser - q_Map

    with pytest.raises(
        DefinitionError, match=r"of T_Map_BaseLink is BaseLink, .* p_BaseLaser is BaseLaser; re"
    ):
        factor(seen)


def test_rotations_of_openvins_turn_as_they_say():
    @factor
    def seen(R_GtoI: SO3, p_IinG: R3, p_FinG: R3, R_ItoC: SO3, p_IinC: R3, *, z: R3):
        return R_ItoC @ (R_GtoI @ (p_FinG - p_IinG)) + p_IinC - z

    assert seen.frames.residual == "C"

    def wrong(R_GtoI: SO3, p_FinG: R3, *, z: R3):
        return R_GtoI.unrotate(p_FinG) - z

    with pytest.raises(DefinitionError, match=r"write R_GtoI @ p_FinG$"):
        factor(wrong)


def test_names_of_different_kinds_may_mean_one_frame():
    @factor
    def seen(world_T_body: SE3, wTb: SE3, p_W: R3, *, q_World: R3):
        return world_T_body.transform_to(p_W) - world_T_body.transform_to(q_World) + wTb.transform_to(p_W)

    assert seen.frames.arguments["world_T_body"] == ("world", "body")
    with pytest.raises(DefinitionError, match="is B1"):

        @factor
        def other(T_WB: SE3, p_B1: R3):
            return T_WB @ p_B1


def test_biases_are_in_no_frame():
    @factor
    def moved(T_AG: SE3, b_A: R3, b_G: R3, *, z: R3):
        return z - b_A - b_G - T_AG.translation

    assert "b_A: none, a sensor's bias or noise, no frame" in moved.frames.names
