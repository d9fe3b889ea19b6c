"""Gauss-Newton terms of a factor as a kernel of their own: cost, g = J^T r and the blocks of H = J^T J."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations_with_replacement

from liegen.algebra.linear import Matrix, Vector, dot
from liegen.derive import lowered_outputs, weight_symbols
from liegen.differentiate import Expressions, Terms, expressions, ladder, linearised, normal_terms
from liegen.kernel import Kernel, Output, PassCount
from liegen.noise import Weighting
from liegen.program import Port, Program
from liegen.program.passes import optimise
from liegen.program.passes.subexpressions import cse
from liegen.trace import Graph, Parameter

#: Programs that are larger than the smallest by this share, by a first count, do not get all passes.
MARGIN = 0.02


def gauss_newton_kernel(kernel: Kernel, graph: Graph, weighting: Weighting | None) -> Kernel:
    """The terms of a derived factor, from its graph without noise and loss.

    Outputs: ``cost`` (half the squared norm of the residual, or half of rho); for each variable ``g_x``,
    shape (dim,); for each pair of variables in their order ``H_x_y``, shape (dim x, dim y), symmetric where
    both are one variable. H and g are those of the whitened, weighed residual and Jacobians of the factor
    itself. Where they are formed is a choice: each frontier of :func:`normal_terms` is tried, and the
    program with the fewest operations is kept.
    """
    values = expressions(graph)
    counted = {cse(program).operations: program for program in _candidates(graph, values, weighting)}
    near = [counted[n] for n in sorted(counted) if n <= (1 + MARGIN) * min(counted)]
    best, rows = min((optimise(program) for program in near), key=lambda found: found[0].operations)
    (residual,) = kernel.outputs
    return replace(
        kernel,
        name=f"{kernel.name}_gauss_newton",
        doc=f"Gauss-Newton terms of {kernel.name}.\n\n{kernel.doc}",
        arguments=tuple(replace(a, variable=False, named=not a.variable) for a in kernel.arguments),
        outputs=_outputs(graph, weighting),
        jacobian_formulas=(*kernel.jacobian_formulas, *_formulas(kernel, residual.name, weighting)),
        value=best,
        jacobians=best,
        passes=tuple(PassCount(*row) for row in rows),
        in_place=False,
    )


def _candidates(graph: Graph, values: Expressions, weighting: Weighting | None) -> Iterator[Program]:
    """A program for each frontier, of the local blocks as they are and without what cancels."""
    ((_, node),) = graph.outputs
    residual, given = values.scalars[id(node)], weight_symbols(graph, weighting)
    cost = weighting.cost(given, residual) if weighting else 0.5 * dot(residual, residual)

    def weigh(blocks: Mapping[int, Matrix]) -> tuple[Vector, Mapping[int, Matrix]]:
        return weighting.apply(given, residual, blocks) if weighting else (residual, blocks)

    for local in linearised(graph, values):
        steps = ladder(local)
        for frontier in range(len(steps.order) + 1):
            terms = normal_terms(steps, weigh, frontier)
            yield lowered_outputs(graph, values, given, [(Port("cost", (1,)), (cost,)), *_ports(terms)])


def _ports(terms: Terms) -> Iterator[tuple[Port, Vector]]:
    for name, g in terms.g.items():
        yield Port(f"g_{name}", (len(g),)), g
    for (a, b), H in terms.H.items():
        yield Port(f"H_{a}_{b}", (len(H), len(H[0]))), tuple(x for row in H for x in row)


def _outputs(graph: Graph, weighting: Weighting | None) -> tuple[Output, ...]:
    variables = graph.variables
    cost = "half of rho" if weighting and weighting.loss else "half the squared norm of the residual"
    gradients = [
        Output(
            f"g_{p.name}",
            f"gradient by the tangent of {p.name}",
            p.manifold.form.tangent,
            p.manifold.form.dim,
        )
        for p in variables
    ]
    r = graph.outputs[0][0]
    blocks = [_block(r, p, q) for p, q in combinations_with_replacement(variables, 2)]
    return (Output("cost", cost, ("0",), 1), *gradients, *blocks)


def _block(r: str, p: Parameter, q: Parameter) -> Output:
    shape = (p.manifold.form.dim, q.manifold.form.dim)
    places = tuple(f"{i}_{j}" for i in range(shape[0]) for j in range(shape[1]))
    meaning = f"{shape[0]} x {shape[1]}, {r}_D_{p.name}^T {r}_D_{q.name}"
    return Output(f"H_{p.name}_{q.name}", meaning, places, len(places), shape=shape)


def _formulas(kernel: Kernel, r: str, weighting: Weighting | None) -> tuple[str, ...]:
    names = [v.name for v in kernel.variables]
    cost = "rho(s) / 2" if weighting and weighting.loss else f"|{r}|^2 / 2"
    return (
        f"cost = {cost}",
        *(f"g_{x} = {r}_D_{x}^T {r}" for x in names),
        *(f"H_{x}_{y} = {r}_D_{x}^T {r}_D_{y}" for x, y in combinations_with_replacement(names, 2)),
    )
