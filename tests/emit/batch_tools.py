"""Call the generated batches through ctypes: arrays in every layout, and canaries around what is written."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from emit_tools import C99, FLAGS, compiler

from liegen.emit import render
from liegen.emit.precision import DOUBLE, SINGLE, Precision
from liegen.kernel import Kernel
from liegen.verify.batches import DTYPES, In, Out, batch_function

PACKAGE = "demo"
#: Widths, with and without fused operations where this machine has them.
WIDTHS = [["-DLANES=1"], ["-DLANES=2"], ["-DLANES=8"], ["-march=native", "-ffp-contract=fast"]]
#: Every width, whatever this machine has; outputs past the caches at any size; threads.
BUILDS = {
    "1 lane": ["-DLANES=1"],
    "2 lanes": ["-DLANES=2"],
    "4 lanes": ["-DLANES=4"],
    "8 lanes": ["-DLANES=8"],
    "16 lanes": ["-DLANES=16"],
    "streams": ["-DDEMO_STREAM_BYTES=0"],
    "widest, streams": ["-march=native", "-ffp-contract=off", "-DDEMO_STREAM_BYTES=0"],
    "threads": ["-fopenmp", "-DDEMO_OPENMP"],
    "threads, streams": ["-fopenmp", "-DDEMO_OPENMP", "-DDEMO_STREAM_BYTES=0"],
}
CANARY = 777.0


def built(kernels: Sequence[Kernel], folder: Path, flags: Sequence[str], layout: str = "col") -> ctypes.CDLL:
    """The C of the kernels in both precisions, compiled without contraction of a*b+c."""
    folder.mkdir(exist_ok=True)
    files = render(kernels, ["c"], package=PACKAGE, regenerate="", layout=layout, scalar="float")
    for path, text in files.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    sources = sorted(map(str, (folder / "c").glob("*.c")))
    shared = folder / "demo.so"
    command = [compiler(), *C99, *FLAGS, "-Wno-psabi", *flags, "-shared", "-fPIC", "-o", str(shared)]
    done = subprocess.run([*command, *sources, "-lm"], capture_output=True, text=True, check=False)
    if done.returncode and "-fopenmp" in flags and "openmp" in done.stderr:
        pytest.skip("this compiler has no OpenMP")
    assert not done.returncode, done.stderr
    return ctypes.CDLL(str(shared))


@dataclass(frozen=True)
class Layout:
    """How an array of n elements of some size lies in memory: offset of the first, stride, comp."""

    name: str
    offset: int = 0
    gap: int = 0
    structure_of_arrays: bool = False
    dtype: type = np.float64

    def steps(self, n: int, size: int) -> tuple[int, int]:
        return (1, n + self.gap) if self.structure_of_arrays else (size + self.gap, 1)

    def blank(self, n: int, size: int) -> np.ndarray:
        """Room for n elements, with canaries on all sides."""
        return np.full(self.offset + (n + self.gap + 2) * (size + self.gap + 2) + 8, CANARY, self.dtype)

    def view(self, flat: np.ndarray, n: int, size: int) -> np.ndarray:
        stride, comp = (step * flat.itemsize for step in self.steps(n, size))
        return np.lib.stride_tricks.as_strided(flat[self.offset :], (n, size), (stride, comp))


@dataclass(frozen=True)
class Variant:
    """One of the functions for a factor."""

    precision: Precision = DOUBLE
    column_major: bool = False

    @property
    def dtype(self) -> type:
        return DTYPES[self.precision.suffix]

    @property
    def one(self) -> str:
        """What the name of the function of one factor ends with."""
        return f"{'_cm' if self.column_major else ''}{self.precision.suffix}"


PLAIN = Variant()
VARIANTS = {
    "double": PLAIN,
    "columns": Variant(column_major=True),
    "single": Variant(SINGLE),
    "single, columns": Variant(SINGLE, column_major=True),
}
PACKED = Layout("packed")
LAYOUTS = (
    PACKED,
    Layout("unaligned", offset=1),
    Layout("apart", offset=3, gap=2),
    Layout("structure of arrays", structure_of_arrays=True),
    Layout("structure of arrays, apart", offset=5, gap=3, structure_of_arrays=True),
)


def call_batch(
    library: ctypes.CDLL,
    kernel: Kernel,
    values: Mapping[str, np.ndarray],
    n: int,
    *,
    into: Layout = PACKED,
    outof: Layout = PACKED,
    wanted: Sequence[str] | None = None,
    index: Mapping[str, np.ndarray] | None = None,
    broadcast: Sequence[str] = (),
    with_status: bool = True,
    variant: Variant = PLAIN,
) -> tuple[int, dict[str, np.ndarray], np.ndarray | None]:
    """Return value, outputs (n, size) and status; checks that nothing beside the outputs was written."""
    index = index or {}
    into, outof = (replace(layout, dtype=variant.dtype) for layout in (into, outof))
    ins: list[In] = []
    keep: list[np.ndarray] = []
    for a in kernel.arguments:
        rows = np.asarray(values[a.name])
        flat = outof.blank(len(rows), a.size)
        outof.view(flat, len(rows), a.size)[:] = rows
        stride, comp = outof.steps(len(rows), a.size)
        chosen = np.ascontiguousarray(index[a.name], dtype=np.int32) if a.name in index else None
        keep += [flat] + ([] if chosen is None else [chosen])
        place = flat.ctypes.data + outof.offset * flat.itemsize
        ins.append(
            In(
                place,
                0 if a.name in broadcast else stride,
                comp,
                None if chosen is None else chosen.ctypes.data,
            )
        )
    ports = kernel.jacobians.outputs
    flats = {p.name: into.blank(n, p.size) for p in ports if wanted is None or p.name in wanted}
    outs = [
        Out(flats[p.name].ctypes.data + into.offset * flats[p.name].itemsize, *into.steps(n, p.size))
        if p.name in flats
        else Out(None, 0, 0)
        for p in ports
    ]
    status = np.full(n + 2, 99, np.uint8)
    function = batch_function(
        library, PACKAGE, kernel, column_major=variant.column_major, precision=variant.precision
    )
    code = function(n, *ins, *outs, status.ctypes.data + 1 if with_status else None)
    assert status[0] == status[-1] == 99
    got: dict[str, np.ndarray] = {}
    for p in ports:
        if p.name in flats:
            view = into.view(flats[p.name], n, p.size)
            got[p.name] = view.copy()
            view[:] = CANARY
            assert (flats[p.name] == CANARY).all(), f"{p.name}: written beside the output"
    return code, got, status[1:-1] if with_status else None
