"""The one table of Jacobian blocks per operation, as trees that both notations print."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from liegen.manifolds import SO2, Node, Value
from liegen.manifolds.form import GroupForm
from liegen.manifolds.gal3_form import Gal3Form
from liegen.manifolds.se23_form import SE23Form
from liegen.manifolds.sim2_form import Sim2Form
from liegen.manifolds.sim3_form import Sim3Form

from .notation import IDENTITY, RESULT, Block, Part

#: A block per operand; None where an operand has none.
Blocks = tuple[Block | None, ...]


def _of(head: str, *parts: Part) -> Block:
    return Block(head, parts)


I, ZERO, ONE, J = IDENTITY, Block("0"), Block("1"), Block("J")  # noqa: E741
Ad, Jr, R, matrix, B = (partial(_of, head) for head in ("Ad", "Jr", "R", "matrix", "B"))
Jr_inverse, Jl_inverse = partial(_of, "Jr^-1"), partial(_of, "Jl^-1")
inverse, transpose, square, skew = (partial(_of, h) for h in ("inverse", "transpose", "square", "skew"))
scale = partial(_of, "scale")
product, total, quotient = (partial(_of, h) for h in ("product", "sum", "quotient"))
row, column, unit_row, length = (partial(_of, h) for h in ("row", "column", "unit row", "length"))

_ADDITIVE: Mapping[str, Blocks] = {
    "compose": (I, I),
    "inverse": (-I,),
    "between": (-I, I),
    "exp": (I,),
    "log": (I,),
    "retract": (I, I),
    "local": (-I, I),
}
_GROUP: Mapping[str, Blocks] = {
    "compose": (Ad(inverse(1)), I),
    "inverse": (-Ad(0),),
    "between": (-Ad(inverse(RESULT)), I),
    "exp": (Jr(0),),
    "log": (Jr_inverse(RESULT),),
    "retract": (Ad(inverse(_of("Exp", 1))), Jr(1)),
    "local": (-Jl_inverse(RESULT), Jr_inverse(RESULT)),
}
_PLANE: Mapping[str, Blocks] = {
    "rotate": (product(matrix(0), J, 1), matrix(0)),
    "unrotate": (-product(J, RESULT), transpose(matrix(0))),
    "transform_from": (product(R(0), row(I, product(J, 1))), R(0)),
    "transform_to": (-row(I, product(J, RESULT)), transpose(R(0))),
    "rotation": (row(ZERO, ONE),),
    "translation": (product(R(0), row(I, ZERO)),),
    "pose": (column(ZERO, ONE), column(transpose(matrix(0)), ZERO)),
    "direction": (quotient(transpose(product(J, 0)), square(length(0))),),
}
_SPACE: Mapping[str, Blocks] = {
    "rotate": (-product(matrix(0), skew(1)), matrix(0)),
    "unrotate": (skew(RESULT), transpose(matrix(0))),
    "transform_from": (product(R(0), row(-skew(1), I)), R(0)),
    "transform_to": (row(skew(RESULT), -I), transpose(R(0))),
    "rotation": (row(I, ZERO),),
    "translation": (product(R(0), row(ZERO, I)),),
    "pose": (column(I, ZERO), column(ZERO, transpose(matrix(0)))),
    "direction": (quotient(B(RESULT), length(0)),),
    "vector": (transpose(B(0)),),
}
_EXTENDED: Mapping[str, Blocks] = {
    "rotation": (row(I, ZERO, ZERO),),
    "position": (product(R(0), row(ZERO, I, ZERO)),),
    "velocity": (product(R(0), row(ZERO, ZERO, I)),),
    "pose_of": (Block("rows", detail="0:6"),),
    "extended_pose": (
        column(I, ZERO, ZERO),
        column(ZERO, transpose(matrix(0)), ZERO),
        column(ZERO, ZERO, transpose(matrix(0))),
    ),
}
_GALILEAN: Mapping[str, Blocks] = {
    "rotation": (row(I, ZERO, ZERO, ZERO),),
    "position": (row(ZERO, R(0), ZERO, _of("velocity", 0)),),
    "velocity": (product(R(0), row(ZERO, ZERO, I, ZERO)),),
    "time": (row(ZERO, ZERO, ZERO, ONE),),
    "event": (
        column(I, ZERO, ZERO, ZERO),
        column(ZERO, transpose(matrix(0)), ZERO, ZERO),
        column(ZERO, ZERO, transpose(matrix(0)), ZERO),
        column(ZERO, -product(transpose(matrix(0)), 2), ZERO, ONE),
    ),
}
_SIMILAR_PLANE: Mapping[str, Blocks] = {
    "transform_from": (product(scale(0), R(0), row(I, product(J, 1), 1)), product(scale(0), R(0))),
    "transform_to": (-row(I, product(J, RESULT), RESULT), quotient(transpose(R(0)), scale(0))),
    "rotation": (row(ZERO, ONE, ZERO),),
    "translation": (product(scale(0), R(0), row(I, ZERO, ZERO)),),
    "scale": (product(RESULT, row(ZERO, ZERO, ONE)),),
    "similarity": (
        column(ZERO, ONE, ZERO),
        column(quotient(transpose(matrix(0)), 2), ZERO, ZERO),
        column(ZERO, ZERO, quotient(ONE, 2)),
    ),
}
_SIMILAR_SPACE: Mapping[str, Blocks] = {
    "transform_from": (product(scale(0), R(0), row(-skew(1), I, 1)), product(scale(0), R(0))),
    "transform_to": (-row(-skew(RESULT), I, RESULT), quotient(transpose(R(0)), scale(0))),
    "rotation": (row(I, ZERO, ZERO),),
    "translation": (product(scale(0), R(0), row(ZERO, I, ZERO)),),
    "scale": (product(RESULT, row(ZERO, ZERO, ONE)),),
    "similarity": (
        column(I, ZERO, ZERO),
        column(ZERO, quotient(transpose(matrix(0)), 2), ZERO),
        column(ZERO, ZERO, quotient(ONE, 2)),
    ),
}
_VECTOR: Mapping[str, Blocks] = {
    "add": (I, I),
    "sub": (I, -I),
    "neg": (-I,),
    "norm": (unit_row(0),),
    "dot": (transpose(1), transpose(0)),
    "cross": (-skew(1), skew(0)),
    "matmul": (Block("M"),),
    "where": (None, _of("holds", 0), _of("fails", 0)),
}
#: Slopes of elementwise functions; on vectors they stand on a diagonal.
_SLOPE: Mapping[str, tuple[Block | int, ...]] = {
    "mul": (1, 0),
    "div": (quotient(ONE, 1), -quotient(RESULT, 1)),
    "sin": (_of("cos", 0),),
    "cos": (-_of("sin", 0),),
    "tan": (total(ONE, square(RESULT)),),
    "asin": (quotient(ONE, _of("sqrt", total(ONE, -square(0)))),),
    "acos": (-quotient(ONE, _of("sqrt", total(ONE, -square(0)))),),
    "sqrt": (quotient(ONE, product(Block("2"), RESULT)),),
    "exp": (_of("exp", 0),),
    "log": (quotient(ONE, 0),),
    "abs": (_of("sign", 0),),
    "atan2": (
        quotient(1, total(square(0), square(1))),
        -quotient(0, total(square(0), square(1))),
    ),
    "minimum": (_of("less", 0, 1), _of("less", 1, 0)),
    "maximum": (_of("less", 1, 0), _of("less", 0, 1)),
}


def blocks(node: Node) -> Blocks:
    """A block per operand of a node, with its operands and itself in the places."""
    return tuple(block and block.at(node) for block in _places(node))


def elementwise(node: Node) -> bool:
    """Whether ``exp`` and ``log`` are the scalar functions: those of a group are shown with its class."""
    name = node.operation.name
    return name not in ("exp", "log") or node.operation.show.startswith(name)


def additive(node: Node) -> bool:
    """Whether a group operation acts on an additive group."""
    return _own(node).form.flat


def exponential(node: Node) -> bool:
    """Whether an operation is that of a group, and follows the exponential chart if it is one of a chart."""
    form = _own(node).form
    of_chart = node.operation.name in ("retract", "local")
    return isinstance(form, GroupForm) and (form.exponential or not of_chart) and not charted(node)


def charted(node: Node) -> bool:
    """Whether a node is ``local`` or ``retract`` in a chart that is not the group's own."""
    return node.operation.name in ("local", "retract") and bool(node.operation.parameters)


