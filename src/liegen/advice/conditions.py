"""What to write for ``if``, ``and``, ``or``, ``not``, chained and equal comparisons of traced values."""

from __future__ import annotations

import ast

from .names import families
from .written import Text, Written, kind_of, text_of

_LOGIC = ast.BoolOp | ast.UnaryOp | ast.Compare


def for_branch(kind: type, written: Written) -> str:
    """What to write where Python asks for the truth of a condition, or of another value of class ``kind``."""
    if isinstance(written.node, ast.IfExp):
        written = Written(written.node.test, (written.node, *written.around), written.names)
    if "Condition" not in families(kind):
        if isinstance(written.node, ast.BoolOp):
            parts = [f"({text_of(v):a} > 0)" for v in written.node.values]
            return f"a comparison for each, such as {(' & ' if _is_and(written.node) else ' | ').join(parts)}"
        x = written.node.operand if isinstance(written.node, ast.UnaryOp) else written.node
        x = x.args[0] if isinstance(x, ast.Call) and x.args else x
        return f"a comparison for {ast.unparse(x)}, such as {text_of(x):a} > 0"
    test, around = _whole(written)
    choice = _choice(test)
    if choice:
        return choice
    shown = condition(test)
    for holder in around:
        if isinstance(holder, ast.IfExp) and holder.test is test:
            return f"where({shown}, {ast.unparse(holder.body)}, {ast.unparse(holder.orelse)})"
        if isinstance(holder, ast.Assert):
            return f'require({shown}, "why")'
        if isinstance(holder, ast.If) and holder.test is test:
            return _of_if(holder, around, shown)
        if isinstance(holder, ast.comprehension):
            return f"where({shown}, a, b) for each entry"
        if isinstance(holder, ast.While):
            return f"a for loop with a fixed number of steps, with where({shown}, a, b) in it"
        break
    return shown if test is not written.node or isinstance(test, _LOGIC) else f"where({shown}, a, b)"


def _choice(test: ast.AST) -> str:
    """``where(c, x, y)`` for ``c and x or y``."""
    first = test.values[0] if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.Or) else None
    if not isinstance(test, ast.BoolOp) or not isinstance(first, ast.BoolOp) or len(test.values) != 2:
        return ""
    value = first.values[-1]
    if len(first.values) != 2 or isinstance(value, _LOGIC) or not isinstance(first.op, ast.And):
        return ""
    return f"where({condition(first.values[0])}, {ast.unparse(value)}, {ast.unparse(test.values[1])})"


def for_equality(kind: type, written: Written) -> str:
    """``abs(x - y) < 1e-9`` for ``x == y``."""
    compare = written.node
    if not isinstance(compare, ast.Compare) or len(compare.ops) != 1:
        return "abs(x - y) < 1e-9 for x == y"
    if "Condition" in families(kind):
        return _same_truth(compare)
    among = compare.comparators[0]
    if isinstance(compare.ops[0], ast.In) and isinstance(among, ast.Tuple | ast.List | ast.Set):
        x = text_of(compare.left)
        return " | ".join(f"(abs({x} - {text_of(a):a}) < 1e-9)" for a in among.elts)
    left, right = text_of(compare.left), text_of(among)
    group = "Manifold" in families(kind) and "Vector" not in families(kind)
    difference = left.plain if right.plain in ("0", "0.0") else f"{left} - {right:a}"
    near = f"norm({left:a}.local({right}))" if group else f"abs({difference})"
    sign = ">=" if isinstance(compare.ops[0], ast.NotEq) else "<"
    return f"{near} {sign} 1e-9"


def _same_truth(compare: ast.Compare) -> str:
    a, b = text_of(compare.left), text_of(compare.comparators[0])
    same = isinstance(compare.ops[0], ast.Eq)
    if b.plain in ("True", "False"):
        return f"{a}" if same == (b.plain == "True") else f"~{a:a}"
    return f"{a:a} & {b:a} | ~{a:a} & ~{b:a}" if same else f"{a:a} & ~{b:a} | ~{a:a} & {b:a}"


def _is_and(test: ast.BoolOp) -> bool:
    return isinstance(test.op, ast.And)


def condition(test: ast.AST) -> str:
    """The condition with ``&``, ``|``, ``~`` and without chains."""
    if isinstance(test, ast.BoolOp):
        sign = " & " if _is_and(test) else " | "
        return sign.join(_parted(condition(value), value) for value in test.values)
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        inner = condition(test.operand)
        return f"~{inner}" if isinstance(test.operand, ast.Name | ast.Call) else f"~({inner})"
    if isinstance(test, ast.Compare) and len(test.ops) > 1:
        if any(isinstance(op, ast.Eq | ast.NotEq) for op in test.ops):
            return "each comparison in parentheses, joined with &"
        operands = [test.left, *test.comparators]
        pairs = zip(operands, test.ops, operands[1:], strict=False)
        return " & ".join(f"({ast.unparse(ast.Compare(a, [op], [b]))})" for a, op, b in pairs)
    return ast.unparse(test)


def _parted(text: str, node: ast.AST) -> str:
    plain = isinstance(node, ast.Name | ast.Call | ast.Attribute | ast.Subscript)
    chain = isinstance(node, ast.Compare) and len(node.ops) > 1
    return text if plain or chain else f"({text})"


def _whole(written: Written) -> tuple[ast.AST, tuple[ast.AST, ...]]:
    """The largest condition around an operand, and what is around it."""
    test, around = written.node, written.around
    while around and (
        isinstance(around[0], ast.BoolOp)
        or (isinstance(around[0], ast.UnaryOp) and isinstance(around[0].op, ast.Not))
        or (isinstance(around[0], ast.Compare) and len(around[0].ops) > 1)
    ):
        test, around = around[0], around[1:]
    return test, around


def _of_if(holder: ast.If, around: tuple[ast.AST, ...], shown: str) -> str:
    """``return where(x > 0, x, -x)`` for both branches, where each is one line."""
    after = around[around.index(holder) + 1 :]
    body = getattr(after[0], "body", []) if after else []
    following = body[body.index(holder) + 1 :] if holder in body else []
    then, otherwise = holder.body[0], (holder.orelse or following or [None])[0]
    if isinstance(then, ast.Return) and isinstance(otherwise, ast.Return) and then.value and otherwise.value:
        return f"return where({shown}, {ast.unparse(then.value)}, {ast.unparse(otherwise.value)})"
    if isinstance(then, ast.Assign):
        target = ast.unparse(then.targets[0])
        same = isinstance(otherwise, ast.Assign) and ast.unparse(otherwise.targets[0]) == target
        other = ast.unparse(otherwise.value) if same and isinstance(otherwise, ast.Assign) else target
        return f"{target} = where({shown}, {ast.unparse(then.value)}, {other})"
    return f"where({shown}, a, b) for the values of both branches"


def product_of(written: Written, x: Text) -> str:
    """``where(c, x, 0.0)`` for ``c * x``."""
    node = written.node
    if not isinstance(node, ast.BinOp):
        return f"where({x}, a, b)"
    left, right = text_of(node.left), text_of(node.right)
    kind = kind_of(node.right, written.names)
    reverse = isinstance(node.right, ast.Compare) or (kind is not None and "Condition" in families(kind))
    test, other = (right, left) if reverse else (left, right)
    if isinstance(node.op, ast.Mult):
        return f"where({test}, {other}, 0.0)"
    return f"{text_of(node.left)} with where({test}, 1.0, 0.0) for the condition"
