"""The Jacobians of a graph as text at group level: sums of products of named blocks.

The notation: ``Ad`` adjoint, ``Jr`` and ``Jl`` right and left Jacobian of the exponential, ``R(x)`` rotation
matrix, ``[v]x`` matrix of the vector product, ``J`` quarter turn of the plane, ``I[0:2]`` rows and
``I[:, 0:2]`` columns of the identity, ``B(n)`` tangent basis at a direction, ``D2[f](a, b)`` the derivative
of f by its second operand where there is no shorter name.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from string import Formatter

from liegen.charts import form_chart
from liegen.manifolds import SO2, Leaf, Node, Vector
from liegen.manifolds.additive_form import AdditiveForm
from liegen.manifolds.form import GroupForm

from .formulas import free_names, named_values, texts_of
from .graph import Graph

#: Signs and factors of a product; no factors stand for the identity.
Term = tuple[int, tuple[str, ...]]
Labels = tuple[str, ...]

#: Labels per operand, formats in the operands ``{0} {1}`` and the result ``{r}``. "I" vanishes in a product.
_ADDITIVE: Mapping[str, Labels] = {
    "compose": ("I", "I"),
    "inverse": ("-I",),
    "between": ("-I", "I"),
    "exp": ("I",),
    "log": ("I",),
    "retract": ("I", "I"),
    "local": ("-I", "I"),
}
_GROUP: Mapping[str, Labels] = {
    "compose": ("Ad({1}^-1)", "I"),
    "inverse": ("-Ad({0})",),
    "between": ("-Ad({r}^-1)", "I"),
    "exp": ("Jr({0})",),
    "log": ("Jr^-1({r})",),
    "retract": ("Ad(Exp({1})^-1)", "Jr({1})"),
    "local": ("-Jl^-1({r})", "Jr^-1({r})"),
}
_PLANE: Mapping[str, Labels] = {
    "rotate": ("R({0}) J {1}", "R({0})"),
    "unrotate": ("-J {r}", "R({0})^T"),
    "transform_from": ("R({0}) [I, J {1}]", "R({0})"),
    "transform_to": ("-[I, J {r}]", "R({0})^T"),
    "rotation": ("[0, 1]",),
    "translation": ("R({0}) [I, 0]",),
    "pose": ("[0; 1]", "[R({0})^T; 0]"),
    "direction": ("((J {0})^T / |{0}|^2)",),
}
_SPACE: Mapping[str, Labels] = {
    "rotate": ("-R({0}) [{1}]x", "R({0})"),
    "unrotate": ("[{r}]x", "R({0})^T"),
    "transform_from": ("R({0}) [-[{1}]x, I]", "R({0})"),
    "transform_to": ("[[{r}]x, -I]", "R({0})^T"),
    "rotation": ("[I, 0]",),
    "translation": ("R({0}) [0, I]",),
    "pose": ("[I; 0]", "[0; R({0})^T]"),
    "direction": ("(B({r}) / |{0}|)",),
    "vector": ("B({0})^T",),
}
_VECTOR: Mapping[str, Labels] = {
    "add": ("I", "I"),
    "sub": ("I", "-I"),
    "neg": ("-I",),
    "norm": ("unit({0})^T",),
    "dot": ("{1}^T", "{0}^T"),
    "cross": ("-[{1}]x", "[{0}]x"),
    "matmul": ("M",),
    "where": ("", "[{0}]", "[~({0})]"),
}
#: Slopes of elementwise functions; on vectors they stand on a diagonal.
_SLOPE: Mapping[str, Labels] = {
    "mul": ("{1}", "{0}"),
    "div": ("1 / {1}", "-{r} / {1}"),
    "sin": ("cos({0})",),
    "cos": ("-sin({0})",),
    "tan": ("(1 + {r}^2)",),
    "asin": ("1 / sqrt(1 - {0}^2)",),
    "acos": ("-1 / sqrt(1 - {0}^2)",),
    "sqrt": ("1 / (2 {r})",),
    "exp": ("exp({0})",),
    "log": ("1 / {0}",),
    "abs": ("sign({0})",),
    "atan2": ("{1} / ({0}^2 + {1}^2)", "-{0} / ({0}^2 + {1}^2)"),
    "minimum": ("[{0} < {1}]", "[{1} < {0}]"),
    "maximum": ("[{1} < {0}]", "[{0} < {1}]"),
}

#: What occurs in a line, and what it means.
_LEGEND: Mapping[str, str] = {
    "Ad(": "Ad(x): adjoint, x Exp(d) = Exp(Ad(x) d) x",
    "Jr": "Jr(d), Jr^-1(d): right Jacobian of Exp at d and its inverse",
    "Jl": "Jl^-1(d): inverse of the left Jacobian, Jl(d) = Jr(-d)",
    "R(": "R(x): rotation matrix of x",
    "]x": "[v]x: the matrix with [v]x w = v x w",
    "J ": "J: quarter turn [[0, -1], [1, 0]]",
    "B(": "B(n): tangent basis at the direction n, 2 x 3",
    "unit(": "unit(v): v / |v|, and 0 at 0",
    "I[": "I[0:2], I[:, 0:2]: these rows, columns of the identity",
    "diag(": "diag(v): diagonal matrix",
    " M": "M: the constant matrix of the formula",
    "D[": "D[f](a): derivative of f at a",
    "Chart(": "Chart(x): column map of the chart of x, d Log(x^-1 x.retract(d))/dd at 0",
    "Chart^-1(": "Chart^-1(x): inverse of the column map of the chart of x",
    "D1[": "D1[f](a, b): derivative of f by its first operand",
    "D2[": "D2[f](a, b): derivative of f by its second operand",
}


def legend(lines: tuple[str, ...]) -> tuple[str, ...]:
    """The notation that occurs in the lines of :func:`jacobian_formulas`."""
    right = [line.partition(" = ")[2] for line in lines if "_D_" in line.partition(" = ")[0]]
    text = " " + " ".join(right)
    return tuple(meaning for mark, meaning in _LEGEND.items() if mark in text)


def jacobian_formulas(graph: Graph) -> tuple[str, ...]:
    """Lines such as ``res_D_x = -Jr^-1(res) Ad(a^-1)``, after the names that they use and ``formula`` lacks.

    Values that several others use have lines of their own, so the text stays as short as the graph.
    """
    variables = {id(p.node): p.name for p in graph.parameters if p.variable}
    charted = {p.name for p in graph.parameters if form_chart(p.manifold.form, p.chart)}
    active = _active(graph, variables)
    shared = named_values(graph)
    names, extra = _all_names(graph, active, shared)
    texts = {key: shown.text for key, shown in texts_of(graph, names).items()}
    lines = [f"{names[id(n)]} = {texts[id(n)]}" for n in extra]
    refer = _Refer(names, texts)
    outputs = {id(node) for _, node in graph.outputs}
    derivatives: dict[int, dict[str, list[Term]]] = {}
    for node in active:
        terms = _chain_rule(node, derivatives, refer, variables, charted)
        several = id(node) in shared or any(len(products) > 1 for products in terms.values())
        if several and id(node) in names and id(node) not in outputs:
            terms = dict(_own_lines(names[id(node)], terms, lines))
        derivatives[id(node)] = terms
    for name, node in graph.outputs:
        terms = _in_rows(node, name, derivatives.get(id(node), {}), graph)
        lines += [f"{name}_D_{v} = {_sum(terms.get(v, []))}" for v in variables.values()]
    return tuple(lines)


def _own_lines(
    name: str, terms: Mapping[str, list[Term]], lines: list[str]
) -> Iterator[tuple[str, list[Term]]]:
    """Give the derivatives of a named value names, unless they are the identity."""
    for variable, products in terms.items():
        if len(products) == 1 and not products[0][1]:
            yield variable, products
            continue
        lines.append(f"{name}_D_{variable} = {_sum(products)}")
        yield variable, [(1, (f"{name}_D_{variable}",))]


@dataclass(frozen=True)
class _Refer:
    """How a value is called inside a label."""

    names: Mapping[int, str]
    texts: Mapping[int, str]

    def __call__(self, node: Node) -> str:
        return self.names.get(id(node)) or self.texts[id(node)]


def _chain_rule(
    node: Node,
    derivatives: Mapping[int, Mapping[str, list[Term]]],
    refer: Callable[[Node], str],
    variables: Mapping[int, str],
    charted: Collection[str],
) -> dict[str, list[Term]]:
    """The derivative of a node by each variable, from those of its operands."""
    if id(node) in variables:
        name = variables[id(node)]
        return {name: [(1, (f"Chart({name})",) if name in charted else ())]}
    terms: dict[str, list[Term]] = {}
    fields = {str(k): refer(n) for k, n in enumerate(node.operands)} | {"r": refer(node)}
    for label, operand in zip(labels(node), node.operands, strict=True):
        sign, factors = _factors(_filled(label, fields))
        for variable, products in derivatives.get(id(operand), {}).items():
            terms.setdefault(variable, []).extend((sign * s, (*factors, *rest)) for s, rest in products)
    return terms


def labels(node: Node) -> Labels:
    """A format per operand for the blocks of one node."""
    name, operands = node.operation.name, node.operands
    if name == "take":
        return (f"I[{_positions(node.operation.parameters)}]",)
    if node.operation.parameters and name in ("local", "retract"):  # in a chart that is not the group's own
        return (f"D1[{name}]({{0}}, {{1}})", f"D2[{name}]({{0}}, {{1}})")
    if name == "stack":
        return tuple(_columns(node))
    first, dim = operands[0].manifold, node.manifold.form.dim
    # R3.exp, the exponential of a group, is shown with its class
    if name in _SLOPE and not (name in ("exp", "log") and not node.operation.show.startswith(name)):
        dims = [n.manifold.form.dim for n in operands]
        return tuple(_slope(text, k, dims, dim) for k, text in enumerate(_SLOPE[name]))
    own = node.manifold if name == "exp" else first
    flat = issubclass(own, (Vector, SO2)) or isinstance(own.form, AdditiveForm)
    curved: Mapping[str, Labels] = _GROUP if isinstance(own.form, GroupForm) else {}
    planar = own.form.name in ("SO2", "SE2") or node.manifold.form.name in ("SO2", "SE2")
    for table in (_ADDITIVE if flat else curved, _PLANE if planar else _SPACE, _VECTOR):
        if name in table:
            return table[name]
    places = ", ".join(f"{{{k}}}" for k in range(len(operands)))
    if len(operands) == 1:
        return (f"D[{name}]({places})",)
    return tuple(f"D{k + 1}[{name}]({places})" for k in range(len(operands)))


def _in_rows(
    node: Node, name: str, terms: Mapping[str, list[Term]], graph: Graph
) -> Mapping[str, list[Term]]:
    """The rows of an output on a group in its chart."""
    if form_chart(node.manifold.form, graph.chart) is None:
        return terms
    return {v: [(s, (f"Chart^-1({name})", *rest)) for s, rest in products] for v, products in terms.items()}


def _slope(text: str, k: int, dims: list[int], dim: int) -> str:
    """An elementwise slope: a number, a column, a multiple of the identity, or a diagonal."""
    sign, body = ("-", text[1:]) if text.startswith("-") else ("", text)
    body = f"({body})" if " / " in body else body
    read = {int(f) if f.isdigit() else k for f in _fields(body)}
    scalar = dim == 1 or dims[k] == 1 or all(dims[j] == 1 for j in read)
    return sign + (body if scalar else f"diag{body}" if body.startswith("(") else f"diag({body})")


def _positions(positions: tuple[int, ...]) -> str:
    start, end = positions[0], positions[-1] + 1
    whole = positions == tuple(range(start, end))
    return f"{start}" if len(positions) == 1 else f"{start}:{end}" if whole else str([*positions])


def _columns(node: Node) -> Iterator[str]:
    start = 0
    for operand in node.operands:
        n = operand.manifold.form.dim
        yield f"I[:, {start}:{start + n}]"
        start += n


def _fields(label: str) -> list[str]:
    return [field for _, field, _, _ in Formatter().parse(label) if field]


def _filled(label: str, fields: Mapping[str, str]) -> str:
    return Formatter().vformat(label, [fields[str(k)] for k in range(len(fields) - 1)], fields)


def _factors(label: str) -> tuple[int, tuple[str, ...]]:
    sign, body = (-1, label[1:]) if label.startswith("-") else (1, label)
    return sign, () if body == "I" else (body,)


def _sum(terms: list[Term]) -> str:
    text = ""
    for sign, factors in terms:
        product = " ".join(factors) or "I"
        text += f" {'-' if sign < 0 else '+'} {product}" if text else f"{'-' if sign < 0 else ''}{product}"
    return text or "0"


def _active(graph: Graph, variables: Mapping[int, str]) -> list[Node]:
    """The nodes that depend on a variable, operands first."""
    below: dict[int, Node] = {}
    for node in graph.nodes():
        through = node.manifold.form.dim > 0 and any(id(n) in below for n in node.operands)
        if id(node) in variables or through:
            below[id(node)] = node
    return list(below.values())


def _all_names(
    graph: Graph, active: list[Node], shared: Mapping[int, str]
) -> tuple[dict[int, str], list[Node]]:
    """Names for shared values and outputs, and for what the labels speak of; the last need definitions."""
    names = dict(shared)
    for name, node in graph.outputs:
        if not isinstance(node.operation, Leaf):
            names.setdefault(id(node), name)
    depends = {id(n) for n in active}
    spoken: set[int] = set()
    for node in active:
        if not node.operands:
            continue
        for label, operand in zip(labels(node), node.operands, strict=True):
            if id(operand) in depends:
                spoken |= {id(node) if f == "r" else id(node.operands[int(f)]) for f in _fields(label)}
    taken = {p.name for p in graph.parameters} | {name for name, _ in graph.outputs} | set(shared.values())
    free = free_names(taken)
    extra: list[Node] = []
    for node in graph.nodes():
        if id(node) in spoken and id(node) not in names and not _short(node, names):
            names[id(node)] = next(free)
            extra.append(node)
    return names, extra


def _short(node: Node, names: Mapping[int, str]) -> bool:
    """A parameter, a constant, an entry of a named value, or a comparison: its text can stand in a label."""
    if node.operation.name == "take":
        return id(node.operands[0]) in names or isinstance(node.operands[0].operation, Leaf)
    return isinstance(node.operation, Leaf) or node.manifold.form.dim == 0
