"""What to write for an operation that Python refuses for one object, by what Python says of its class."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping

from .names import arguments_of, families, for_function
from .operators import vector_of
from .written import Text, Written, called_name, kind_of, text_of

_ABS = re.compile(r"bad operand type for abs\(\): '([\w.]+)'")
_SUBSCRIPT = re.compile(r"'([\w.]+)' object is not subscriptable")
_CLASS_SUBSCRIPT = re.compile(r"type '(\w+)' is not subscriptable")
_CALL = re.compile(r"'([\w.]+)' object is not callable")
_ASSIGN = re.compile(r"'([\w.]+)' object does not support item assignment")
_DELETE = re.compile(r"'([\w.]+)' object (?:does not|doesn't) support item deletion")
_LENGTH = re.compile(r"object of type '([\w.]+)' has no len\(\)")
_ITERATE = re.compile(r"(?:'([\w.]+)' object is not iterable|cannot unpack non-iterable ([\w.]+) object)")
_INTEGER = re.compile(r"'([\w.]+)' object cannot be interpreted as an integer")
_UFUNC = re.compile(r"operand '(\w+)' does not support ufuncs")
_INT = re.compile(r"argument must be .*, not '(\w+)'")
_ROUND = re.compile(r"type (\w+) doesn't define __\w+__ method")
_REAL = re.compile(r"must be real number, not (\w+)")
_NO_ARGUMENTS = re.compile(r"(\w+)\(\) takes no arguments")


def _subscript(kind: type, written: Written) -> str:
    node = written.node
    if not isinstance(node, ast.Subscript):
        return ""
    x = text_of(node.value)
    index = ast.unparse(node).removeprefix(ast.unparse(node.value))
    rows = {
        "S2": f"{x:a}.vector{index}", "Rotation": f"{x:a}.matrix(){index}",
        "Pose": _of_pose(node.slice, x, index), "Similarity": _of_pose(node.slice, x, index),
        "ExtendedPose": f"{x:a}.position[k], {x:a}.velocity[k] or {x:a}.rotation.matrix()[i, j]",
        "Product": " or ".join(f"{x:a}.{name}" for name in getattr(kind, "part_classes", {})),
        "Calibration": f"{x:a}.uncalibrate(q), the pixels of q = p[:2] / p[2]",
    }  # fmt: skip
    return next((rows[f] for f in families(kind) if f in rows), "")


def _of_pose(index: ast.expr, x: Text, shown: str) -> str:
    """The part of a pose that an index of its matrix, or of its vector, means."""
    if not isinstance(index, ast.Tuple):
        return f"{x:a}.translation{shown}"
    last = index.elts[-1]
    if isinstance(last, ast.Slice):
        return f"{x:a}.rotation.matrix()"
    if isinstance(last, ast.Constant) and last.value in (0, 1):
        return f"{x:a}.rotation.matrix(){shown}"
    return f"{x:a}.translation for the last column, {x:a}.rotation.matrix()[i, j] for the others"


def _called(kind: type, written: Written) -> str:
    node = written.node
    if not isinstance(node, ast.Call):
        return ""
    func = text_of(node.func)
    if node.args and "Vector" in families(kind):
        return f"{func:a}[{', '.join(ast.unparse(a) for a in node.args)}]"
    if node.args and "Manifold" in families(kind):
        return f"{func:a} @ {text_of(node.args[0]):a}"
    return f"{func}, without parentheses"


def _assigned(kind: type, written: Written) -> str:
    """``x = stack(x[0], value, x[2])``: values are not changed."""
    node = written.node
    holder = written.around[0] if written.around else None
    if not isinstance(node, ast.Subscript) or "Vector" not in families(kind):
        return "a new value; values cannot be changed"
    x = text_of(node.value)
    value = ast.unparse(holder.value) if isinstance(holder, ast.Assign) and holder.value else "value"
    known = kind_of(node.value, written.names) or kind
    size = getattr(getattr(known, "form", None), "dim", 0)
    at = node.slice.value if isinstance(node.slice, ast.Constant) else None
    if not isinstance(at, int) or not 0 < size <= 9:
        return f"{x} = stack(...) of all entries; values cannot be changed"
    entries = [value if k == at % size else f"{x:a}[{k}]" for k in range(size)]
    return f"{x} = stack({', '.join(entries)}); values cannot be changed"


def _parts(kind: type, x: Text) -> str:
    rows = {
        "Pose": "{x:a}.rotation, {x:a}.translation", "Rotation": "{x:a}.log()", "S2": "{x:a}.vector",
        "ExtendedPose": "{x:a}.rotation, {x:a}.position, {x:a}.velocity",
        "Similarity": "{x:a}.rotation, {x:a}.translation, {x:a}.scale",
        "Group": "{x:a}.log()",
    }  # fmt: skip
    named: Mapping[str, type] = getattr(kind, "part_classes", {})
    if named:
        return ", ".join(f"{x:a}.{name}" for name in named)
    return next((rows[f] for f in families(kind) if f in rows), "").format(x=x)


def _length(kind: type, written: Written) -> str:
    arguments = arguments_of(written.node)
    x = text_of(arguments[0]) if arguments else Text("x")
    if "Condition" in families(kind) or not hasattr(kind, "form"):
        return ""
    return f"{kind.form.dim}, the dimension of {kind.__name__}; {x} is no vector"  # type: ignore[attr-defined]


def _iterated(kind: type, written: Written) -> str:
    node: ast.AST = written.node
    holder = written.around[0] if written.around else None
    if isinstance(holder, ast.Assign):  # unpacking: the position is that of the targets
        node = holder.value
    if isinstance(node, ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp):
        node = node.generators[0]
    if isinstance(node, ast.For | ast.comprehension):
        node = node.iter
    if isinstance(node, ast.Call) and node.args and kind_of(node, written.names) is None:
        node = node.args[0]
    if isinstance(node, ast.Starred):
        node = node.value
    return _parts(kind, text_of(node))


def _integer(kind: type, written: Written) -> str:
    node = written.node
    if called_name(node) == "range":
        return "range(n) with a number n; the size of a formula is fixed while it is traced"
    return "a whole number there; a traced value has none"


def _real(kind: type, written: Written) -> str:
    part = vector_of(kind, text_of(written.node.args[0])) if isinstance(written.node, ast.Call) else ""
    return part.replace("{", "").replace("}", "") if part else ""


def _absolute(kind: type, written: Written) -> str:
    arguments = arguments_of(written.node)
    part = vector_of(kind, text_of(arguments[0])) if arguments else ""
    return f"norm({part})" if part else ""


def made(kind: type, written: Written) -> str:
    """What to write for a constructor that got other arguments than it has."""
    arguments = arguments_of(written.node)
    name = kind.__name__
    if not arguments:
        return f"{name}.identity()" if "Group" in families(kind) else ""
    if "Pose" in families(kind):
        return (
            f"{name}(rotation, translation), or {name}.exp({ast.unparse(arguments[0])}) of a tangent vector"
        )
    if "Rotation" in families(kind):
        return f"{name}.exp({ast.unparse(arguments[0])})"
    if "S2" in families(kind):
        return f"S2.direction({ast.unparse(arguments[0])})"
    return f"{name}.from_storage(...) for a constant, or make it an argument"


def _by_name(_: type, written: Written) -> str:
    return for_function(called_name(written.node), arguments_of(written.node), written.names)


_Answer = Callable[[type, Written], str]
#: The patterns of Python's messages, each with a group for the class, and what answers it.
OF_ONE: dict[re.Pattern[str], _Answer] = {
    _ABS: _absolute, _SUBSCRIPT: _subscript, _CALL: _called, _ASSIGN: _assigned, _DELETE: _assigned,
    _LENGTH: _length, _ITERATE: _iterated, _INTEGER: _integer, _REAL: _real,
    _NO_ARGUMENTS: made, _UFUNC: _by_name, _INT: _by_name, _ROUND: _by_name,
    _CLASS_SUBSCRIPT: lambda kind, _: f"{kind.__name__}(12)" if kind.__name__ == "R" else f"{kind.__name__}",
}  # fmt: skip
