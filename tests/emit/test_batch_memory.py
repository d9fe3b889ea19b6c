"""Batches read and write nothing beside their arrays: AddressSanitizer watches arrays of the exact size."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from emit_kernels import bearing_range, wheel_step
from emit_tools import C99, compiler

from liegen.emit import render
from liegen.emit.precision import in_single
from liegen.kernel import Kernel

SANITIZE = ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
HEAD = """
#include "demo.h"
#include <stdlib.h>
#include <string.h>
static double *ones(ptrdiff_t n)
{
    double *x = (double *)malloc(sizeof(double) * (size_t)n + 1);
    for (ptrdiff_t k = 0; k < n; ++k) x[k] = 1.0;
    return (double *)realloc(x, sizeof(double) * (size_t)n);
}
int main(void)
{
"""


def program(kernels: list[Kernel], suffix: str) -> str:
    """Calls each batch for n up to 33, packed, as a structure of arrays, and through an index."""
    lines = [HEAD, "for (ptrdiff_t n = 1; n < 34; ++n) for (int soa = 0; soa < 3; ++soa) {"]
    for kernel in kernels:
        passed = ["n"]
        lines += ["{", "int32_t *index = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);"]
        lines += ["for (ptrdiff_t k = 0; k < n; ++k) index[k] = (int32_t)(n - 1 - k);"]
        for a in kernel.arguments:
            lines += [f"double *{a.name} = ones(n * {a.size});"]
            layout = f"soa == 1 ? 1 : {a.size}, soa == 1 ? n : 1, soa == 2 ? index : NULL"
            lines += [f"const demo_in{suffix} {a.name}_in = {{ {a.name}, {layout} }};"]
            passed.append(f"{a.name}_in")
        for p in kernel.jacobians.outputs:
            lines += [f"double *{p.name} = ones(n * {p.size});"]
            layout = f"soa == 1 ? 1 : {p.size}, soa == 1 ? n : 1"
            lines += [f"const demo_out{suffix} {p.name}_out = {{ {p.name}, {layout} }};"]
            passed.append(f"{p.name}_out")
        lines += ["uint8_t *status = (uint8_t *)malloc((size_t)n);"]
        lines += [f"demo_{kernel.name}_batch{suffix}({', '.join([*passed, 'status'])});"]
        names = [*(a.name for a in kernel.arguments), *(p.name for p in kernel.jacobians.outputs)]
        lines += [f"free({name});" for name in (*names, "index", "status")] + ["}"]
    return "\n".join([*lines, "}", "return 0;", "}"])


@pytest.fixture(scope="module")
def sanitizer(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("sanitizer")
    (folder / "one.c").write_text("int main(void) { return 0; }\n")
    command = [compiler(), *SANITIZE, "one.c", "-o", "one"]
    if subprocess.run(command, cwd=folder, capture_output=True, check=False).returncode:
        pytest.skip("this compiler has no AddressSanitizer")


BUILDS = [["-DLANES=8"], ["-DLANES=2", "-DDEMO_STREAM_BYTES=0"], ["-march=native"]]


@pytest.mark.parametrize("suffix", ["", "_cm", "_f32"])
@pytest.mark.parametrize("build", BUILDS, ids=" ".join)
def test_nothing_beside_the_arrays_is_touched(
    sanitizer: None, build: list[str], suffix: str, tmp_path: Path
) -> None:
    kernels = [bearing_range(), wheel_step()]
    files = render(kernels, ["c"], package="demo", regenerate="", layout="col", scalar="float")
    for path, text in files.items():
        (tmp_path / Path(path).name).write_text(text, encoding="utf-8")
    single = suffix == "_f32"
    text = program(kernels, suffix)
    text = (
        in_single(text)
        if single
        else text.replace("demo_in_cm", "demo_in").replace("demo_out_cm", "demo_out")
    )
    (tmp_path / "main.c").write_text(text, encoding="utf-8")
    end = "_batch_f32" if single else "_batch"
    sources = ["main.c", *(f"{k.name}{e}.c" for k in kernels for e in ("", end))]
    command = [compiler(), *C99, *SANITIZE, "-Wno-psabi", *build, *sources, "-o", "main", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
