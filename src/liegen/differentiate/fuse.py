"""Operations that are cheaper together, Jacobians included, become one."""

from __future__ import annotations

from itertools import permutations

from liegen.charts import Preset, form_chart
from liegen.manifolds import Node, Operation
from liegen.manifolds.form import GroupForm
from liegen.manifolds.relative import interpolation
from liegen.trace import Graph
from liegen.trace.graph import rebuilt


def fused(graph: Graph) -> Graph:
    """The graph with each z.local(x.between(y)) and x.retract(a * x.local(y)) as one operation.

    The same graph if there is none. Only for Jacobians: nodes that are gone are not shown any more.
    """
    return rebuilt(graph, lambda n, operands: _local_between(n, operands) or _interpolation(n, operands))


def _local_between(node: Node, operands: tuple[Node, ...]) -> Node | None:
    """z.local(c) with c = x.between(y) as one operation on z, x and y, in the chart of ``local``."""
    operation = node.operation
    if operation.name != "local" or operands[1].operation.name != "between":
        return None
    z, c = operands
    form = c.manifold.form
    presets = [p for p in operation.parameters if isinstance(p, Preset)]
    chart = form_chart(form, presets[0]) if presets else None
    offers = form if isinstance(form, GroupForm) else None
    known = chart.local_between() if chart else offers.local_between() if offers else None
    if known is None:
        return None
    value, blocks = known
    one = Operation("local_between", operation.result, value, blocks, "{0}.local({1}.between({2}))")
    return Node(one, (z, *c.operands), node.site)


def _interpolation(node: Node, operands: tuple[Node, ...]) -> Node | None:
    """x.retract(a * x.local(y)), also as x @ X.exp(a * x.local(y)), as one operation on x, y and a."""
    form = node.manifold.form
    if not isinstance(form, GroupForm) or not form.exponential or form.flat:
        return None
    if _is(node, "compose") and _is(operands[1], "exp"):
        step = operands[1].operands[0]
    elif _is(node, "retract"):
        step = operands[1]
    else:
        return None
    found = [
        (a, r) for a, r in permutations(step.operands) if a.manifold.form.dim == 1 and _is(r, "local")
    ] if _is(step, "mul") else []  # fmt: skip
    if not found or found[0][1].operands[0] is not operands[0]:
        return None
    ((a, r),) = found[:1]
    value, blocks = interpolation(form)
    one = Operation("interpolate", node.manifold, value, blocks, "{0}.interpolate({1}, {2})")
    return Node(one, (*r.operands, a), node.site)


def _is(node: Node, name: str) -> bool:
    """Whether the node is this operation in the default chart."""
    return node.operation.name == name and not node.operation.parameters
