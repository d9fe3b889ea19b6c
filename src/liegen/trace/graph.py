"""``Graph``: a factor as a graph of typed operations, a frozen value."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

from liegen.charts import GTSAM, Preset
from liegen.errors import Site
from liegen.layouts import OWN, Storage, Stored, storage
from liegen.manifolds import Manifold, Node, Value

from .frame_declared import Declared
from .frame_report import FrameReport


@dataclass(frozen=True, eq=False)
class Parameter:
    """A named argument of a factor: a variable gets Jacobians, a given one does not."""

    name: str
    manifold: type[Manifold]
    variable: bool
    node: Node
    frames: Declared | None = None
    chart: Preset = GTSAM  # of its Jacobians' columns
    layout: Stored = OWN
    default: Value | None = None  # what a call may leave out

    @property
    def storage(self) -> Storage:
        """How it is stored."""
        return storage(self.manifold.form, self.layout)


@dataclass(frozen=True, eq=False)
class Domain:
    """A condition that must hold, and what to say where it does not."""

    condition: Node
    message: str


@dataclass(frozen=True, eq=False)
class Singular:
    """Points at which the formula has no derivative by its nature: where all of ``zeros`` are 0.

    Without ``zeros`` it speaks of every singular point of the formula.
    """

    message: str
    zeros: tuple[Node, ...]
    site: Site


@dataclass(frozen=True, eq=False)
class Call:
    """A factor or function that was called on traced values; its body is part of the graph."""

    name: str
    site: Site
    arguments: tuple[Parameter, ...]  # declared there, with the nodes that were given
    results: tuple[Node, ...]
    checked: bool  # whether its frames are


@dataclass(frozen=True, eq=False)
class Graph:
    """What a factor computes: parameters, named outputs, and the domain that it states."""

    name: str
    doc: str
    site: Site
    parameters: tuple[Parameter, ...]
    outputs: tuple[tuple[str, Node], ...]
    domain: tuple[Domain, ...]
    calls: tuple[Call, ...] = ()
    frames: FrameReport = field(default_factory=FrameReport)
    chart: Preset = GTSAM  # of local and retract, and of outputs on groups
    layout: Stored = OWN  # of the outputs
    normalise: bool = False  # whether arguments are brought to unit length
    singular: tuple[Singular, ...] = ()  # nothing is computed from it

    @property
    def variables(self) -> tuple[Parameter, ...]:
        """The parameters that get Jacobians."""
        return tuple(p for p in self.parameters if p.variable)

    def nodes(self) -> tuple[Node, ...]:
        """All nodes that outputs and domain need, operands first."""
        return self._nodes

    @cached_property
    def _nodes(self) -> tuple[Node, ...]:
        return topological([node for _, node in self.outputs] + [d.condition for d in self.domain])


def rebuilt(graph: Graph, change: Callable[[Node, tuple[Node, ...]], Node | None]) -> Graph:
    """The graph with another node where ``change`` gives one for a node and its new operands.

    The same graph where ``change`` never does. Nodes that are gone are not shown any more.
    """
    place: dict[int, Node] = {}
    changed = False
    for node in graph.nodes():
        operands = tuple(place[id(n)] for n in node.operands)
        found = change(node, operands)
        changed = changed or found is not None
        place[id(node)] = node.on(operands) if found is None else found
    if not changed:
        return graph
    return replace(
        graph,
        outputs=tuple((name, place[id(node)]) for name, node in graph.outputs),
        domain=tuple(replace(d, condition=place[id(d.condition)]) for d in graph.domain),
    )


def topological(roots: Iterable[Node]) -> tuple[Node, ...]:
    """The nodes under ``roots``, operands before their users, in a fixed order."""
    order: dict[int, Node] = {}
    stack: list[tuple[Node, Iterator[Node]]] = []
    for root in roots:
        stack.append((root, iter(root.operands)))
        while stack:
            node, rest = stack[-1]
            operand = next((n for n in rest if id(n) not in order), None)
            if operand is not None:
                stack.append((operand, iter(operand.operands)))
            else:
                order.setdefault(id(node), node)
                stack.pop()
    return tuple(order.values())
