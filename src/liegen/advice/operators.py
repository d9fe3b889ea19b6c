"""What to write for an operator that a class does not have."""

from __future__ import annotations

import ast
from collections.abc import Callable

from .conditions import product_of
from .names import families
from .written import Text, Written, kind_of, text_of

_SIGNS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*"}
_NUMBERS = ("int", "float", "R1", "bool")
_VECTOR_OF = {
    "Pose": "{x:a}.translation", "Rotation": "{x:a}.log()", "S2": "{x:a}.vector",
    "Similarity": "{x:a}.translation", "ExtendedPose": "{x:a}.position", "Galilean": "{x:a}.position",
    "Condition": "where({x}, 1.0, 0.0)", "Group": "{x:a}.log()",
}  # fmt: skip


def vector_of(kind: type, x: Text) -> str:
    """What of a value is a vector; empty where nothing is."""
    row = next((_VECTOR_OF[f] for f in families(kind) if f in _VECTOR_OF), "")
    return row.format(x=x)


def _is_vector(kind: type | None) -> bool:
    return kind is not None and bool({"Vector", "ndarray", "list", "tuple", *_NUMBERS} & set(families(kind)))


def _is_number(kind: type | None) -> bool:
    return kind is not None and bool(set(_NUMBERS) & set(families(kind)))


def _is(kind: type | None, family: str) -> bool:
    return kind is not None and family in families(kind)


def for_operator(written: Written, left: type | None, right: type | None) -> str:
    """What to write for the operator that is being run, on operands of these classes."""
    node = written.node
    if isinstance(node, ast.AugAssign):
        op, a, b = node.op, text_of(node.target), text_of(node.value)
    elif isinstance(node, ast.BinOp):
        op, a, b = node.op, text_of(node.left), text_of(node.right)
        left, right = kind_of(node.left, written.names) or left, kind_of(node.right, written.names) or right
    elif isinstance(node, ast.UnaryOp):
        return _unary(node, left)
    elif isinstance(node, ast.Compare):
        names = written.names
        left, right = kind_of(node.left, names) or left, kind_of(node.comparators[0], names) or right
        return _compared(node, left, right)
    else:
        return ""
    if _is(left, "Condition") or _is(right, "Condition"):
        return product_of(written, a)
    if _is(left, "RotationMatrix") and _is(right, "RotationMatrix"):
        return f"{a:a}[i, j] {_SIGNS.get(type(op), '*')} {b:a}[i, j], entry by entry"
    rule = _RULES.get(type(op))
    cure = rule(a, b, left, right, written) if rule else ""
    return "" if cure == ast.unparse(node) else cure


def _unary(node: ast.UnaryOp, kind: type | None) -> str:
    x = text_of(node.operand)
    if _is(kind, "Condition"):
        return f"where({x}, {'-' if isinstance(node.op, ast.USub) else ''}1.0, 0.0)"
    if _is(kind, "S2"):
        return f"S2.direction(-{x:a}.vector)"
    if isinstance(node.op, ast.Invert) and _is(kind, "Vector"):
        return f"~({x} > 0): ~ is of a condition"
    return f"{x:a}.inverse()" if _is(kind, "Group") and not _is(kind, "Vector") else ""


def _compared(node: ast.Compare, left: type | None, right: type | None) -> str:
    a, b = text_of(node.left), text_of(node.comparators[0])
    loose = [side for side in (node.left, node.comparators[0]) if isinstance(side, ast.BinOp)]
    if any(isinstance(side.op, ast.BitAnd | ast.BitOr) for side in loose):
        return _parentheses(node)
    shown = [
        f"norm({t:a}.log())" if _is(k, "Group") and not _is(k, "Vector") else f"{t}"
        for t, k in ((a, left), (b, right))
    ]
    signs: dict[type[ast.cmpop], str] = {ast.Lt: "<", ast.Gt: ">", ast.LtE: "<=", ast.GtE: ">="}
    return f"{shown[0]} {signs.get(type(node.ops[0]), '<')} {shown[1]}"


def _parentheses(node: ast.Compare) -> str:
    """``(a > 0) & (b > 0)`` for ``a > 0 & b > 0``, in which & binds more tightly."""
    inner = next(s for s in (node.left, *node.comparators) if isinstance(s, ast.BinOp))
    sign = "&" if isinstance(inner.op, ast.BitAnd) else "|"
    whole = [node.left, *node.comparators]
    at = whole.index(inner)
    first = ast.unparse(ast.Compare(node.left, node.ops[:at], [*whole[1:at], inner.left])) if at else ""
    rest = [inner.right, *whole[at + 1 :]]
    second = ast.unparse(ast.Compare(rest[0], node.ops[at:], rest[1:])) if rest[1:] else ast.unparse(rest[0])
    return f"({first or ast.unparse(inner.left)}) {sign} ({second})"


