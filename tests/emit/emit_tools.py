"""Import a generated package, compile generated C, call both, and the reference: ``Program.evaluate``."""

from __future__ import annotations

import ctypes
import importlib
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from liegen.emit import render, write_tree
from liegen.kernel import Kernel
from liegen.program import Program

REGENERATE = "liegen generate factors.py -o out --package demo -t numpy -t c"
FLAGS = ["-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off"]
C99 = ["-std=c99", "-pedantic"]
Values = Mapping[str, np.ndarray]


def package(kernels: list[Kernel], directory: Path, name: str) -> ModuleType:
    """Write and import the NumPy package; every test takes a name of its own."""
    write_tree(render(kernels, ["numpy"], package=name, regenerate=REGENERATE), directory)
    sys.path.insert(0, str(directory))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(directory))


def compiler(name: str = "cc") -> str:
    found = shutil.which(name) or shutil.which({"cc": "gcc", "c++": "g++"}[name])
    if found is None:
        pytest.skip(f"no C compiler: {name} is not on the path")
    return found


def library(kernels: list[Kernel], directory: Path, layout: str = "row") -> ctypes.CDLL:
    """Write and compile the C code into a shared library."""
    write_tree(render(kernels, ["c"], package="demo", regenerate=REGENERATE, layout=layout), directory)
    sources = sorted(map(str, (directory / "c").glob("*.c")))
    shared = directory / "demo.so"
    subprocess.run(
        [compiler(), *C99, *FLAGS, "-shared", "-fPIC", "-o", str(shared), *sources, "-lm"], check=True
    )
    return ctypes.CDLL(str(shared))


def call_c(
    function: ctypes._NamedFuncPointer,
    program: Program,
    values: Values,
    wanted: tuple[str, ...] | None = None,
    dtype: type = np.float64,
) -> tuple[int, dict[str, np.ndarray]]:
    """Status and outputs; outputs that are not wanted are passed as NULL. Entries never written stay 777."""
    ins = [np.ascontiguousarray(values[p.name], dtype=dtype) for p in program.inputs]
    outs = {p.name: np.full(p.shape, 777.0, dtype) for p in program.outputs}
    pointer = ctypes.c_void_p
    args = [a.ctypes.data_as(pointer) for a in ins]
    keep = outs.keys() if wanted is None else wanted
    args += [outs[n].ctypes.data_as(pointer) if n in keep else pointer() for n in outs]
    function.restype = ctypes.c_int
    return function(*args), {n: outs[n] for n in outs if n in keep}


def reference(program: Program, values: Values) -> tuple[int, dict[str, np.ndarray]]:
    """Status and outputs of one element by ``Program.evaluate``."""
    flat = program.evaluate({n: list(np.asarray(v, dtype=np.float64)) for n, v in values.items()})
    status = sum(0 if held else 1 << k for k, held in enumerate(flat["status"]))
    return status, {
        p.name: np.array(flat[p.name], dtype=np.float64).reshape(p.shape) for p in program.outputs
    }


def same(got: np.ndarray, wanted: np.ndarray, rtol: float = 0.0) -> None:
    """Equal, signs of zeros included; NaN equals NaN."""
    assert got.shape == wanted.shape
    assert got.dtype == np.float64
    np.testing.assert_allclose(got, wanted, rtol=rtol, atol=0.0)
    numbers = ~np.isnan(wanted)
    np.testing.assert_array_equal(np.signbit(got[numbers]), np.signbit(wanted[numbers]))


def samples(kernel: Kernel, seed: int, batch: tuple[int, ...] = ()) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {a.name: rng.normal(size=(*batch, a.size)) for a in kernel.arguments}
