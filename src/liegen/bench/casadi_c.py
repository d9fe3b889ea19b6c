"""A kernel's C against CasADi's own C: the same expressions, and differentiation through the storage."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from liegen.algebra.casadi_backend import ca
from liegen.algebra.linear import Matrix
from liegen.define import Function
from liegen.derive import lowered
from liegen.differentiate import STRATEGIES, Expressions, expressions, jacobians
from liegen.emit import render
from liegen.emit.templates import lay_out
from liegen.native import compile_shared
from liegen.samples import Case, Draw, default_sampler

from .timing import Row, driver, in_turn, summarise

FLAGS = ("-O3", "-march=native")
PACKAGE = "bench"


@dataclass(frozen=True)
class Variant:
    """A C function to time: how the driver declares and calls it."""

    name: str
    label: str
    prototype: str
    call: tuple[str, ...]
    sources: Mapping[str, str]
    operations: int


def compare(function: Function[..., object], *, calls: int, rounds: int, seed: int) -> tuple[Row, ...]:
    """Time the value with all Jacobians on ``calls`` distinct random inputs; checks first that all agree."""
    variants = _variants(function)
    inputs = _inputs(function, calls, seed)
    kernel = function.kernel
    sizes = [port.size for port in kernel.jacobians.outputs]
    text = lay_out("bench/driver.c.j2", {"variants": variants, "inputs": inputs.shape[1]})
    sources = {path: source for v in variants for path, source in v.sources.items()}
    with tempfile.TemporaryDirectory() as folder:
        library = _built({**sources, "driver.c": text}, Path(folder))
        buffers = {v.name: np.zeros(sum(sizes)) for v in variants}
        runs = {v.label: driver(library, v.name, inputs, buffers[v.name]) for v in variants}
        errors = _errors(variants, {v.name: _sampled(library, v, inputs, buffers) for v in variants})
        times = in_turn(runs, calls, rounds)
    return summarise(times, {v.label: v.operations for v in variants}, errors)


def _built(sources: Mapping[str, str], folder: Path) -> ctypes.CDLL:
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8")
    library = folder / "bench.so"
    compile_shared([folder / name for name in sources if name.endswith(".c")], library, FLAGS)
    return ctypes.CDLL(str(library))


def _sampled(
    library: ctypes.CDLL,
    variant: Variant,
    inputs: NDArray[np.float64],
    buffers: Mapping[str, NDArray[np.float64]],
) -> NDArray[np.float64]:
    """What a variant computes of some fifty of the inputs."""
    found: list[NDArray[np.float64]] = []
    for k in range(0, len(inputs), max(1, len(inputs) // 50)):
        driver(library, variant.name, inputs[k : k + 1], buffers[variant.name])()
        found.append(buffers[variant.name].copy())
    return np.array(found)


def _errors(variants: Sequence[Variant], found: Mapping[str, NDArray[np.float64]]) -> dict[str, float]:
    """Largest difference from the first variant, relative to the largest entry (at least 1)."""
    base = found[variants[0].name]
    scale = np.maximum(1.0, np.abs(base).max())
    return {v.label: float(np.abs(found[v.name] - base).max() / scale) for v in variants}


def _inputs(function: Function[..., object], calls: int, seed: int) -> NDArray[np.float64]:
    draw = Draw(np.random.default_rng(seed))
    sampler = function.sampler or default_sampler({p.name: p.manifold for p in function.graph.parameters})
    rows = [sampler(draw, Case("random")) for _ in range(calls)]
    stored = {p.name: p.storage for p in function.graph.parameters}
    return np.array([[x for name, s in stored.items() for x in s.write(row[name].coords)] for row in rows])


def _variants(function: Function[..., object]) -> tuple[Variant, ...]:
    graph = function.graph
    values = expressions(graph)
    ruled = jacobians(graph, values, STRATEGIES["reverse"])
    stored = _through_storage(function, values)
    return (
        _ours(function),
        _theirs(function, "casadi_rules", "CasADi's C, same expressions", values, ruled),
        _theirs(function, "casadi_storage", "CasADi's C, AD through the storage", values, stored),
    )


def _through_storage(function: Function[..., object], values: Expressions) -> dict[tuple[str, str], Matrix]:
    """CasADi's AD of the whole residual by the stored scalars, times d storage / d tangent."""
    graph = function.graph
    found: dict[tuple[str, str], Matrix] = {}
    for name, node in graph.outputs:
        for p in graph.parameters:
            if not p.variable:
                continue
            form = p.manifold.form
            symbols = values.inputs[p.name]
            d = [ca.SX.sym(f"d{k}") for k in range(form.dim)]
            moved = p.storage.write(form.retract(p.storage.read(symbols), d))
            slope = ca.jacobian(ca.vertcat(*moved), ca.vertcat(*d))
            slope = ca.substitute(slope, ca.vertcat(*d), ca.DM.zeros(form.dim))
            by_storage = ca.jacobian(ca.vertcat(*values.scalars[id(node)]), ca.vertcat(*symbols))
            dense = ca.densify(ca.mtimes(by_storage, slope))
            rows, columns = dense.shape
            found[name, p.name] = tuple(tuple(dense[i, j] for j in range(columns)) for i in range(rows))
    return found


def _ours(function: Function[..., object]) -> Variant:
    kernel = function.kernel
    files = render([kernel], ["c"], package=PACKAGE, regenerate="liegen bench")
    sizes = [a.size for a in kernel.arguments]
    offsets = np.cumsum([0, *sizes])
    outputs = np.cumsum([0, *(port.size for port in kernel.jacobians.outputs)])
    pointers = [f"a + {k}" for k in offsets[:-1]] + [f"b + {k}" for k in outputs[:-1]]
    kinds = ["const double *"] * len(sizes) + ["double *"] * (len(outputs) - 1)
    name = f"{PACKAGE}_{kernel.name}"
    return Variant(
        "liegen", "liegen", f"int {name}({', '.join(kinds)});", (f"{name}({', '.join(pointers)});",),
        {path.removeprefix("c/"): text for path, text in files.items() if path.startswith("c/")},
        kernel.jacobians.operations,
    )  # fmt: skip


def _theirs(
    function: Function[..., object],
    name: str,
    label: str,
    values: Expressions,
    blocks: Mapping[tuple[str, str], Matrix],
) -> Variant:
    graph = function.graph
    inputs = [ca.vertcat(*symbols) for symbols in values.inputs.values()]
    outputs = [ca.vertcat(*values.scalars[id(node)]) for _, node in graph.outputs]
    outputs += [ca.densify(ca.vertcat(*(x for row in block for x in row))) for block in blocks.values()]
    compiled = ca.Function(name, inputs, outputs)
    generator = ca.CodeGenerator(name)
    generator.add(compiled)
    offsets = np.cumsum([0, *(x.numel() for x in inputs)])
    ends = np.cumsum([0, *(x.numel() for x in outputs)])
    call = (
        f"const double *arg[] = {{{', '.join(f'a + {k}' for k in offsets[:-1])}}};",
        f"double *res[] = {{{', '.join(f'b + {k}' for k in ends[:-1])}}};",
        f"{name}(arg, res, NULL, NULL, 0);",
    )
    prototype = f"int {name}(const double **, double **, long long int *, double *, int);"
    operations = lowered(graph, values, blocks).operations
    return Variant(name, label, prototype, call, {f"{name}.c": generator.dump()}, operations)
