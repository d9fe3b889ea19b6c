"""Products: parts, construction, charts, groups or not, in the residual language, emission, errors."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import product_factors
import pytest
from group_tools import BOUND, worst
from product_factors import HOME, Camera, Sighting, State, prior_state, step

from liegen import R1, R2, R3, R6, SE3, SO3, Cal3_S2, DefinitionError, Product, factor, library
from liegen.define import Function
from liegen.verify import verify

FACTORS = {f.name: f for f in vars(product_factors).values() if isinstance(f, Function)}
POSE = SE3(SO3.exp([0.1, 0.2, 0.3]), [1.0, 2.0, 3.0])
BIAS = np.arange(6.0)


def state(**changes):
    return State(**{"pose": POSE, "vel": R3(4, 5, 6), "bias": R6.from_storage(BIAS), **changes})


@pytest.mark.parametrize("name", [n for n, f in FACTORS.items() if f.is_factor])
def test_factors_against_the_reference(name):
    errors = worst(FACTORS[name])
    assert max(error for error, _ in errors.values()) <= BOUND, errors


def test_every_check_of_verify_passes():
    """C and NumPy against the reference too, differences, remainders."""
    chosen = [FACTORS[name] for name in ("prior_state", "projection", "sighting", "step")]
    report = verify(chosen, samples=10, seed=1, workers=1)
    failed = [
        (f.factor, c.name, c.worst, c.bound, c.where, c.note)
        for f in report.factors
        for c in f.checks
        if not c.passed
    ]
    assert not failed


def test_storage_is_the_parts_in_order():
    x = state()
    np.testing.assert_array_equal(np.asarray(x), [*np.asarray(POSE), 4, 5, 6, *BIAS])
    assert State.form.storage[:8] == (*(f"pose_{s}" for s in SE3.form.storage), "vel_x")
    assert State.form.dim == 15
    assert State.form.tangent[0] == "pose_rx [rad]"
    assert isinstance(x.pose, SE3)
    assert isinstance(x.vel, R3)
    np.testing.assert_array_equal(np.asarray(x.bias), BIAS)
    assert Sighting.form.storage[-16] == "state_pose_qx"
    nested = Sighting.from_storage(np.arange(21.0))
    np.testing.assert_array_equal(np.asarray(nested.state.vel), [12, 13, 14])


def test_batches():
    x = State.from_storage(np.stack([np.asarray(state()), np.asarray(HOME)]))
    assert np.asarray(x.vel).shape == (2, 3)
    assert np.asarray(x.compose(x)).shape == (2, 16)
    np.testing.assert_array_equal(np.asarray(x.inverse())[0], np.asarray(state().inverse()))
    assert prior_state.jacobians(np.asarray(x), z=np.asarray(HOME))["res_D_x"].shape == (2, 15, 15)


def test_group_operations_are_those_of_the_parts():
    a, b = state(), state(pose=POSE.inverse(), vel=R3(1, 0, 2))
    c = a @ b
    np.testing.assert_array_equal(np.asarray(c.pose), np.asarray(POSE @ POSE.inverse()))
    np.testing.assert_array_equal(np.asarray(c.vel), [5, 5, 8])
    d = np.linspace(-1, 1, 15)
    moved = a.retract(d)
    np.testing.assert_array_equal(np.asarray(moved.pose), np.asarray(POSE.retract(d[:6])))
    np.testing.assert_array_equal(np.asarray(moved.bias), BIAS + d[9:])
    np.testing.assert_array_equal(
        np.asarray(a.local(b)),
        np.hstack([POSE.local(b.pose), np.asarray(b.vel) - np.asarray(a.vel), np.zeros(6)]),
    )
    np.testing.assert_array_equal(np.asarray(State.identity()), [0, 0, 0, 1, *[0] * 12])


def test_a_part_that_is_no_group_leaves_retract_and_local():
    K = Cal3_S2.from_storage([400.0, 400, 0, 320, 240])
    camera = Camera(pose=POSE, K=K)
    d = np.linspace(-1, 1, 11)
    np.testing.assert_array_equal(np.asarray(camera.retract(d).K), np.asarray(K.retract(d[6:])))
    for forbidden in (
        lambda: camera.compose(camera),
        lambda: camera @ camera,
        lambda: camera.inverse(),
        lambda: camera.log(),
        lambda: Camera.exp(d),
        lambda: Camera.identity(),
        lambda: camera.adjoint(),
        lambda: Camera.Jr(d),
    ):
        with pytest.raises(DefinitionError, match=r"Camera is no group, because its part K \(Cal3_S2\)"):
            forbidden()


def test_parts_have_structural_blocks():
    """Reading a part and building from parts cost nothing."""

    @factor
    def part_of(x: State, *, z: SE3):
        return z.local(x.pose)

    @factor
    def rebuilt(x: State, *, z: State):
        return z.local(State(pose=x.pose, vel=x.vel, bias=x.bias))

    assert part_of.kernel.jacobians.operations == library.prior_se3.kernel.jacobians.operations
    assert rebuilt.kernel.jacobians.operations == prior_state.kernel.jacobians.operations
    D = part_of.jacobians(state(), z=POSE)["res_D_x"]
    np.testing.assert_array_equal(D[:, 6:], np.zeros((6, 9)))


def test_an_output_on_a_product_has_its_chart():
    y = step(state(), acc=[0, 0, 9.8], gyro=[0.1, 0, 0], dt=R1(0.01))
    assert isinstance(y, State)
    D = step.jacobians(state(), acc=[0, 0, 9.8], gyro=[0.1, 0, 0], dt=R1(0.01))["y_D_x"]
    assert D.shape == (15, 15)
    np.testing.assert_array_equal(D[9:, 9:], np.eye(6))


def test_a_subclass_adds_parts():
    class Timed(State):
        clock: R1

    x = Timed(pose=POSE, vel=R3(1, 2, 3), bias=BIAS, clock=0.5)
    assert Timed.form.dim == 16
    assert float(x.clock) == 0.5
    np.testing.assert_array_equal(np.asarray(x)[:7], np.asarray(POSE))


def test_classes_of_one_name_are_told_apart():
    class Gains(Product):
        scale: R1

    with pytest.raises(DefinitionError, match="one manifold"):
        Gains(scale=1.0).local(product_factors.Gains(scale=1.0, offset=R2(0, 0)))

    class State(Product):
        pose: SE3
        vel: R3
        bias: R6

    x = State(pose=POSE, vel=R3(4, 5, 6), bias=BIAS)
    assert np.allclose(np.asarray(x.local(state())), 0, atol=1e-15)  # the same parts: the same manifold


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: State(pose=POSE), r"say all its parts: State\(pose=..., vel=..., bias=...\)"),
        (lambda: state(speed=1), "say all its parts"),
        (lambda: state(pose=SO3.identity()), r"State\(pose=...\) needs SE3, got SO3"),
        (lambda: state(pose=3.0), "needs SE3, got float"),
        (lambda: state(vel=R2(1, 2)), r"State\(vel=...\) needs a vector with 3 entries"),
        (lambda: type("Empty", (Product,), {}), "Empty has no parts"),
        (
            lambda: type("Bad", (Product,), {"__annotations__": {"a": float}}),
            "part 'a' is annotated with float, which is no manifold",
        ),
        (
            lambda: type("Bad", (Product,), {"__annotations__": {"log": R1}}),
            "a part cannot be called 'log'",
        ),
        (
            lambda: type("Bad", (Product,), {"__annotations__": {"a": "Unknown"}}),
            "the annotation 'Unknown' is unknown",
        ),
    ],
)
def test_errors_name_the_class_the_part_and_the_cure(build, message):
    with pytest.raises(DefinitionError, match=message):
        build()


def test_values_do_not_change():
    with pytest.raises(AttributeError):
        state().vel = R3(0, 0, 0)


def test_strict_type_check(tmp_path):
    pytest.importorskip("basedpyright")
    here = Path(__file__)
    config = here.parents[2] / "pyproject.toml"
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        "from liegen import R2, R3, SE3, Product\n\n\n"
        "class State(Product):\n    pose: SE3\n    vel: R3\n\n\n"
        "x = State(pose=SE3.identity(), vel=R3(1, 2, 3))\n"
        "y: R2 = x.vel\n"
        "State(pose=SE3.identity())\n"
        "State(pose=SE3.identity(), vel=R2(1, 2))\n"
        "x.speed\n"
        "x.compose(x.pose)\n"
    )
    command = [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, "-p", str(config)]
    good, bad = (
        subprocess.run([*command, str(file)], capture_output=True, text=True, check=False).stdout
        for file in (here.with_name("product_factors.py"), wrong)
    )
    assert "0 errors" in good, good
    assert [line for line in (10, 11, 12, 13, 14) if f"wrong.py:{line}:" not in bad] == [], bad
