"""What to write instead, where a value has no number or no such attribute, or where Python raised."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from types import FrameType, ModuleType, TracebackType
from typing import Any

from liegen.errors import LiegenError

from .conditions import for_branch, for_equality, product_of
from .names import arguments_of, families, for_attribute, for_class, for_function, listed
from .objects import OF_ONE, made
from .operators import for_operator, vector_of
from .written import (
    Text,
    Written,
    called_name,
    kind_of,
    language,
    text_of,
    with_imports,
    written_at,
    written_in,
)

_OPERANDS = re.compile(r"unsupported operand type\(s\) for .*: '([\w.]+)' and '([\w.]+)'")
_ORDER = re.compile(r"not supported between instances of '([\w.]+)' and '([\w.]+)'")
_UNARY = re.compile(r"bad operand type for unary .*: '([\w.]+)'")
_NUMBERS = ("pi", "tau", "inf", "nan")
_INVERSE = re.compile(r"\.inverse\(\) takes 1 positional")
_MADE = re.compile(r"__new__\(\) missing")
_EXP = re.compile(r"\w+\.exp\(\) missing 1 required")
_IMPORT = re.compile(r"cannot import name '(\w+)' from 'liegen'")


def for_number(kind: type, shown: str, doing: str, frame: FrameType, function: str = "") -> str:
    """What to write where Python or NumPy needs the number of a traced value.

    ``doing`` is ``branch``, ``compare`` or anything else; ``shown`` is the value's formula; ``function`` is
    the name of what asks, where the source is not known.
    """
    written = written_in(frame)
    if written is None:
        given: list[ast.expr] = [ast.Name(shown)]
        cure = f"where({shown}, a, b)" if doing == "branch" else for_function(function, given, {})
        return cure or _functions()
    return with_imports(_for_number(kind, shown, doing, written) or _functions(), written.names)


def _for_number(kind: type, shown: str, doing: str, written: Written) -> str:
    node = written.node
    if doing == "compare":
        return for_equality(kind, written)
    truth = doing == "branch" and "Condition" not in families(kind)
    if isinstance(node, ast.Call) and not (truth and called_name(node) == "bool"):
        return _of_call(kind, shown, node, written)
    if doing == "branch":
        return for_branch(kind, written)
    if isinstance(node, ast.BinOp | ast.AugAssign):
        return for_operator(written, None, None)
    if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
        return "stack(...) of all entries; an array cannot hold them"
    return ""


def _of_call(kind: type, shown: str, node: ast.Call, written: Written) -> str:
    name, func = called_name(node), node.func
    if isinstance(func, ast.Attribute):
        holder = kind_of(func.value, written.names)
        if holder is kind or (holder is None and hasattr(kind, name)):
            return for_attribute(kind, name, text_of(func.value), node.args, written.names, of_class=False)
        if not isinstance(written.names.get(_root(func)), ModuleType):
            return for_function(name, [func.value, *node.args], written.names)
    return for_function(name, node.args, written.names)


def _root(node: ast.expr) -> str:
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _functions() -> str:
    return f"it with {', '.join(language())} and operators"


def for_missing(kind: type, name: str, shown: str, frame: FrameType) -> str:
    """What to write for ``value.name``, which there is not; else the attributes that there are."""
    written = written_in(frame)
    if written is None:
        cure = for_attribute(kind, name, Text(shown), [], {}, of_class=False)
        return f"write {cure}" if cure else listed(kind)
    names = written.names
    x, arguments = _attribute(written, name, Text(shown))
    around = written.around[0] if written.around else None
    if name == "T" and "Vector" in families(kind) and isinstance(around, ast.BinOp):
        product = isinstance(around.op, ast.MatMult) and around.left is written.node
        if product:
            return f"write {with_imports(f'dot({x}, {ast.unparse(around.right)})', names)}"
    cure = for_attribute(kind, name, x, arguments, names, of_class=False)
    if isinstance(written.node, ast.Call) and x.plain == shown and called_name(written.node) != name:
        cure = for_function(called_name(written.node), written.node.args, names) or cure  # it asked for name
    return f"write {with_imports(cure, names)}" if cure else listed(kind)


def _attribute(written: Written, name: str, x: Text) -> tuple[Text, Sequence[ast.expr]]:
    """The holder of the attribute and the arguments of its call, as they are written."""
    node: ast.AST = written.node
    around = written.around
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        node, around = node.func, (node, *around)
    if not isinstance(node, ast.Attribute) or node.attr != name:
        return x, []
    call = around[0] if around and isinstance(around[0], ast.Call) and around[0].func is node else None
    return text_of(node.value), arguments_of(call)


def for_no_vector(kind: type, shown: str, frame: FrameType) -> str:
    """What to write where a vector is needed and a value of another kind is given."""
    written = written_in(frame)
    x = Text(shown)
    cure = ""
    if written is not None and isinstance(written.node, ast.BinOp | ast.AugAssign | ast.Compare):
        condition = "Condition" in families(kind)
        cure = product_of(written, x) if condition else for_operator(written, kind, kind)
    if not cure and written is not None and isinstance(written.node, ast.Call):
        cure = _with_vectors(kind, written.node, written)
    cure = cure or vector_of(kind, x)
    return with_imports(cure, written.names) if written is not None else cure


def _with_vectors(kind: type, call: ast.Call, written: Written) -> str:
    """``norm(T.translation)`` for ``norm(T)``: the call with the vectors of what is none."""
    moved = {
        k: vector_of(kind, text_of(a)) for k, a in enumerate(call.args) if kind_of(a, written.names) is kind
    }
    if not moved or not all(moved.values()):
        return ""
    arguments = [moved.get(k, ast.unparse(a)) for k, a in enumerate(call.args)]
    if called_name(call) == "where" and "Group" in families(kind):
        logs = [arguments[0], *(f"{text_of(a):a}.log()" for a in call.args[1:])]
        return f"{kind.__name__}.exp(where({', '.join(logs)}))"
    return f"{ast.unparse(call.func)}({', '.join(arguments)})"


def for_made(kind: type, frame: FrameType) -> str:
    """What to write for a call of a class whose elements are not made of parts, such as ``SO3(v)``."""
    written = written_in(frame)
    return with_imports(made(kind, written), written.names) if written else ""


def for_operator_here(kind: type, frame: FrameType, right: type | None = None) -> str:
    """What to write for the operator that a frame is running, on operands of these classes."""
    written = written_in(frame)
    cure = for_operator(written, kind, right or kind) if written is not None else ""
    return with_imports(cure, written.names) if written is not None else cure


def for_exception(error: BaseException, step: TracebackType | None) -> str:
    """What to write where Python itself raised; empty where nothing is known. ``step`` is the user's line."""
    written = written_at(step) if step is not None else None
    if written is None:
        return ""
    if isinstance(error, NotImplementedError) and "overloaded function" in str(error):  # CasADi's words
        cure = for_function(called_name(written.node), arguments_of(written.node), written.names)
        return with_imports(cure, written.names)
    if isinstance(error, NameError):
        return with_imports(_of_name(str(error.name), written), written.names)
    if isinstance(error, AttributeError):
        return with_imports(_of_attribute(error, written), written.names)
    if isinstance(error, TypeError):
        return with_imports(_of_types(str(error), written), written.names)
    if isinstance(error, ImportError):
        match = _IMPORT.search(str(error))
        found = for_function(match[1], [], {}).partition("(")[0] or for_class(match[1]) if match else ""
        return f"from liegen import {found}" if found in language() or found.isidentifier() else ""
    if isinstance(error.__cause__, LiegenError):  # which says what to write
        return ""
    if isinstance(error, ValueError) and "setting an array element" in str(error):
        return "stack(...) of all entries; an array cannot hold traced values"
    return ""