def _product(a: Text, b: Text, left: type | None, right: type | None, _: Written) -> str:
    if _is(left, "Pose") and _is(right, "ExtendedPose"):
        return f"{a:a} @ {b:a}.pose"
    if _is(left, "ExtendedPose") and _is(right, "Pose"):
        return f"{a:a}.pose @ {b:a}"
    for x, y, k, other, swapped in ((a, b, left, right, False), (b, a, right, left, True)):
        if k is None or _is(k, "Vector") or not _is(k, "Manifold"):
            continue
        if _is(k, "Calibration"):
            return f"{x:a}.uncalibrate({y:a}[:2] / {y:a}[2])"
        if _is(k, "S2") and _is(other, "S2"):
            return f"dot({a:a}.vector, {b:a}.vector)"
        if _is(k, "S2"):
            return f"{y:a} @ {x:a}.vector" if _is(other, "Rotation") else f"{x:a}.vector * {y:a}"
        if _is_number(other):
            return f"{k.__name__}.exp({y:a} * {x:a}.log())"
        if _is_vector(other):
            return f"{x:a}.pose @ {y:a}" if _is(k, "ExtendedPose") else f"{x:a} @ {y:a}"
        if not swapped and _is(k, "Rotation") and _is(other, "Pose"):
            return f"{x:a} @ {y:a}.rotation"
        if not swapped and _is(k, "Pose") and _is(other, "Rotation"):
            return f"{x:a}.rotation @ {y:a}"
        if not swapped and _is(other, "S2"):
            return f"{x:a} @ {y:a}.vector"
        return f"{a:a} @ {b:a}"
    if _is(left, "Vector") and _is(right, "Vector"):
        return f"dot({a}, {b})"
    return ""


def _matrix_product(a: Text, b: Text, left: type | None, right: type | None, written: Written) -> str:
    constant = left is None or _is(left, "ndarray")
    if constant and right is not None and _is(right, "Manifold") and not _is(right, "Vector"):
        return f"{a:a} @ {vector_of(right, b)}"
    return _product(a, b, left, right, written)


def _sum(a: Text, b: Text, left: type | None, right: type | None, _: Written) -> str:
    if _is(left, "Manifold") and not _is(left, "Vector"):
        assert left is not None
        if _is(left, "S2") and _is(right, "S2"):
            return f"{a:a}.vector + {b:a}.vector"
        if not _is_vector(right):
            return f"{a:a} @ {b:a}" if _is(left, "Group") else ""
        return f"{a:a}.retract({b})"
    if right is None or not _is(right, "Manifold"):
        return ""
    part = vector_of(right, b)
    return f"{a:a} + {part}" if part else f"{b:a}.retract({a})"


def _difference(a: Text, b: Text, left: type | None, right: type | None, _: Written) -> str:
    if _is(left, "Manifold") and not _is(left, "Vector"):
        return f"{a:a}.retract(-{b:a})" if _is_vector(right) else f"{b:a}.local({a})"
    part = vector_of(right, b) if right is not None else ""
    return f"{a:a} - {part}" if part else ""


def _quotient(a: Text, b: Text, left: type | None, right: type | None, _: Written) -> str:
    if _is(left, "Group") and not _is(left, "Vector"):
        assert left is not None
        return (
            f"{left.__name__}.exp({a:a}.log() / {b:a})" if _is_vector(right) else f"{a:a} @ {b:a}.inverse()"
        )
    if _is(right, "Group") and not _is(right, "Vector"):
        return f"{b:a}.inverse()" if a.plain in ("1", "1.0") else f"{b:a}.inverse() @ {a:a}"
    return f"{a:a} / {b:a}"


def _power(a: Text, b: Text, left: type | None, right: type | None, written: Written) -> str:
    if _is(left, "Group") and not _is(left, "Vector"):
        assert left is not None
        return f"{a:a}.inverse()" if b.plain == "-1" else f"{left.__name__}.exp({b:a} * {a:a}.log())"
    if _is(right, "Group") and not _is(right, "Vector"):
        return ""
    roots = {"0.5": f"sqrt({a})", "1 / 2": f"sqrt({a})", "-0.5": f"1 / sqrt({a})", "-1": f"1 / {a:a}",
             "1.5": f"{a:a} * sqrt({a})", "1 / 3": f"exp(log({a}) / 3)"}  # fmt: skip
    node = written.node
    exponent = node.right if isinstance(node, ast.BinOp) else None
    if b.plain in roots:
        return roots[b.plain]
    if isinstance(exponent, ast.UnaryOp) and isinstance(exponent.operand, ast.Constant):
        whole = isinstance(exponent.operand.value, int)
        return f"1 / {a:a} ** {ast.unparse(exponent.operand)}" if whole else f"exp({b:a} * log({a}))"
    return f"exp({b:a} * log({a}))"


def _remainder(a: Text, *_: object) -> str:
    return f"atan2(sin({a}), cos({a})) for an angle; % has jumps"


def _whole(a: Text, b: Text, *_: object) -> str:
    return f"{a:a} / {b:a}; // has no derivative"


def _logic(a: Text, b: Text, _l: type | None, _r: type | None, written: Written) -> str:
    node = written.node
    holder = written.around[0] if written.around else None
    if isinstance(holder, ast.Compare):
        return _parentheses(holder)
    sign = "&" if isinstance(getattr(node, "op", None), ast.BitAnd) else "|"
    return f"({a} > 0) {sign} ({b} > 0): it joins conditions"


def _caret(a: Text, b: Text, left: type | None, right: type | None, written: Written) -> str:
    if not _is(left, "Vector"):
        return ""
    if _is(right, "int"):
        return f"{a:a} ** {b:a}"
    return f"cross({a}, {b})" if _is(left, "R3") else _power(a, b, left, right, written)


_Rule = Callable[[Text, Text, type | None, type | None, Written], str]
_RULES: dict[type[ast.operator], _Rule] = {
    ast.Mult: _product, ast.MatMult: _matrix_product, ast.Add: _sum, ast.Sub: _difference,
    ast.Div: _quotient, ast.Pow: _power, ast.Mod: _remainder, ast.FloorDiv: _whole,
    ast.BitAnd: _logic, ast.BitOr: _logic, ast.BitXor: _caret,
}  # fmt: skip
