"""The graph of a weighed factor, which verification and samples read: the reference has a rule for it."""

from __future__ import annotations

from dataclasses import replace

from liegen.algebra import Scalar
from liegen.algebra.linear import Vector as Coordinates
from liegen.errors import DefinitionError
from liegen.manifolds import R1, Node, Operation, Value
from liegen.manifolds.node import parameter
from liegen.manifolds.vector import vector_class
from liegen.trace import Graph, Parameter

from .weigh import Weight, Weighting


def weighted_graph(graph: Graph, weighting: Weighting) -> Graph:
    """The graph with the weighting's keywords as given arguments, and the weighed residual.

    Raises DefinitionError where the factor has an argument of that name.
    """
    return _extended(graph, weighting, "weighted", graph.outputs[0][1].manifold)


def cost_graph(graph: Graph, weighting: Weighting) -> Graph:
    """The same arguments, with the cost 1/2 rho(|S r|^2) as output ``cost``."""
    return _extended(graph, weighting, "cost", R1)


def _extended(graph: Graph, weighting: Weighting, name: str, result: type[Value]) -> Graph:
    ((output, residual),) = graph.outputs
    weights = weighting.weights(residual.manifold.form.dim)
    _check_names(graph, weights)
    added = tuple(_parameter(graph, w) for w in weights)

    def value(*coords: Coordinates) -> Coordinates:
        given = dict(zip((w.name for w in weights), coords[1:], strict=True))
        if name == "cost":
            return (_cost(weighting, given, coords[0]),)
        return weighting.apply(given, coords[0], {})[0]

    names = ", ".join(f"{{{k}}}" for k in range(1 + len(weights)))
    settings = (
        weighting.noise.name if weighting.noise else "",
        weighting.loss.name if weighting.loss else "",
        weighting.mode.name,
    )
    operation = Operation(name, result, value, None, f"{name}({names})", settings)
    node = Node(operation, (residual, *(p.node for p in added)), graph.site)
    label = "cost" if name == "cost" else output
    return replace(graph, parameters=(*graph.parameters, *added), outputs=((label, node),))


def _cost(weighting: Weighting, given: dict[str, Coordinates], r: Coordinates) -> Scalar:
    return weighting.cost(given, r)


def _parameter(graph: Graph, weight: Weight) -> Parameter:
    cls = vector_class(weight.size)
    return Parameter(weight.name, cls, False, parameter(cls, weight.name, graph.site))


def _check_names(graph: Graph, weights: tuple[Weight, ...]) -> None:
    own = [p.name for p in graph.parameters]
    for weight in weights:
        if weight.name in own:
            raise DefinitionError(
                f"{graph.site}: {graph.name}: argument {weight.name!r} is also what noise or loss adds "
                f"({weight.meaning}); rename the argument"
            )
