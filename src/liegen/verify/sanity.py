"""A quick look before code is written: is anything of the factor finite anywhere?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from liegen.algebra.casadi_backend import ca, scalar
from liegen.algebra.linear import plain
from liegen.differentiate.local import local_blocks
from liegen.errors import DomainError
from liegen.manifolds import Leaf, Node
from liegen.samples import CASES, Draw
from liegen.trace import Graph

from .backends import program_evaluator
from .draws import TRIES, AnyFunction, Sample, batch, draw_one, generator_for, program_domain

#: Random samples, all of them drawn as the first case says.
SAMPLES = 32


def check_finite(function: AnyFunction) -> None:
    """Return nothing. Raises DomainError when an output or a Jacobian is not finite at any random sample.

    The error names the first operation whose result, or whose derivative, is not finite although its operands
    are. Uses doubles and the derived program only, so it takes milliseconds.
    """
    samples = _random_samples(function)
    results = program_evaluator(function.kernel.jacobians)(batch(samples))
    outputs = [name for name, _ in function.graph.outputs]
    for name, array in results.items():
        finite = np.isfinite(array.reshape(len(samples), -1)).all(axis=1)
        if not finite.any():
            raise DomainError(_message(function, name, samples[0], value=name in outputs))


def _random_samples(function: AnyFunction) -> tuple[Sample, ...]:
    graph, inside = function.graph, program_domain(function)
    draw = Draw(generator_for("finite", function.name))
    drawn = (draw_one(function, draw, CASES[0]) for _ in range(SAMPLES + TRIES))
    kept = tuple(s for s in drawn if inside(graph, s.values))[:SAMPLES]
    if not kept:
        messages = "; ".join(d.message for d in graph.domain)
        raise DomainError(
            f"{graph.site}: {function.name}: none of {SAMPLES + TRIES} random samples is inside its domain "
            f"({messages}); correct the require, or draw inside it with @factor(sample=...)"
        )
    return kept


def _message(function: AnyFunction, name: str, sample: Sample, *, value: bool) -> str:
    graph = function.graph
    culprit = first_not_finite(graph, sample.values, derivative=not value)
    kind = "output" if value else "Jacobian"
    constant = culprit is not None and not all(_finite(n.operation.coords) for n in _constants(culprit))
    of = ", of a constant that is not finite itself" if constant else ""
    found = (
        f"{'' if value else 'the derivative of '}{culprit.operation.name!r} at {culprit.site} "
        f"is the first that is not finite{of}"
        if culprit
        else "no single operation is to blame"
    )
    return (
        f"{graph.site}: {function.name}: {kind} {name!r} is not finite at any of {SAMPLES} random samples: "
        f"{found}; correct the formula, or state where it holds with require(...) and draw there "
        "with @factor(sample=...)"
    )


def _constants(node: Node) -> list[Any]:
    """The constants among the operands."""
    return [n for n in node.operands if isinstance(n.operation, Leaf) and n.operation.coords]


def first_not_finite(graph: Graph, values: Mapping[str, Any], *, derivative: bool) -> Node | None:
    """The first operation with a value (or a derivative block) that is not finite for finite operands.

    A constant that is not finite is the mistake of the operation that has it.
    """
    for node, result, operands in _evaluated(graph, values):
        computed = zip(node.operands, operands, strict=True)
        if not all(_finite(c) for n, c in computed if not isinstance(n.operation, Leaf)):
            continue
        if not _finite(result) or (derivative and not _finite(_block_entries(node, result, operands))):
            return node
    return None


def _evaluated(graph: Graph, values: Mapping[str, Any]) -> Iterator[tuple[Node, Any, list[Any]]]:
    with np.errstate(all="ignore"):
        coords: dict[int, Any] = {
            id(p.node): p.storage.taken([np.float64(c) for c in values[p.name]], normalise=graph.normalise)
            for p in graph.parameters
        }
        for node in graph.nodes():
            if id(node) in coords:
                continue
            if isinstance(node.operation, Leaf):
                coords[id(node)] = [np.float64(c) for c in node.operation.coords]
                continue
            operands = [coords[id(n)] for n in node.operands]
            coords[id(node)] = node.operation.value(*operands)
            yield node, coords[id(node)], operands


def _finite(coords: Any) -> bool:
    return all(np.isfinite(np.asarray(c, dtype=np.float64)).all() for c in coords)


def _block_entries(node: Node, result: Any, operands: list[Any]) -> list[float]:
    """All entries of the local Jacobians, by the same rules or CasADi code that the derivation takes."""
    lifted = [tuple(scalar(float(c)) for c in coords) for coords in operands]
    value = tuple(scalar(float(c)) for c in result)
    wanted = [n.manifold.form.dim > 0 for n in node.operands]
    if not any(wanted) or node.manifold.form.dim == 0:
        return []
    blocks = local_blocks(node.operation, value, lifted, [n.manifold for n in node.operands], wanted)
    entries = [x for chain in blocks if chain is not None for m in plain(chain) for row in m for x in row]
    return [float(ca.evalf(ca.SX(x))) for x in entries]