def _of_name(name: str, written: Written) -> str:
    import liegen

    if name in liegen.__all__:
        return f"from liegen import {name}"
    holder = written.around[0] if written.around else None
    call = holder if isinstance(holder, ast.Call) and holder.func is written.node else None
    if name in _NUMBERS:
        return f"math.{name}"
    if isinstance(holder, ast.Attribute) and holder.value is written.node:  # torch.sin(x), without torch
        outer = written.around[1] if len(written.around) > 1 else None
        return for_function(holder.attr, arguments_of(outer), written.names)
    cls = for_class(name) if name[0].isupper() else ""
    if cls or call is None:
        return f"{cls}({', '.join(map(ast.unparse, arguments_of(call)))})" if call and cls else cls
    return for_function(name, call.args, written.names)


def _of_attribute(error: AttributeError, written: Written) -> str:
    holder, name = error.obj, str(error.name)
    x, arguments = _attribute(written, name, Text("x"))
    if isinstance(holder, ModuleType) and name in _NUMBERS:
        return f"math.{name}"
    if isinstance(holder, ModuleType):
        cure = for_function(name, arguments, written.names)
        return cure or (for_class(name) if holder.__name__ == "liegen" else "")
    if isinstance(holder, type):
        of_language = hasattr(holder, "form")
        return for_attribute(holder, name, x, arguments, written.names, of_class=True) if of_language else ""
    if "RotationMatrix" in families(type(holder)):
        return for_attribute(type(holder), name, x, arguments, written.names, of_class=False)
    return ""


def _of_types(text: str, written: Written) -> str:
    for pattern in (_OPERANDS, _ORDER, _UNARY):
        match = pattern.search(text)
        if match:
            kinds = [_class(name, written.names) for name in match.groups()]
            if any(kinds):
                return for_operator(written, kinds[0], kinds[-1])
    if isinstance(written.node, ast.Call):
        cure = _of_arguments(text, written.node, written)
        if cure:
            return cure
    for pattern, answer in OF_ONE.items():
        match = pattern.search(text)
        kind = _class(next(filter(None, match.groups())), written.names) if match else None
        if kind is not None:
            return answer(kind, written)
    return ""


def _of_arguments(text: str, call: ast.Call, written: Written) -> str:
    """What to write for a call with too few arguments, or too many."""
    func = call.func
    cls = written.names.get(func.id) if isinstance(func, ast.Name) else None
    if _MADE.search(text) and isinstance(cls, type) and hasattr(cls, "form"):
        return made(cls, written)
    if _INVERSE.search(text) and call.args:
        return f"{ast.unparse(func)}() @ {text_of(call.args[0]):a}"
    if _EXP.search(text) and isinstance(func, ast.Attribute):
        return f"exp({ast.unparse(func.value)})"
    return ""


def _class(name: str, names: Mapping[str, Any]) -> type | None:
    """The class of the language, or of the user's file, with this name."""
    import liegen

    own = liegen.Vector if re.fullmatch(r"R\d+", name) else getattr(liegen, name, None)
    if name == "RotationMatrix":
        return type(name, (), {})
    found = own if isinstance(own, type) else names.get(name)
    if isinstance(found, type) and hasattr(found, "form"):
        return found
    kinds: list[type] = [v.__class__ for v in names.values()]
    return next((kind for kind in kinds if kind.__name__ == name and hasattr(kind, "form")), None)
