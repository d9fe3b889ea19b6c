"""Functions in single precision: no arithmetic in double, errors against the functions in double."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest
from emit_kernels import bearing_range, examples
from emit_tools import C99, FLAGS, compiler
from test_emit_numpy import in_sight

from liegen import library
from liegen.cli import app
from liegen.emit import render
from liegen.kernel import Kernel
from liegen.modules import every_function
from liegen.samples import CASES, Draw, default_sampler

#: Any conversion between the two types is an error.
STRICT = ["-Wdouble-promotion", "-Wconversion"]
GROUPS = every_function()
FUNCTIONS = {
    f.name: f
    for f in (
        library.between_se3, library.between_se2, library.bearing_se3, library.range_se3, library.prior_s2,
        library.sfm_cal3_bundler, GROUPS["se3_exp"], GROUPS["gal3_retract"], GROUPS["so3_Jr_inv"],
    )
}  # fmt: skip
#: Relative to the largest entry, output or argument: 16 units in the last place of a float.
BOUND = 16 * float(np.finfo(np.float32).eps)
#: Near half a turn one rounding chooses between both logarithms, and that of S2 is badly conditioned.
USUAL = [c for c in CASES if c.spread <= 1.0 and "angle 3.1" not in c.name]


def build(kernels: list[Kernel], folder: Path) -> ctypes.CDLL:
    files = render(kernels, ["c"], package="demo", regenerate="", layout="col", scalar="float")
    for path, text in files.items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    sources = [f"{k.name}.c" for k in kernels]
    command = [compiler(), *C99, *FLAGS, *STRICT, "-shared", "-fPIC", *sources, "-o", "demo.so", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "demo.so"))


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return build(examples(), tmp_path_factory.mktemp("single"))


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return build([f.kernel for f in FUNCTIONS.values()], tmp_path_factory.mktemp("library"))


def call(library: ctypes.CDLL, name: str, kernel: Kernel, values: dict[str, np.ndarray], dtype: type):
    """Status and all outputs by a function of all outputs."""
    ins = [np.ascontiguousarray(values[a.name], dtype) for a in kernel.arguments]
    outs = {p.name: np.full(p.shape, 777.0, dtype) for p in kernel.jacobians.outputs}
    status = library[name](*(ctypes.c_void_p(a.ctypes.data) for a in (*ins, *outs.values())))
    return status, outs


@pytest.mark.parametrize("name", FUNCTIONS)
def test_errors_are_a_few_units_in_the_last_place(shared: ctypes.CDLL, name: str) -> None:
    function = FUNCTIONS[name]
    sampler = function.sampler or default_sampler({p.name: p.manifold for p in function.graph.parameters})
    compared = 0
    for k, case in enumerate(USUAL):
        drawn = sampler(Draw(np.random.default_rng([9, k])), case)
        values = {n: np.asarray(v, np.float32).ravel() for n, v in drawn.items()}
        status, wanted = call(shared, f"demo_{name}", function.kernel, values, np.float64)
        code, got = call(shared, f"demo_{name}_f32", function.kernel, values, np.float32)
        assert code == status
        given = max(float(np.abs(v).max()) for v in values.values())
        for output, array in wanted.items():
            if np.isfinite(array).all():
                scale = max(1.0, given, float(np.abs(array).max()))
                error = float(np.abs(got[output] - array).max()) / scale
                assert error <= BOUND, (case.name, output, error)
                compared += 1
    assert compared > len(USUAL) / 2


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
def test_columns_jacobians_and_null_as_in_double(demo: ctypes.CDLL, kernel: Kernel) -> None:
    values = (
        in_sight(3) if kernel.name == "bearing_range" else {a.name: np.ones(a.size) for a in kernel.arguments}
    )
    _, row = call(demo, f"demo_{kernel.name}_f32", kernel, values, np.float32)
    _, column = call(demo, f"demo_{kernel.name}_cm_f32", kernel, values, np.float32)
    for name, array in row.items():
        np.testing.assert_array_equal(column[name].ravel(), array.T.ravel())
    ins = [np.ascontiguousarray(values[a.name], np.float32) for a in kernel.arguments]
    outs = [np.zeros(o.size, np.float32) for o in kernel.outputs]
    null = [None] * (len(row) - len(outs))
    demo[f"demo_{kernel.name}_f32"](*(ctypes.c_void_p(a.ctypes.data) for a in (*ins, *outs)), *null)
    for output, array in zip(kernel.outputs, outs, strict=True):
        np.testing.assert_array_equal(array, row[output.name].ravel())


def test_outside_of_the_domain_all_is_nan(demo: ctypes.CDLL) -> None:
    values = {"x": np.array([1.0, 0, 0, 0]), "p": np.array([-5.0, 0.0]), "z": np.zeros(2)}
    status, outs = call(demo, "demo_bearing_range_f32", bearing_range(), values, np.float32)
    assert status == 2
    assert all(np.isnan(a).all() for a in outs.values())


def test_the_command_line_adds_them_and_check_knows(tmp_path: Path) -> None:
    from click.testing import CliRunner

    out = str(tmp_path)
    done = CliRunner().invoke(app, ["generate", "-f", "range_r2", "-t", "c", "--scalar", "float", "-o", out])
    assert done.exit_code == 0, done.output
    header = (tmp_path / "c" / "range_r2.h").read_text()
    assert "int liegen_factors_range_r2_f32(" in header
    assert "--scalar float" in header
    assert CliRunner().invoke(app, ["check", out]).exit_code == 0