def _parts(node: Node) -> Mapping[str, Blocks]:
    """The table for the parts and the actions of the manifolds that a node is about."""
    forms = (_own(node).form, node.manifold.form)
    for kind, table in ((Sim2Form, _SIMILAR_PLANE), (Sim3Form, _SIMILAR_SPACE)):
        if any(isinstance(form, kind) for form in forms):
            return table
    if any(form.name in ("SO2", "SE2") for form in forms):
        return _PLANE
    if any(isinstance(form, SE23Form) for form in forms):
        return _EXTENDED
    return _GALILEAN if any(isinstance(form, Gal3Form) for form in forms) else _SPACE


def _own(node: Node) -> type[Value]:
    return node.manifold if node.operation.name == "exp" else node.operands[0].manifold


def _places(node: Node) -> Blocks:
    name, operands = node.operation.name, node.operands
    if name == "take":
        return (Block("rows", detail=positions(node.operation.parameters)),)
    if name == "part":
        return (Block("rows", detail=positions(node.operation.parameters[1])),)
    if name in ("stack", "product"):
        return tuple(_columns(node))
    if name in _SLOPE and elementwise(node):
        return tuple(_slope(slope, k, node) for k, slope in enumerate(_SLOPE[name]))
    own = _own(node)
    if charted(node):
        return _of_chart(node)
    flat = additive(node) or issubclass(own, SO2)
    curved: Mapping[str, Blocks] = _GROUP if exponential(node) else {}
    for table in (_ADDITIVE if flat else curved, _parts(node), _VECTOR):
        if name in table:
            return table[name]
    return _derivatives(name, len(operands))


