"""Gauss-Newton terms of a factor as a kernel of their own: cost, g = J^T r and the blocks of H = J^T J."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations_with_replacement

from liegen.algebra import Scalar
from liegen.algebra.linear import Matrix, Vector, dot, eye
from liegen.choice import Ledger, entries, opened
from liegen.derive import lowered_outputs, weight_symbols
from liegen.differentiate import Ladder, Terms, expressions, ladder, linearised, nested, normal_terms
from liegen.kernel import Kernel, Output, PassCount
from liegen.names import block_name, gradient_name
from liegen.noise import Weighted, Weighting
from liegen.program import Port, Program
from liegen.program.passes import optimise
from liegen.program.rewrite import uncollected
from liegen.trace import Graph, Parameter

#: Programs that are larger than the smallest by this share, by a first count, do not get all passes.
MARGIN = 0.02
#: Entries of blocks that the search for a frontier may make, structure included: a second or so.
BUDGET = 400_000


@uncollected()
def gauss_newton_kernel(kernel: Kernel, graph: Graph, weighting: Weighting | None) -> Kernel:
    """The terms of a derived factor, from its graph without noise and loss.

    Outputs: ``cost`` (half the squared norm of the residual, or half of rho); for each variable ``g_x``,
    shape (dim,); for each pair of variables in their order ``H_x_y``, shape (dim x, dim y), symmetric where
    both are one variable. H and g are those of the whitened, weighed residual and Jacobians of the factor
    itself. Where they are formed is a choice: each frontier of :func:`normal_terms` is tried, with products
    that act on vectors as they are and nested, and the program with the fewest operations is kept.
    """
    graphs = {id(g): g for g in (graph, nested(graph))}
    found = [_best(g, weighting) for g in graphs.values()]
    best, rows = min(found, key=lambda one: one[0].operations)
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


def _best(graph: Graph, weighting: Weighting | None) -> tuple[Program, tuple[tuple[str, int], ...]]:
    """The program of a graph's terms that takes the fewest operations, and its passes."""
    values = expressions(graph)
    given = weight_symbols(graph, weighting)
    ((_, node),) = graph.outputs
    r = values.scalars[id(node)]
    cost = weighting.cost(given, r) if weighting else 0.5 * dot(r, r)
    weighted = weighting.weighted(given, r) if weighting else Weighted(r, eye(len(r)), r, 0)
    ladders = [ladder(local) for local in linearised(graph, values)]
    blocks = [((cost,),), *weighted.blocks, *[m for steps in ladders for m in steps.blocks]]
    begun = lowered_outputs(graph, values, given, (), entries(blocks))
    ranking = _ranked(*opened(begun, blocks), ladders)
    least = min(count for count, _, _ in ranking)
    programs = [
        lowered_outputs(graph, values, given, _ports(cost, _terms(steps, weighted, frontier)))
        for count, steps, frontier in ranking
        if count <= (1 + MARGIN) * least
    ]
    return min((optimise(program) for program in programs), key=lambda found: found[0].operations)


def _ranked(
    ledger: Ledger, counted: Sequence[Matrix], ladders: Sequence[Ladder]
) -> list[tuple[int, Ladder, int]]:
    """The local blocks, as they are or without what cancels, and the frontier, with what these take.

    Operations up to negations, fewest first. Of those that need the same ones there is one, and none of those
    that take far more.
    """
    (cost, *weighted), left = counted[:5], iter(counted[5:])
    found: dict[bytes, tuple[int, Ladder, int]] = {}
    for steps in ladders:
        own = steps.holding([next(left) for _ in steps.blocks])
        for frontier in steps.worth_trying(BUDGET):
            nodes = ledger.taken(partial(_multiplied, cost, weighted, own, frontier))
            if nodes is not None:
                found[nodes] = (ledger.count(nodes), steps, frontier)
    return sorted(found.values(), key=lambda choice: choice[0])


def _multiplied(cost: Matrix, weighted: Sequence[Matrix], steps: Ladder, frontier: int) -> list[Matrix]:
    terms = _terms(steps, Weighted.of(weighted), frontier)
    return [cost, *[(g,) for g in terms.g.values()], *terms.H.values()]


def _terms(steps: Ladder, weighted: Weighted, frontier: int) -> Terms:
    return normal_terms(steps, weighted.residual, weighted.jacobian, frontier)


def _ports(cost: Scalar, terms: Terms) -> list[tuple[Port, Vector]]:
    gradients = [(Port(gradient_name(name), (len(g),)), g) for name, g in terms.g.items()]
    blocks = [
        (Port(block_name(a, b), (len(H), len(H[0]))), tuple([x for row in H for x in row]))
        for (a, b), H in terms.H.items()
    ]
    return [(Port("cost", (1,)), (cost,)), *gradients, *blocks]


def _outputs(graph: Graph, weighting: Weighting | None) -> tuple[Output, ...]:
    variables = graph.variables
    cost = "half of rho" if weighting and weighting.loss else "half the squared norm of the residual"
    gradients = [
        Output(
            gradient_name(p.name),
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
    return Output(block_name(p.name, q.name), meaning, places, len(places), shape=shape)


def _formulas(kernel: Kernel, r: str, weighting: Weighting | None) -> tuple[str, ...]:
    names = [v.name for v in kernel.variables]
    cost = "rho(s) / 2" if weighting and weighting.loss else f"|{r}|^2 / 2"
    return (
        f"cost = {cost}",
        *(f"{gradient_name(x)} = {r}_D_{x}^T {r}" for x in names),
        *(f"{block_name(x, y)} = {r}_D_{x}^T {r}_D_{y}" for x, y in combinations_with_replacement(names, 2)),
    )
