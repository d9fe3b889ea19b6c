"""The emitted NumPy package: values, shapes, broadcasting, the domain, errors that name the argument."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from emit_kernels import bearing_range, between_r2, examples, wheel_step
from emit_tools import package, reference, same, samples

from liegen.kernel import Kernel


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    return package(examples(), tmp_path_factory.mktemp("numpy"), "demo_numpy")


def in_sight(seed: int, batch: tuple[int, ...] = ()) -> dict[str, np.ndarray]:
    """Samples of bearing_range: x sits near the origin and looks along +x, the point is ahead."""
    values = samples(bearing_range(), seed, batch)
    angle = 0.3 * values["x"][..., 0]
    values["x"] = np.stack([np.cos(angle), np.sin(angle), *np.moveaxis(values["x"][..., 2:], -1, 0)], -1)
    values["p"] = values["p"] + [9.0, 0.0]
    return values


def call(module: ModuleType, kernel: Kernel, values: dict[str, np.ndarray], suffix: str = "") -> object:
    given = {a.name: values[a.name] for a in kernel.given}
    return getattr(module, kernel.name + suffix)(*(values[a.name] for a in kernel.variables), **given)


@pytest.mark.parametrize("batch", [(), (1,), (3,), (2, 1, 3)])
@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
def test_every_element_is_what_the_program_gives(
    demo: ModuleType, kernel: Kernel, batch: tuple[int, ...]
) -> None:
    values = in_sight(0, batch) if kernel.name == "bearing_range" else samples(kernel, 0, batch)
    got = call(demo, kernel, values, "_jacobians")
    alone = call(demo, kernel, values)
    alone = (alone,) if len(kernel.outputs) == 1 else alone
    assert got._fields == tuple(port.name for port in kernel.jacobians.outputs)
    for index in np.ndindex(batch):
        one = {name: array[index] for name, array in values.items()}
        _, wanted = reference(kernel.jacobians, one)
        for name, array in wanted.items():
            assert np.isfinite(array).all()
            # NumPy's vectorised sin, cos and arctan2 may differ from its scalar ones in the last place.
            np.testing.assert_allclose(getattr(got, name)[index], array, rtol=1e-14, atol=1e-15)
        for output, array in zip(kernel.outputs, alone, strict=True):
            np.testing.assert_allclose(array[index], wanted[output.name], rtol=1e-14, atol=1e-15)
    for port in kernel.jacobians.outputs:
        assert getattr(got, port.name).shape == (*batch, *port.shape)
        assert getattr(got, port.name).flags.c_contiguous


def test_leading_dimensions_broadcast(demo: ModuleType) -> None:
    x, y, z = np.random.default_rng(1).normal(size=(3, 4, 2))
    got = demo.between_r2_jacobians(x[:, None], y[None, :3], z=z[0])
    assert got.res.shape == (4, 3, 2)
    assert got.res_D_x.shape == (4, 3, 2, 2)
    np.testing.assert_array_equal(got.res, y[None, :3] - x[:, None] - z[0])
    np.testing.assert_array_equal(got.res_D_x, np.broadcast_to(-np.eye(2), (4, 3, 2, 2)))
    assert demo.between_r2(np.empty((0, 2)), y[0], z=z[0]).shape == (0, 2)


def test_large_batches_are_cut_into_blocks_that_do_not_show(demo: ModuleType) -> None:
    n = 2 * sys.modules["demo_numpy._support"].BLOCK + 17
    values = in_sight(3, (n,))
    values["z"] = values["z"][:1]
    got = demo.bearing_range_jacobians(values["x"], values["p"], z=values["z"])
    first = demo.bearing_range_jacobians(values["x"][-20:], values["p"][-20:], z=values["z"])
    for part, whole in zip(first, got, strict=True):
        np.testing.assert_allclose(whole[-20:], part, rtol=1e-14, atol=1e-15)


def test_inputs_are_array_likes_and_stay_untouched(demo: ModuleType) -> None:
    x = np.array([1, 2])
    res = demo.between_r2(x, [4, 8], z=(1.0, 1.5))
    same(res, np.array([2.0, 4.5]))
    res[:] = 0
    assert x.tolist() == [1, 2]


@pytest.mark.parametrize("batch", [(), (1,), (4,)])
def test_outside_of_the_domain_everything_is_nan_and_nothing_warns(
    demo: ModuleType, batch: tuple[int, ...]
) -> None:
    values = in_sight(5, batch)
    good = demo.bearing_range_jacobians(values["x"], values["p"], z=values["z"])
    first = (0,) * len(batch)
    # The point is behind, where the sensor is, beyond reach, or not a number.
    for place in (values["x"][first][2:] - [5.0, 0.0], values["x"][first][2:], [500.0, 0.0], [np.nan, 0.0]):
        values["p"][first] = place
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            got = demo.bearing_range_jacobians(values["x"], values["p"], z=values["z"])
            res = demo.bearing_range(values["x"], values["p"], z=values["z"])
        for before, array in zip((*good, good.res), (*got, res), strict=True):
            assert np.isnan(array[first]).all()
            if batch:
                np.testing.assert_array_equal(array[1:], before[1:])


def test_a_shared_argument_outside_of_the_domain_spoils_the_whole_batch(demo: ModuleType) -> None:
    values = in_sight(6)
    z = np.zeros((5, 2))
    got = demo.bearing_range_jacobians(values["x"], values["x"][2:], z=z)
    assert got.res_D_x.shape == (5, 2, 3)
    assert all(np.isnan(array).all() for array in got)


def test_no_warning_from_division_and_overflow(demo: ModuleType) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        demo.between_r2([1e308, 0], [-1e308, 0], z=[1e308, 0])
        demo.wheel_step([np.inf], [0, 0], dt=[0.0], bias=[0, 0, 0])


@pytest.mark.parametrize(
    ("x", "z", "error", "message"),
    [
        (np.zeros(3), np.zeros(2), ValueError, r"between_r2: argument x: expected shape (..., 2), got (3,)"),
        (0.0, np.zeros(2), ValueError, r"between_r2: argument x: expected shape (..., 2), got ()"),
        (np.zeros((2, 5)), np.zeros(2), ValueError, r"argument x: expected shape (..., 2), got (2, 5)"),
        (np.zeros(2), np.zeros((4, 1)), ValueError, r"argument z: expected shape (..., 2), got (4, 1)"),
        (
            np.zeros((3, 2)),
            np.zeros((4, 2)),
            ValueError,
            "between_r2: leading dimensions do not broadcast: x (3,), y (), z (4,)",
        ),
        ([1j, 0], np.zeros(2), TypeError, "argument x: expected real numbers, got complex128"),
        (["a", "b"], np.zeros(2), TypeError, "argument x: expected real numbers"),
    ],
)
def test_errors_name_the_function_and_the_argument(
    demo: ModuleType, x: object, z: object, error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        demo.between_r2(x, np.zeros(2), z=z)
    assert message in str(raised.value)
    with pytest.raises(error, match="between_r2_jacobians"):
        demo.between_r2_jacobians(x, np.zeros(2), z=z)


def test_given_arguments_are_keywords_and_outputs_are_named(demo: ModuleType) -> None:
    with pytest.raises(TypeError):
        demo.between_r2([0, 0], [0, 0], [0, 0])
    got = demo.wheel_step([2.0], [1.0, 0.0], dt=[0.25], bias=[9.0, 0.0, 9.0])
    assert type(got).__name__ == "WheelStepOutputs"
    same(got.R, np.array([0.5]))
    np.testing.assert_allclose(got.v, [np.cos(0.5), np.sin(0.5)], rtol=1e-15)


def test_the_package_imports_numpy_only(tmp_path: Path) -> None:
    package([between_r2(), wheel_step()], tmp_path, "demo_lonely")
    code = (
        "import sys, demo_lonely; "
        "print([m for m in ('liegen', 'sympy', 'casadi', 'scipy', 'jinja2') if m in sys.modules]); "
        "print(sorted(demo_lonely.__all__))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[0] == "[]"
    assert "between_r2_jacobians" in done.stdout
    assert (tmp_path / "demo_lonely" / "py.typed").read_text() == ""
