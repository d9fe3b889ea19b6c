"""The emitted C: flags, values, NULL Jacobians, both layouts, the status, C++."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from emit_kernels import bearing_range, between_r2, examples, wheel_step
from emit_tools import C99, FLAGS, REGENERATE, call_c, compiler, library, reference, samples
from test_emit_numpy import in_sight

from liegen.emit import render, write_tree
from liegen.kernel import Kernel


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> object:
    return library(examples(), tmp_path_factory.mktemp("c"), layout="col")


def values_of(kernel: Kernel, seed: int) -> dict[str, np.ndarray]:
    return in_sight(seed) if kernel.name == "bearing_range" else samples(kernel, seed)


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
@pytest.mark.parametrize("seed", range(5))
def test_values_are_those_of_the_program(demo: object, kernel: Kernel, seed: int) -> None:
    values = values_of(kernel, seed)
    _, wanted = reference(kernel.jacobians, values)
    status, got = call_c(getattr(demo, f"demo_{kernel.name}"), kernel.jacobians, values)
    assert status == 0
    for name, array in wanted.items():
        np.testing.assert_allclose(got[name], array, rtol=1e-15, atol=1e-16)
    suffix = "value" if kernel.name == "wheel_step" else "res"
    status, alone = call_c(getattr(demo, f"demo_{kernel.name}_{suffix}"), kernel.value, values)
    assert status == 0
    for name, array in alone.items():
        np.testing.assert_array_equal(array, got[name])


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
def test_any_jacobian_may_be_null(demo: object, kernel: Kernel) -> None:
    values = values_of(kernel, 7)
    function = getattr(demo, f"demo_{kernel.name}")
    _, everything = call_c(function, kernel.jacobians, values)
    names = [o.name for o in kernel.outputs]
    jacobians = [port.name for port in kernel.jacobians.outputs if port.name not in names]
    for wanted in ([], *([j] for j in jacobians), jacobians[1:]):
        status, got = call_c(function, kernel.jacobians, values, (*names, *wanted))
        assert status == 0
        assert got.keys() == {*names, *wanted}
        for name, array in got.items():
            np.testing.assert_array_equal(array, everything[name])


@pytest.mark.parametrize("kernel", examples(), ids=lambda k: k.name)
def test_column_major_transposes_the_jacobians_and_nothing_else(demo: object, kernel: Kernel) -> None:
    values = values_of(kernel, 8)
    _, row = call_c(getattr(demo, f"demo_{kernel.name}"), kernel.jacobians, values)
    status, column = call_c(getattr(demo, f"demo_{kernel.name}_cm"), kernel.jacobians, values)
    assert status == 0
    for name, array in row.items():
        flat = array.T.ravel() if array.ndim == 2 else array
        np.testing.assert_array_equal(column[name].ravel(), flat)


@pytest.mark.parametrize(
    ("place", "bits"),
    [([-5.0, 0.0], 2), ([0.0, 0.0], 3), ([500.0, 0.0], 2), ([np.nan, 0.0], 3), ([9.0, 0.0], 0)],
)
@pytest.mark.parametrize("suffix", ["", "_cm", "_res"])
def test_the_status_has_a_bit_for_every_requirement_that_does_not_hold(
    demo: object, place: list[float], bits: int, suffix: str
) -> None:
    kernel = bearing_range()
    program = kernel.value if suffix == "_res" else kernel.jacobians
    values = {"x": np.array([1.0, 0, 0, 0]), "p": np.array(place), "z": np.zeros(2)}
    assert reference(program, values)[0] == bits
    status, got = call_c(getattr(demo, f"demo_bearing_range{suffix}"), program, values)
    assert status == bits
    assert all(np.isnan(array).all() if bits else np.isfinite(array).all() for array in got.values())
    if suffix == "":
        some = call_c(demo.demo_bearing_range, program, values, ("res", "res_D_p"))
        assert some[0] == bits
        for name, array in some[1].items():
            np.testing.assert_array_equal(array, got[name])


def test_no_column_major_functions_unless_asked_for() -> None:
    row = render(examples(), ["c"], package="demo", regenerate=REGENERATE)
    assert not any("_cm" in text for text in row.values())


MAIN = """
#include <cstdio>
#include "demo.h"
int main()
{
    const double x[2] = {1, 2}, y[2] = {4, 8}, z[2] = {1, 1.5};
    double res[2], D_x[4];
    const int status = demo_between_r2(x, y, z, res, D_x, nullptr);
    std::printf("%d %g %g %g\\n", status, res[0], res[1], D_x[3]);
    return 0;
}
"""


def test_c_and_cpp_take_the_code_without_a_warning(tmp_path: Path) -> None:
    """The sources as C++, and C++ that calls the sources compiled as C99."""
    write_tree(render(examples(), ["c"], package="demo", regenerate=REGENERATE, layout="col"), tmp_path)
    sources = sorted((tmp_path / "c").glob("*.c"))
    assert len(sources) == 6
    cpp = compiler("c++")
    for source in sources:
        for standard in ("-std=c++98", "-std=c++17"):
            flags = [*FLAGS, standard, *(["-pedantic"] if standard.endswith("17") else [])]
            subprocess.run([cpp, "-x", "c++", *flags, "-c", str(source), "-o", "/dev/null"], check=True)
        c99 = [compiler(), *C99, *FLAGS, "-c", str(source), "-o", str(source.with_suffix(".o"))]
        subprocess.run(c99, check=True)
    (tmp_path / "main.cpp").write_text(MAIN)
    objects = [str(source.with_suffix(".o")) for source in sources]
    program = tmp_path / "main"
    link = [
        cpp,
        *FLAGS,
        "-I",
        str(tmp_path / "c"),
        str(tmp_path / "main.cpp"),
        *objects,
        "-o",
        str(program),
        "-lm",
    ]
    subprocess.run(link, check=True)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=True)
    assert done.stdout == "0 2 4.5 -1\n"


@pytest.mark.parametrize("kernel", [between_r2(), wheel_step()], ids=lambda k: k.name)
def test_every_symbol_has_the_prefix(demo: object, kernel: Kernel, tmp_path: Path) -> None:
    files = render([kernel], ["c"], package="demo", regenerate=REGENERATE, layout="col")
    write_tree(files, tmp_path)
    obj = tmp_path / "one.o"
    source = tmp_path / "c" / f"{kernel.name}.c"
    subprocess.run([compiler(), *C99, *FLAGS, "-c", str(source), "-o", str(obj)], check=True)
    listed = subprocess.run(
        ["nm", "--defined-only", "-g", str(obj)], capture_output=True, text=True, check=True
    )
    symbols = [line.split()[-1].lstrip("_") for line in listed.stdout.splitlines()]
    assert len(symbols) == 3
    assert all(symbol.startswith(f"demo_{kernel.name}") for symbol in symbols)
