"""liegen's programs on the scalars of a peer, and how a peer's C++ is called.

The same closed forms inside another generator show what is mathematics and what is code generation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations_with_replacement
from typing import Any

from liegen.algebra import Algebra
from liegen.emit.templates import lay_out
from liegen.names import block_name, gradient_name
from liegen.program import Port

from .variant import Task, offsets

#: Matrices by output name, as lists of rows; a vector is one column.
Rows = Mapping[str, Sequence[Sequence[Any]]]
#: The formulation that is liegen's own.
FORMS = "liegen's closed forms"
#: Calls are through plain pointers, which Eigen's types must take at any address.
EIGEN_OPTIONS = ("-I/usr/include/eigen3", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=0", "-DNDEBUG")


def closed_forms(task: Task, arguments: Mapping[str, Sequence[Any]], algebra: Algebra) -> Rows:
    """All outputs of liegen's program, evaluated on the scalars of ``algebra``."""
    program = task.kernel.jacobians
    slots = program.run(arguments, algebra)
    return {
        port.name: rows_of(port, [slots[i] for i in indices])
        for port, indices in zip(program.outputs, program.results, strict=True)
    }


def finished(task: Task, derived: Rows, matrix: Callable[[Sequence[Sequence[Any]]], Any]) -> Rows:
    """A residual with Jacobians as it is or, for a task of terms, J^T J and J^T r of it.

    ``matrix`` makes one of the peer from rows; it has ``T`` and ``*``.
    """
    if not task.terms:
        return derived
    ((output, _),) = task.function.graph.outputs
    r = matrix(derived[output])
    J = {p.name: matrix(derived[f"{output}_D_{p.name}"]) for p in task.function.graph.variables}
    found = {"cost": r.T * r / 2, **{gradient_name(name): J[name].T * r for name in J}}
    found |= {block_name(a, b): J[a].T * J[b] for a, b in combinations_with_replacement(J, 2)}
    return {
        name: [[block[i, j] for j in range(block.shape[1])] for i in range(block.shape[0])]
        for name, block in found.items()
    }


def rows_of(port: Port, flat: Sequence[Any]) -> list[list[Any]]:
    """A flat list of entries as rows; a vector is one column."""
    columns = port.shape[1] if len(port.shape) == 2 else 1
    return [list(flat[k : k + columns]) for k in range(0, len(flat), columns)]


def eigen_wrapper(
    task: Task, symbol: str, function: str, header: str, pointers: frozenset[str]
) -> Mapping[str, str]:
    """C++ that calls a function of Eigen types by plain pointers, as source text by file name.

    ``pointers`` are the ports that the function takes by pointer instead of reference.
    """

    def argument(port: Port, array: str, start: int) -> str:
        rows, columns = (*port.shape, 1)[:2]
        constant = "const " if array == "a" else ""
        kind = f"{constant}Eigen::Matrix<double, {rows}, {columns}>"
        star = "" if port.name in pointers else "*"
        return f"{star}reinterpret_cast<{kind} *>({array} + {start})"

    inputs = [argument(p, "a", k) for p, k in zip(task.inputs, offsets(task.inputs), strict=True)]
    outputs = [argument(p, "b", k) for p, k in zip(task.outputs, offsets(task.outputs), strict=True)]
    names = {"symbol": symbol, "function": function, "header": header, "arguments": [*inputs, *outputs]}
    return {f"{symbol}.cc": lay_out("bench/eigen_call.cc.j2", names)}


def prototype(symbol: str) -> str:
    """How the driver declares such a wrapper."""
    return f"void {symbol}(const double *, double *);"
