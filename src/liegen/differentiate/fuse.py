"""Operations that are cheaper together, Jacobians included, become one."""

from __future__ import annotations

from dataclasses import replace

from liegen.manifolds import Node, Operation
from liegen.manifolds.form import GroupForm
from liegen.trace import Graph


def fused(graph: Graph) -> Graph:
    """The graph with each z.local(x.between(y)) as one operation, where its group offers that.

    The same graph if there is none. Only for Jacobians: nodes that are gone are not shown any more.
    """
    place: dict[int, Node] = {}
    changed = False
    for node in graph.nodes():
        operands = tuple(place[id(n)] for n in node.operands)
        same = all(a is b for a, b in zip(operands, node.operands, strict=True))
        found = _local_between(node, operands)
        changed = changed or found is not None
        place[id(node)] = found or (node if same else Node(node.operation, operands, node.site))
    if not changed:
        return graph
    return replace(
        graph,
        outputs=tuple((name, place[id(node)]) for name, node in graph.outputs),
        domain=tuple(replace(d, condition=place[id(d.condition)]) for d in graph.domain),
    )


def _local_between(node: Node, operands: tuple[Node, ...]) -> Node | None:
    """z.local(c) with c = x.between(y), in the default chart, as one operation on z, x and y."""
    operation = node.operation
    if operation.name != "local" or operation.parameters:
        return None
    z, c = operands
    form = c.manifold.form
    if c.operation.name != "between" or not isinstance(form, GroupForm):
        return None
    known = form.local_between()
    if known is None:
        return None
    value, blocks = known
    one = Operation("local_between", operation.result, value, blocks, "{0}.local({1}.between({2}))")
    return Node(one, (z, *c.operands), node.site)