def _of_chart(node: Node) -> Blocks:
    """The Jacobians of a chart's maps, named like those of the exponential with the chart in brackets."""
    name = node.operation.parameters[0].name
    first, second = {"local": ("Jl^-1 of", "Jr^-1 of"), "retract": ("Ad of", "Jr of")}[node.operation.name]
    detail = "chart" if "(" in name else name
    by_first = Block(first, (0, 1), detail, negative=node.operation.name == "local")
    return by_first, Block(second, (0, 1), detail)


def _derivatives(name: str, operands: int) -> Blocks:
    """``D1[f](a, b)``: where there is no shorter name."""
    numbers = [""] if operands == 1 else [str(k + 1) for k in range(operands)]
    return tuple(Block("derivative", tuple(range(operands)), f"{number}[{name}]") for number in numbers)


def _slope(slope: Block | int, k: int, node: Node) -> Block:
    """An elementwise slope: a number, a column, a multiple of the identity, or a diagonal."""
    body = slope if isinstance(slope, Block) else product(slope)
    dims = [n.manifold.form.dim for n in node.operands]
    read = {place if isinstance(place, int) and place >= 0 else k for place in body.values()}
    scalar = node.manifold.form.dim == 1 or dims[k] == 1 or all(dims[j] == 1 for j in read)
    if scalar:
        return body
    return -_of("diag", -body) if body.negative else _of("diag", body)


def positions(taken: tuple[int, ...]) -> str:
    """``2``, ``0:2``, or a list."""
    start, end = taken[0], taken[-1] + 1
    whole = taken == tuple(range(start, end))
    return f"{start}" if len(taken) == 1 else f"{start}:{end}" if whole else str([*taken])


def _columns(node: Node) -> Iterator[Block]:
    start = 0
    for operand in node.operands:
        n = operand.manifold.form.dim
        yield Block("columns", detail=f"{start}:{start + n}")
        start += n
